"""Build hook: compiles the FMU's binaries into the package, unless they are there and current."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).resolve().parent
BINARIES = ROOT / "models" / "cablefmu" / "binaries"


def _toolchain() -> Any:
    sys.path.insert(0, str(ROOT / "fmu_src"))
    try:
        import toolchain
    finally:
        sys.path.pop(0)
    return toolchain


class BinariesHook(BuildHookInterface):
    """An sdist carries the binaries, so that only a checkout with changed sources asks for the compiler."""

    def dependencies(self) -> list[str]:
        toolchain = _toolchain()
        return [] if toolchain.is_current(BINARIES) else list(toolchain.REQUIREMENTS)

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        toolchain = _toolchain()
        toolchain.build_binaries(BINARIES)  # what is current is not compiled again
        folder = BINARIES.relative_to(ROOT).as_posix()
        build_data["artifacts"] += [f"/{folder}/{name}" for name in toolchain.products()]  # git ignores them
