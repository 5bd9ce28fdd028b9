"""FMUs that couplings are tested with, built once a session, and couplings of them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.coupling.oscillators import build_cables

SLAVES = Path(__file__).parent / "slaves"


@pytest.fixture(scope="session")
def slave(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """slave(name): the FMU of a script in slaves/; all but one can be rolled back."""
    folder = tmp_path_factory.mktemp("slaves")

    @cache
    def build(name: str) -> Path:
        # pythonfmu imports what it packs: in a process of its own that leaves no trace in this one.
        command = [
            sys.executable,
            "-B",
            "-m",
            "pythonfmu",
            "build",
            "-f",
            str(SLAVES / f"{name}.py"),
            "-d",
            str(folder),
        ]
        subprocess.run([*command, "--no-variable-step" if name == "stiff" else "--handle-state"], check=True)
        return folder / f"{name.capitalize()}.fmu"

    return build


@pytest.fixture(scope="session")
def cables(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the oscillators' FMUs."""
    return build_cables(tmp_path_factory.mktemp("oscillators"))
