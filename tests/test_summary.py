"""The table at the end of a run."""

from __future__ import annotations

import io

import xarray as xr
from rich.console import Console

from cablefmu.summary import print_summary, summary

RESULT = xr.Dataset(
    {
        "x_c": ("time", [0.0, 3.0, 4.5]),
        "y_c": ("time", [10.0, 9.0, 8.25]),
        "tension_max": ("time", [100.0, 2500.5, 300.0]),
        "energy": ("time", [50.0, 40.0, -25.0]),
    },
    coords={"time": [0.0, 0.5, 1.0]},
    attrs={"title": "swing", "solver_steps": 12345, "solver_rejected": 1, "solver_rhs": 74000, "run_time": 0.002},
)


def test_what_one_looks_at_first() -> None:
    assert summary(RESULT) == {
        "terminal position": "x_c = 4.5 m, y_c = 8.25 m at t = 1 s",
        "largest tension": "2500.5 N at t = 0.5 s",
        "energy drift": "-75 J, start to end (work of forces and damping included)",
        "steps": "12,345",
        "rejected steps": "1",
        "right-hand sides": "74,000",
        "run time": "0.002 s",
        "faster than real time": "500 times",
    }


def test_only_what_the_result_holds() -> None:
    bare = RESULT[["x_c"]].drop_attrs()
    assert summary(bare) == {}


def test_the_table_has_a_line_for_each() -> None:
    text = io.StringIO()
    print_summary(RESULT, Console(file=text, width=120))
    assert "swing" in text.getvalue()
    for label, value in summary(RESULT).items():
        assert any(label in line and value in line for line in text.getvalue().splitlines())
