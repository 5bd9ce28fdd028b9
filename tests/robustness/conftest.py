from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS
from tests.robustness.building import compile_with_gcc, compile_with_zig, scene_words


@pytest.fixture(scope="session")
def words(unpacked: Unpacked, unpacked_from_equilibrium: Unpacked) -> list[str]:
    """A small scene of every kind with a force and a mass, and one that starts from equilibrium, as the host wants them
    on its command line."""
    folders = [*(unpacked(kind, 3) for kind in KINDS if kind != "between"), unpacked_from_equilibrium("load", 3)]
    return [word for folder in folders for word in scene_words(folder)]


@pytest.fixture(scope="session")
def shipped_host(unpacked: Unpacked, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The host on the library that every FMU carries."""
    (library,) = unpacked("load", 3).glob("binaries/*/*.so")
    return compile_with_zig(tmp_path_factory.mktemp("shipped") / "host", library=library)


@pytest.fixture(scope="session")
def counting_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The host and the FMU's sources in one program, the FMU's memory counted."""
    return compile_with_zig(tmp_path_factory.mktemp("counting") / "host")


@pytest.fixture(scope="session")
def plain_gcc_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same by the system's compiler."""
    return compile_with_gcc(tmp_path_factory.mktemp("gcc") / "host")
