"""Build hook: compiles the FMU's binaries into the package, unless they are there and current."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).resolve().parent
BINARIES = ROOT / "models" / "cablefmu" / "binaries"


def _recipe() -> Any:
    sys.path.insert(0, str(ROOT / "fmu_src"))
    try:
        import compile as recipe  # fmu_src/compile.py
    finally:
        sys.path.pop(0)
    return recipe


class BinariesHook(BuildHookInterface):
    """An sdist carries the binaries, so that only a checkout with changed sources asks for the compiler."""

    def dependencies(self) -> list[str]:
        recipe = _recipe()
        return [] if recipe.is_current(BINARIES) else list(recipe.REQUIREMENTS)

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        recipe = _recipe()
        if not recipe.is_current(BINARIES):
            recipe.build_binaries(BINARIES)
        build_data["artifacts"].append("/models/cablefmu/binaries/**")
