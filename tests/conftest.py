"""What many tests share, made once a session: the small scenes' FMUs unpacked, the kernel as a library.

With several workers each makes its own, in a temporary folder of its own.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.fmu_helpers import from_equilibrium, small_scene, unpack
from tests.kernel.library import compile_kernel, load

Unpacked = Callable[[str, int], Path]


@pytest.fixture(scope="session")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Unpacked:
    """unpacked(kind, fmi): folder of that small scene's FMU."""
    folder = tmp_path_factory.mktemp("fmus")

    @cache
    def build(kind: str, fmi: int) -> Path:
        return unpack(small_scene(kind), folder, fmi)

    return build


@pytest.fixture(scope="session")
def unpacked_from_equilibrium(tmp_path_factory: pytest.TempPathFactory) -> Unpacked:
    """The same of scenes whose runs start from equilibrium."""
    folder = tmp_path_factory.mktemp("fmus-from-equilibrium")

    @cache
    def build(kind: str, fmi: int) -> Path:
        return unpack(from_equilibrium(small_scene(kind)), folder, fmi)

    return build


@pytest.fixture(scope="session")
def unpacked_arrays(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """unpacked_arrays(kind): folder of that small scene's FMU whose number of links is a parameter (FMI 3)."""
    folder = tmp_path_factory.mktemp("fmus-with-arrays")

    @cache
    def build(kind: str) -> Path:
        return unpack(small_scene(kind), folder, 3, arrays=True)

    return build


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """Kernel and probe with the release's flags."""
    return load(compile_kernel(tmp_path_factory.mktemp("kernel")))
