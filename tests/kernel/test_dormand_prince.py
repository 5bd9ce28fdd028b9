"""The pair's coefficients fulfil their order conditions, exactly, as fractions."""

from __future__ import annotations

import ctypes
from fractions import Fraction
from math import prod

import numpy as np
import pytest

from tests.kernel.trees import Tree, density, trees

Fractions = list[Fraction]
Tableau = tuple[list[Fractions], Fractions, Fractions, Fractions]
"""a, b, b_embedded, c"""

STAGES = 7


def weights(tree: Tree, a: list[Fractions]) -> Fractions:
    """phi_i(tree): over the branches, the product of sum_j a_ij phi_j(branch)."""
    below = [weights(branch, a) for branch in tree]
    return [prod((dot(row, phi) for phi in below), start=Fraction(1)) for row in a]


def dot(x: Fractions, y: Fractions) -> Fraction:
    return sum((p * q for p, q in zip(x, y, strict=True)), Fraction(0))


def residual(tree: Tree, a: list[Fractions], b: Fractions) -> Fraction:
    return dot(b, weights(tree, a)) - Fraction(1, density(tree))


@pytest.fixture
def tableau(library: ctypes.CDLL) -> Tableau:
    """The fractions that the doubles were rounded from."""
    a, rows = np.zeros((STAGES, STAGES)), np.zeros((3, STAGES))
    assert library.probe_tableau(a, *rows) == STAGES
    doubles = np.vstack([a, rows])
    fractions = [[Fraction(x).limit_denominator(400_000) for x in row.tolist()] for row in doubles]
    assert np.array_equal(np.array([[float(x) for x in row] for row in fractions]), doubles)
    b, b_embedded, c = fractions[STAGES:]
    return fractions[:STAGES], b, b_embedded, c


@pytest.mark.parametrize("order", range(1, 6))
def test_solution_is_of_fifth_order(tableau: Tableau, order: int) -> None:
    a, b, _, _ = tableau
    assert [residual(tree, a, b) for tree in trees(order)] == [0] * len(trees(order))


@pytest.mark.parametrize("order", range(1, 5))
def test_embedded_solution_is_of_fourth_order(tableau: Tableau, order: int) -> None:
    a, _, b, _ = tableau
    assert [residual(tree, a, b) for tree in trees(order)] == [0] * len(trees(order))


def test_embedded_solution_is_of_no_higher_order(tableau: Tableau) -> None:
    """Or the error estimate would vanish with it."""
    a, _, b, _ = tableau
    assert any(residual(tree, a, b) for tree in trees(5))


def test_times_are_row_sums_and_the_last_stage_is_the_next_first(tableau: Tableau) -> None:
    a, b, _, c = tableau
    assert [sum(row) for row in a] == c
    assert a[-1] == b and c[-1] == 1
