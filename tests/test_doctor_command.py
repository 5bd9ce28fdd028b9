"""`cablefmu doctor`: status 0 and a table here; status 1 and a sentence where a library is damaged."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import cablefmu
from cablefmu.fmu.platforms import PLATFORMS, library_name, this_platform

pytestmark = pytest.mark.slow  # a self-check each, in processes that load everything anew


def doctor(at: Path, package: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(package), "COLUMNS": "200"}
    command = [sys.executable, "-m", "cablefmu", "doctor"]
    return subprocess.run(command, cwd=at, env=environment, capture_output=True, text=True, timeout=300, check=False)


def test_here_everything_works(tmp_path: Path) -> None:
    done = doctor(tmp_path, Path(cablefmu.__file__).parents[1])
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1] == "everything works"
    rows = {
        cells[1].strip(): cells[3].strip() for line in done.stdout.splitlines() if len(cells := line.split("│")) > 3
    }
    assert {*PLATFORMS, "this machine", "FMI 2, Co-Simulation", "coupled with a Python partner"} <= set(rows)
    assert set(rows.values()) <= {"ok", "-"}
    assert list(tmp_path.iterdir()) == []  # nothing is left behind


def test_a_damaged_library_ends_it_with_status_1(tmp_path: Path) -> None:
    package = tmp_path / "package" / "cablefmu"
    shutil.copytree(Path(cablefmu.__file__).parent, package)
    name = library_name("cable", this_platform())
    library = package / "binaries" / name
    library.write_bytes(library.read_bytes()[:5000])  # as a copy that was cut short
    done = doctor(tmp_path, package.parent)
    assert done.returncode == 1
    assert f"{name}: not what was compiled" in done.stderr
    assert "FMI 2, Co-Simulation: " in done.stderr  # and it does not run
    assert "Traceback" not in done.stderr + done.stdout
    assert "FAILS" in done.stdout and "everything works" not in done.stdout
