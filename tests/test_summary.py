"""The table at the end of a run."""

from __future__ import annotations

import io

import pytest
import xarray as xr
from rich.console import Console

from cablefmu.summary import print_summary, summary

RESULT = xr.Dataset(
    {
        "x_c": ("time", [0.0, 3.0, 4.5]),
        "y_c": ("time", [10.0, 9.0, 8.25]),
        "tension_max": ("time", [100.0, 2500.5, 300.0]),
        "energy": ("time", [50.0, 40.0, -25.0]),
        "solver.stiff": ("time", [0.0, 0.0, 1.0]),
        "solver.error_estimate": ("time", [0.0, 8.5e-7, 3e-7]),
    },
    coords={"time": [0.0, 0.5, 1.0]},
    attrs={
        "title": "swing",
        "interface": "cs",
        "tolerance": 1e-6,
        "solver_steps": 12345,
        "solver_rejected": 1,
        "solver_rhs": 74000,
        "solver_jacobians": 1200,
        "solver_energy_residual": -1.5e-4,
        "run_time": 0.002,
    },
)


def test_what_one_looks_at_first() -> None:
    assert summary(RESULT) == {
        "terminal position": "x_c = 4.5 m, y_c = 8.25 m at t = 1 s",
        "largest tension": "2500.5 N at t = 0.5 s",
        "energy drift": "-75 J, start to end (work of forces and damping included)",
        "solver": "implicit in 50 % of the output intervals, else explicit",
        "steps": "12,345",
        "rejected steps": "1",
        "right-hand sides": "74,000",
        "Jacobians": "1,200",
        "error estimate": "8.5e-07 at most in a step (tolerance 1e-06)",
        "energy residual": "-0.00015 J, 2e-06 of the range of the energy",
        "run time": "0.002 s",
        "faster than real time": "500 times",
    }


def test_the_slowest_natural_frequencies() -> None:
    rung = RESULT.assign(frequency=("mode", [0.06911, 0.13456, 0.2, 0.3]))
    assert summary(rung)["natural frequencies"] == "0.06911, 0.1346, 0.2 Hz at the equilibrium of the start, undamped"
    silent = RESULT.assign(frequency=("mode", []))
    assert "natural frequencies" not in summary(silent)


def test_only_what_the_result_holds() -> None:
    bare = RESULT[["x_c"]].drop_attrs()
    assert summary(bare) == {}


@pytest.mark.parametrize(("stiff", "says"), [([0, 0, 0], "explicit"), ([0, 1, 1], "implicit")])
def test_a_run_by_one_method_says_which(stiff: list[float], says: str) -> None:
    """What it was at the start does not count: nothing had been integrated."""
    assert summary(RESULT.assign({"solver.stiff": ("time", stiff)}))["solver"] == says


def test_in_model_exchange_the_fmus_solver_has_nothing_to_say() -> None:
    """Its outputs stay where they started; the counters are those of the host's solver."""
    told = summary(RESULT.assign_attrs(interface="me"))
    assert not {"solver", "error estimate"} & set(told)
    assert told["steps"] == "12,345"


def test_energy_that_does_not_change_is_nothing_to_compare_with() -> None:
    still = RESULT.assign(energy=("time", [50.0, 50.0, 50.0]))
    assert summary(still)["energy residual"] == "-0.00015 J"
    assert summary(RESULT.drop_vars("energy"))["energy residual"] == "-0.00015 J"


def test_the_table_has_a_line_for_each() -> None:
    text = io.StringIO()
    print_summary(RESULT, Console(file=text, width=120))
    assert "swing" in text.getvalue()
    for label, value in summary(RESULT).items():
        assert any(label in line and value in line for line in text.getvalue().splitlines())
