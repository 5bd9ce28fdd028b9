"""More digits change nothing but the rounding."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Terminal, Top
from cablefmu.reference import Reference
from cablefmu.reference.extended import extended_acceleration, extended_outputs
from tests.random_cables import random_cable, random_inputs, random_state


@pytest.mark.parametrize("top", Top)
@pytest.mark.parametrize("terminal", Terminal)
def test_outputs_agree_with_doubles(terminal: Terminal, top: Top) -> None:
    rng = np.random.default_rng(31)
    cable = random_cable(rng, 10, terminal, water=True, top=top)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    exact = {name: float(value) for name, value in extended_outputs(cable, q, v, inputs).items()}
    # 16 digits less the condition of I (up to 1e5)
    assert Reference(cable).outputs(q, v, inputs) == pytest.approx(exact, rel=1e-9)


def test_digits_asked_for_are_digits_got() -> None:
    rng = np.random.default_rng(32)
    cable = random_cable(rng, 6, Terminal.LOAD, water=True)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    before = mpmath.mp.dps
    coarse, fine = (extended_acceleration(cable, q, v, inputs, digits=digits) for digits in (40, 80))
    assert mpmath.mp.dps == before
    difference = abs(coarse - fine).max()
    # not zero, or the digits would not be the ones asked for; 40 digits less the condition of I
    assert 0 < difference < 1e-33


def test_projected_rule_in_many_digits() -> None:
    rng = np.random.default_rng(33)
    cable = random_cable(rng, 6, Terminal.LOAD, water=False)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    exact = extended_acceleration(cable, q, v, inputs, terminal_rule="projected").astype(float)
    in_doubles = Reference(cable, terminal_rule="projected").acceleration(q, v, inputs)
    assert in_doubles == pytest.approx(exact, rel=0, abs=1e-10 * np.abs(exact).max())
