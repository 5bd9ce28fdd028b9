"""The example's coupled run: it converges to the whole system's motion as a held force must, at first order."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from cablefmu.cable import Floats

SCRIPT = Path(__file__).parents[2] / "docs" / "examples" / "coupled_wave.py"

BOUND = (0.03, 0.007)
"""Error of y_m1 and x_c [m] at h = 0.025 s. A force held for h is late by h/2 = 12.5 ms, in which the floater, at
some 2 m/s, moves 25 mm; the load, 240 m of cable below it, a quarter of that."""

EXTRAPOLATED = 0.03
"""2 x(h/2) - x(h) cancels the first order: what is left is of order h^2, smaller by a factor of about h times a
rate of the motion, 2 pi / 8 s: 0.02. Were the limit another motion than the whole system's, all of the error
would stay."""


class Study(NamedTuple):
    """What the example measures."""

    folder: Path
    exact: Floats
    runs: dict[float, Floats]
    errors: Floats


@pytest.fixture(scope="module")
def example() -> ModuleType:
    """The script as a module."""
    spec = importlib.util.spec_from_file_location(SCRIPT.stem, SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def study(example: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Study:
    """All of its runs, once."""
    folder = tmp_path_factory.mktemp("coupled")
    return Study(folder, *example.study(folder))


def test_error_is_of_first_order_in_the_communication_step(example: ModuleType, study: Study) -> None:
    observed = example.orders(study.errors)
    assert observed.shape == (3, 2)
    assert np.all((observed > 0.9) & (observed < 1.15)), observed


def test_error_at_the_smallest_step_is_what_a_late_force_explains(study: Study) -> None:
    assert np.all(study.errors[-1] < BOUND), study.errors[-1]


def test_limit_is_the_motion_of_the_whole_system(study: Study) -> None:
    coarse, fine = list(study.runs.values())[-2:]
    left = np.abs(2.0 * fine - coarse - study.exact).max(axis=0)
    assert np.all(left < EXTRAPOLATED * study.errors[-1]), left / study.errors[-1]


def test_forces_do_move_the_floater_and_pass_through_the_cable(study: Study) -> None:
    """Without that, agreement would say nothing."""
    heave, across = np.ptp(study.exact, axis=0)
    assert heave > 3.0 and across > 10.0  # m


@pytest.mark.parametrize("name", ["free-12-water.fmu", "WaveForce.fmu"])
def test_both_fmus_are_valid(study: Study, name: str) -> None:
    assert validate_fmu(str(study.folder / name)) == []


def test_table_and_picture(example: ModuleType, study: Study, tmp_path: Path) -> None:
    lines = example.table(study.errors).splitlines()
    assert [float(line.split()[0]) for line in lines[1:]] == list(example.STEPS)
    assert [len(line.split()) for line in lines[1:]] == [3, 5, 5, 5]  # no order before the first halving
    example.draw(tmp_path / "picture.png", study.exact, study.runs, study.errors)
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")
