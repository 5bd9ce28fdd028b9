"""Extremes, and the damage-equivalent range, against cycle counts that are printed and sines whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.sweeping.figures import Plan, equivalent_range, figures, plan_for
from cablefmu.sweeping.schema import StatisticsSpec
from cablefmu.sweeping.subjects import Outcome, Output

ASTM = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
"""ASTM E1049-85 (2017), figure 6, with the counts of its table X: range 3: 0.5, 4: 1.5, 6: 0.5, 8: 1, 9: 0.5."""
COUNTED = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}


@pytest.mark.parametrize("slope", [1.0, 3.0, 5.0, 12.5])
def test_the_standard_s_example(slope: float) -> None:
    damage = sum(count * size**slope for size, count in COUNTED.items())
    expected = (damage / 20.0) ** (1.0 / slope)
    assert equivalent_range(ASTM, 20.0, slope) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("frequency", [0.5, 1.0, 2.0])
def test_a_sine_of_any_frequency(frequency: float) -> None:
    """N cycles of range 2A in T seconds: S_eq = 2A (N / T)^(1/m); 64 samples a period hold both of its peaks."""
    time = np.arange(0.0, 40.0, 1.0 / (64.0 * frequency))
    time = np.append(time, 40.0)
    sine = 7.0 + 3.0 * np.cos(2.0 * np.pi * frequency * time)
    assert equivalent_range(sine, 40.0, 4.0) == pytest.approx(6.0 * frequency**0.25, rel=1e-12)


def test_the_unit_does_not_matter_and_nothing_overflows() -> None:
    small, large = (equivalent_range(ASTM * factor, 20.0, 20.0) / factor for factor in (1e-150, 1e150))
    assert small == pytest.approx(equivalent_range(ASTM, 20.0, 20.0), rel=1e-12)
    assert large == pytest.approx(small, rel=1e-12)
    assert equivalent_range(np.full(5, 3.0), 20.0, 3.0) == 0.0


OUTPUTS = [Output(name, "N", "") for name in ("x_c", "tension_top", "solver.steps", "statics.residual")]


def test_what_is_kept_unless_the_file_says_otherwise() -> None:
    assert plan_for(OUTPUTS, StatisticsSpec()) == Plan({"x_c": 0, "tension_top": 1}, ["tension_top"], 3.0)
    asked = StatisticsSpec.model_validate({"outputs": ["solver.steps"], "fatigue": ["x_c"], "slope": 5})
    assert plan_for(OUTPUTS, asked) == Plan({"solver.steps": 2, "x_c": 0}, ["x_c"], 5.0)
    of_coupling = [Output("cable.tension_end", "N", ""), Output("cable.solver.steps", "", "")]
    assert plan_for(of_coupling, StatisticsSpec()).fatigue == ["cable.tension_end"]


def test_figures_of_a_run() -> None:
    values = np.column_stack([[2.0, -1.0, 0.5], [0.0, 4.0, 0.0]])
    outcome = Outcome(np.array([0.0, 1.0, 2.0]), values, "", 0.0)
    found = figures(outcome, Plan({"x": 0, "t": 1}, ["t"], 3.0))
    assert found == {
        "x.min": -1.0, "x.max": 2.0, "x.final": 0.5, "t.min": 0.0, "t.max": 4.0, "t.final": 0.0,
        "t.equivalent": pytest.approx((1.0 * 4.0**3 / 2.0) ** (1.0 / 3.0)),
    }  # fmt: skip
