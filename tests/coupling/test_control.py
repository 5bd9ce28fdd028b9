"""Adaptive steps: the error follows the tolerance, steps are repeated where they can be, and limits are kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cablefmu.coupling import couple
from cablefmu.coupling.description import Coupling
from cablefmu.errors import RunError
from tests.coupling.oscillators import error, oscillators


def adaptive(
    folder: Path, tolerance: float, *, control: str = "signals", smallest: float = 1e-5, extrapolation: int = 1
) -> Coupling:
    more = f'adaptive = {{ tolerance = {tolerance}, smallest = {smallest}, largest = 0.1, control = "{control}" }}'
    return oscillators(folder, step=0.01, algorithm="gauss-seidel", extrapolation=extrapolation, more=more)


@pytest.mark.parametrize("control", ["signals", "power"])
def test_error_falls_with_the_tolerance_and_steps_get_shorter(control: str, cables: Path) -> None:
    loose, tight = (couple(adaptive(cables, tolerance, control=control)) for tolerance in (1e-2, 1e-4))
    assert error(tight) < 0.2 * error(loose)
    assert tight.attrs["steps"] > 2.0 * loose.attrs["steps"]
    for result in (loose, tight):
        assert result["time"].values[-1] == 2.0
        assert 1e-5 <= result.attrs["shortest_step"] < 0.5 * result.attrs["longest_step"] <= 0.05 + 1e-12


def test_a_step_with_too_large_an_error_is_repeated_where_that_is_possible(cables: Path) -> None:
    """The first step is too long; with a wave that cannot be rolled back it is kept, and counted."""
    coupling = adaptive(cables, 1e-2, extrapolation=0)
    judged = couple(coupling)
    assert judged.attrs["rejected"] >= 1 and judged["time"].values[1] < 0.01
    text = coupling.text
    wave = '[[model]]\nname = "wave"\npartner = "wave_force"\n[[connection]]\nfrom = "wave.force"\nto = "a.F_cy"\n'
    result = couple(Coupling.from_text(text + wave, name="wave", folder=cables))
    assert "no step is repeated, as these models cannot be rolled back: wave" in result.attrs["notes"]
    assert result.attrs["rejected"] >= 1 and result["time"].values[1] == 0.01


def test_iterated_steps_adapt_as_well(cables: Path) -> None:
    """Rollback inside rollback; power says nothing there, signals do."""
    text = (
        adaptive(cables, 1e-2).text.replace("gauss-seidel", "iterated").replace("tolerance = 1e-11", "tolerance = 1e-9")
    )
    result = couple(Coupling.from_text(text, name="x", folder=cables))
    assert error(result) < 1e-2
    assert result.attrs["evaluations"] > result.attrs["steps"]


def test_a_step_below_the_smallest_ends_the_run_with_the_connection(cables: Path) -> None:
    with pytest.raises(
        RunError,
        match=r"connection \w+\.\w+ -> \w+\.\w+: a step below 0\.005 s would be needed at t = .* s; a smaller "
        r"adaptive\.smallest or a larger adaptive\.tolerance is expected$",
    ):
        couple(adaptive(cables, 1e-7, smallest=0.005))


def test_constant_steps_end_at_the_stop_time_with_a_shorter_one(cables: Path) -> None:
    times = couple(oscillators(cables, step=0.03))["time"].values
    assert times == pytest.approx([*(0.03 * np.arange(67)), 2.0])
    assert times[-1] == 2.0
