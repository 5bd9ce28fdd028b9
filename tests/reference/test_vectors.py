"""F(x, x') and G(x) against the Lagrangian, element by element, in symbols."""

from __future__ import annotations

import pytest
import sympy as sp

from cablefmu.cable import Top
from cablefmu.reference.vectors import drive_vector, gravity_vector, velocity_vector
from tests.reference.lagrangian import DERIVED, derive, same


@pytest.mark.parametrize(("n", "top"), DERIVED)
def test_velocity_vector_and_drive_vector(n: int, top: Top) -> None:
    """The Lagrangian has both in one; without a given acceleration the first is left."""
    derivation = derive(n, top)
    chain, motion = derivation.chain, derivation.motion
    actual = velocity_vector(chain, motion) + drive_vector(chain, motion)
    for row, expected in enumerate(derivation.velocity_terms()):
        assert same(actual[row], expected), row
    accelerations = {derivation.inputs[name] for name in ("ax_1", "ay_1")}
    assert not any(sp.sympify(element).free_symbols & accelerations for element in velocity_vector(chain, motion))
    if top is not Top.MOTION:
        assert not any(drive_vector(chain, motion))


@pytest.mark.parametrize(("n", "top"), DERIVED)
def test_gravity_vector(n: int, top: Top) -> None:
    derivation = derive(n, top)
    actual = gravity_vector(derivation.chain, derivation.motion)
    for row, expected in enumerate(derivation.gradient(derivation.weight_energy)):
        assert same(actual[row], expected), row
