"""The spring FMU by itself: its formula, its units, going back, and what is no number."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

SCRIPT = Path(__file__).parents[2] / "fmu_src" / "partners" / "spring.py"


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU, built in a process of its own: pythonfmu imports what it packs."""
    folder = tmp_path_factory.mktemp("spring")
    command = [sys.executable, "-B", "-m", "pythonfmu", "build", "-f", str(SCRIPT), "-d", str(folder)]
    subprocess.run(command, check=True)
    return folder / "Spring.fmu"


def test_it_is_valid_and_has_units(path: Path) -> None:
    assert validate_fmu(str(path)) == []
    units = {variable.name: variable.unit for variable in read_model_description(str(path)).modelVariables}
    assert units == {
        "stiffness": "N/m", "damping": "N.s/m", "drag": "N.s2/m2", "rest": "m",
        "y_a": "m", "v_a": "m/s", "y_b": "m", "v_b": "m/s", "F_a": "N", "F_b": "N",
    }  # fmt: skip


def test_force_is_what_its_formula_says(path: Path) -> None:
    """1000 N/m over 0.3 m less 0.1 m of rest, 50 N s/m and 8 N s2/m2 at -2 m/s."""
    values = {"stiffness": 1e3, "damping": 50, "drag": 8, "rest": 0.1, "y_a": 0.5, "y_b": 0.2, "v_a": -1.5, "v_b": 0.5}
    result = simulate_fmu(str(path), stop_time=0.1, output_interval=0.1, start_values=values, output=["F_a", "F_b"])
    assert result["F_a"] == pytest.approx(-1e3 * 0.2 + 50 * 2 + 8 * 4)
    assert np.array_equal(result["F_b"], -result["F_a"])


def test_it_can_be_rolled_back(path: Path, tmp_path: Path) -> None:
    description = read_model_description(str(path))
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid, unzipDirectory=extract(str(path), unzipdir=str(tmp_path)),
        modelIdentifier=description.coSimulation.modelIdentifier, instanceName="spring",
    )  # fmt: skip
    fmu.instantiate()
    fmu.setReal([reference["stiffness"], reference["y_a"]], [10.0, 2.0])
    fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    state = fmu.getFMUstate()
    fmu.setReal([reference["y_a"]], [5.0])
    fmu.doStep(0.0, 0.1)
    assert fmu.getReal([reference["F_a"]]) == [-50.0]
    fmu.setFMUstate(state)
    assert fmu.getReal([reference["F_a"], reference["y_a"]]) == [-20.0, 2.0]
    fmu.freeFMUstate(state)
    fmu.terminate()
    fmu.freeInstance()


def test_what_is_no_number_is_refused(path: Path) -> None:
    said: list[str] = []

    def log(environment: object, instance: bytes, status: int, category: bytes, message: bytes) -> None:
        said.append(message.decode())

    result = simulate_fmu(str(path), stop_time=1.0, start_values={"drag": float("nan")}, debug_logging=True, logger=log)
    assert set(result["time"]) == {0.0}
    assert said == ["finite parameters and inputs are expected"]
