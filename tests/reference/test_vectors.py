"""F(x, x') and G(x) against the Lagrangian, element by element, in symbols."""

from __future__ import annotations

import pytest

from cablefmu.reference.vectors import gravity_vector, velocity_vector
from tests.reference.lagrangian import derive, same


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_velocity_vector(n: int) -> None:
    derivation = derive(n)
    actual = velocity_vector(derivation.chain, derivation.motion)
    for row, expected in enumerate(derivation.velocity_terms()):
        assert same(actual[row], expected), row


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_gravity_vector(n: int) -> None:
    derivation = derive(n)
    actual = gravity_vector(derivation.chain, derivation.motion)
    for row, expected in enumerate(derivation.gradient(derivation.weight_energy)):
        assert same(actual[row], expected), row
