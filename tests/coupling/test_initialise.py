"""The start of a coupling: values that agree, through chains of feedthrough and round a loop."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from cablefmu.coupling import couple
from tests.coupling.oscillators import BETWEEN, STARTS, oscillators
from tests.coupling.vessels import LOAD_STIFFNESS, START, STIFFNESS, vessel


@pytest.mark.parametrize("algorithm", ["jacobi", "iterated"])
def test_inputs_go_through_whoever_answers_at_once(algorithm: str, cables: Path) -> None:
    result = couple(oscillators(cables, algorithm=algorithm))
    assert result["spring.F_a"].values[0] == pytest.approx(-BETWEEN * (STARTS[0] - STARTS[1]), rel=1e-14)
    assert result["power.a.residual"].values[0] == 0.0


@pytest.mark.parametrize("ratio", [0.1, 5.0, 100.0])
@pytest.mark.parametrize("algorithm", ["jacobi", "iterated"])
def test_loops_are_solved_though_repetition_would_blow_up(
    algorithm: str, ratio: float, slave: Callable[[str], Path]
) -> None:
    """Let go from START both accelerate as one mass, whatever the algorithm does afterwards."""
    coupling = vessel(slave, ratio=ratio, algorithm=algorithm, extrapolation=0, step=2.0, delayed=True)
    start = couple(coupling).isel(time=0)
    acceleration = -(STIFFNESS + LOAD_STIFFNESS) * START / (1.0 + ratio)
    assert float(start["vessel.a"]) == pytest.approx(acceleration, rel=1e-5)
    assert float(start["load.F"]) == pytest.approx(-ratio * acceleration - LOAD_STIFFNESS * START, rel=1e-5)
