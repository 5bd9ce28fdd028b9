"""The wave-force FMU by itself, under FMPy: the closed form, its units, and parameters that make no sense."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi2 import fmi2Error

SCRIPT = Path(__file__).parents[2] / "fmu_src" / "partners" / "wave_force.py"

ROUNDING = 1e-12
"""Of the amplitude; a sine of arguments below 100, in another order of operations."""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU, built in a process of its own: pythonfmu imports what it packs."""
    folder = tmp_path_factory.mktemp("wave")
    command = [sys.executable, "-B", "-m", "pythonfmu", "build", "-f", str(SCRIPT), "-d", str(folder)]
    subprocess.run(command, check=True)
    return folder / "WaveForce.fmu"


def run(path: Path, parameters: dict[str, float], **more: Any) -> tuple[Any, Any]:
    """Times [s] and force [N] of 20 s in steps of 0.1 s."""
    result = simulate_fmu(
        str(path), stop_time=20.0, output_interval=0.1, start_values=parameters, output=["force"], **more
    )
    return result["time"], result["force"]


def test_without_ramp_it_is_a_sine_from_the_start(path: Path) -> None:
    time, force = run(path, {"amplitude": 2500.0, "period": 6.3, "phase": 0.7})
    assert len(time) == 201
    expected = 2500.0 * np.imag(np.exp(1j * (2.0 * np.pi / 6.3 * time + 0.7)))
    assert force == pytest.approx(expected, abs=2500.0 * ROUNDING)
    assert force[0] == pytest.approx(2500.0 * np.sin(0.7), abs=2500.0 * ROUNDING)


def test_ramp_is_a_smooth_beginning(path: Path) -> None:
    """sin^2 until the ramp ends at 5 s, the plain sine from there on."""
    time, force = run(path, {"amplitude": 2500.0, "period": 6.3, "phase": 0.7, "ramp": 5.0})
    growth = np.where(time < 5.0, np.sin(0.1 * np.pi * time) ** 2, 1.0)
    expected = growth * 2500.0 * np.imag(np.exp(1j * (2.0 * np.pi / 6.3 * time + 0.7)))
    assert force == pytest.approx(expected, abs=2500.0 * ROUNDING)
    assert force[0] == 0.0


def test_description_gives_units_and_frame(path: Path) -> None:
    description = read_model_description(str(path))
    units = {variable.name: variable.unit for variable in description.modelVariables}
    assert units == {"amplitude": "N", "period": "s", "phase": "rad", "ramp": "s", "force": "N"}
    (force,) = (variable for variable in description.modelVariables if variable.name == "force")
    assert "positive down" in force.description and "x right, y down" in force.description


@pytest.mark.parametrize(
    "wrong", [{"period": 0.0}, {"period": -1.0}, {"ramp": -0.1}, {"amplitude": float("nan")}, {"phase": float("inf")}]
)
def test_parameters_without_sense_end_the_run_at_once(path: Path, wrong: dict[str, float]) -> None:
    """The first step is discarded, with a message: an exception would be fatal, and freeing the instance a crash."""
    messages: list[tuple[int, str]] = []

    def log(environment: Any, instance: bytes, status: int, category: bytes, message: bytes) -> None:
        messages.append((status, message.decode()))

    time, force = run(path, wrong, debug_logging=True, logger=log)
    assert set(time) == {0.0} and set(force) == {0.0}
    assert messages == [(fmi2Error, "finite parameters, period above 0 and ramp not below 0 are expected")]
