"""Power residuals: what a held input gets wrong, by hand, and how they fall with the step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cablefmu.coupling import couple
from cablefmu.coupling.connections import Connection, Variable
from cablefmu.coupling.power import Bond
from tests.coupling.oscillators import oscillators

V, F, F_IN, V_IN = Variable("a", "v"), Variable("b", "F"), Variable("a", "F_in"), Variable("b", "v_in")


def test_powers_are_what_each_side_says_times_what_it_is_given_less_the_gains() -> None:
    bond = Bond("x", Connection(V, V_IN, 2.0), Connection(F, F_IN, -1.0))
    # a moves at 3 m/s under -50 N; b was told 5 (2 times 2.5 m/s) and pulls with 60 N.
    assert bond.powers({V: 3.0, F: 60.0}, {F_IN: -50.0, V_IN: 5.0}) == (150.0, 150.0)
    assert bond.powers({V: 3.0, F: 60.0}, {F_IN: -60.0, V_IN: 6.0}) == (180.0, 180.0)


@pytest.mark.parametrize("extrapolation", [0, 1, 2])
def test_residuals_fall_as_the_error_of_inputs_does(extrapolation: int, cables: Path) -> None:
    """Inputs of order p are wrong by h^(p+1) in Gauss-Seidel; after the start, where their order is lower."""
    coarse, fine = (
        couple(oscillators(cables, step=h, algorithm="gauss-seidel", extrapolation=extrapolation)) for h in (0.02, 0.01)
    )
    largest = [np.abs(result["power.a.residual"].sel(time=slice(0.5, None)).values).max() for result in (coarse, fine)]
    assert np.log2(largest[0] / largest[1]) == pytest.approx(extrapolation + 1.0, abs=0.3)
    assert coarse["power.a.residual"].values[0] == 0.0


def test_an_iterated_step_leaves_no_power_behind(cables: Path) -> None:
    result = couple(oscillators(cables, algorithm="iterated", extrapolation=1))
    assert np.abs(result["power.a.residual"].values).max() < 1e-4 * np.abs(result["power.a"].values).max()
