"""I(x), C and K against the Lagrangian's second derivatives, element by element, in symbols."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from cablefmu.cable import Terminal, Top
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.matrices import damping_matrix, inertia_matrix, stiffness_matrix
from cablefmu.reference.outputs import kinetic_energy
from tests.random_cables import random_cable, random_state
from tests.reference.lagrangian import DERIVED, derive, same


@pytest.mark.parametrize(("n", "top"), DERIVED)
def test_inertia_is_the_second_derivative_of_the_kinetic_energy(n: int, top: Top) -> None:
    derivation = derive(n, top)
    matrix = inertia_matrix(derivation.chain, derivation.motion)
    expected = derivation.inertia()
    assert matrix.shape == expected.shape
    for row in range(len(matrix)):
        for column in range(len(matrix)):
            assert same(matrix[row, column], expected[row, column]), (row, column)


@pytest.mark.parametrize(("n", "top"), DERIVED)
def test_stiffness_and_damping_are_second_derivatives_too(n: int, top: Top) -> None:
    derivation = derive(n, top)
    stiffness = sp.hessian(derivation.spring_energy, derivation.q)
    damping = sp.hessian(derivation.spring_loss, derivation.v)
    assert sp.Matrix(stiffness_matrix(derivation.chain)) == stiffness
    assert sp.Matrix(damping_matrix(derivation.chain)) == damping


@pytest.mark.parametrize("top", Top)
@pytest.mark.parametrize("terminal", Terminal)
def test_quadratic_form_is_the_energy_of_the_parts(terminal: Terminal, top: Top) -> None:
    """Of a top whose motion is given, with the top at rest."""
    rng = np.random.default_rng(12)
    cable = random_cable(rng, 40, terminal, water=True, top=top)
    chain, (q, v) = chain_of(cable), random_state(rng, cable)
    motion = motion_of(q, v, top=top)
    # both are sums of some 40^2 positive and negative terms: a few hundred roundings
    assert v @ inertia_matrix(chain, motion) @ v / 2 == pytest.approx(kinetic_energy(chain, motion), rel=1e-12)
