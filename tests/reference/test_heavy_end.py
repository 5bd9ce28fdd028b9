"""An end of 8e8 kg in doubles against 50 digits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Terminal
from cablefmu.reference import Reference
from cablefmu.reference.extended import extended_acceleration, extended_outputs
from tests.random_cables import random_cable, random_inputs, random_state

HEAVY_MASSES = [60.0, 8e8, 1e12]


def anchored(mass: float) -> Cable:
    """A random cable of 12 links on a neutrally buoyant anchor [kg]."""
    cable = random_cable(np.random.default_rng(20), 12, Terminal.ANCHOR_MASS, water=True)
    return replace(cable, parameters=cable.parameters | {"m_c": mass})


@pytest.mark.parametrize("mass", HEAVY_MASSES)
def test_bordered_equation_keeps_its_digits_at_any_mass(mass: float) -> None:
    cable, rng = anchored(mass), np.random.default_rng(21)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    exact = extended_acceleration(cable, q, v, inputs).astype(float)
    bordered = Reference(cable, heavy_end=True).acceleration(q, v, inputs)
    # 16 digits less the condition of the cable without its end
    assert bordered == pytest.approx(exact, rel=0, abs=1e-11 * np.abs(exact).max())
    tensions = ("tension_top", "tension_end", "tension_max")
    outputs, exactly = (
        Reference(cable, heavy_end=True).outputs(q, v, inputs),
        extended_outputs(cable, q, v, inputs),
    )
    for name in tensions:
        assert outputs[name] == pytest.approx(float(exactly[name]), rel=1e-9), name


def test_mass_inside_the_matrix_costs_digits() -> None:
    """Why `heavy_end` exists: at 1e12 kg the plain matrix is a million times worse."""
    cable, rng = anchored(1e12), np.random.default_rng(21)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    exact = extended_acceleration(cable, q, v, inputs).astype(float)
    errors = [np.abs(Reference(cable, heavy_end=how).acceleration(q, v, inputs) - exact).max() for how in (False, True)]
    assert errors[0] > 1e6 * errors[1]


def test_border_is_chosen_for_heavy_ends_only() -> None:
    assert [Reference(anchored(mass)).heavy_end for mass in HEAVY_MASSES] == [False, True, True]
