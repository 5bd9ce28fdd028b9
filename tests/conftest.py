"""What many tests share: the small scenes' FMUs, built and unpacked once a session."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.fmu_helpers import small_scene, unpack

Unpacked = Callable[[str, int], Path]


@pytest.fixture(scope="session")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Unpacked:
    """unpacked(kind, fmi): folder of that small scene's FMU."""
    folder = tmp_path_factory.mktemp("fmus")

    @cache
    def build(kind: str, fmi: int) -> Path:
        return unpack(small_scene(kind), folder, fmi)

    return build
