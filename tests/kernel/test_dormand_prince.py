"""The pair's coefficients fulfil their order conditions, exactly, as fractions."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from math import prod

import numpy as np
import pytest

Tree = tuple["Tree", ...]
"""A rooted tree: its branches, sorted. One order condition each (Butcher)."""
Fractions = list[Fraction]
Tableau = tuple[list[Fractions], Fractions, Fractions, Fractions]
"""a, b, b_embedded, c"""

STAGES = 7


@cache
def trees(order: int) -> frozenset[Tree]:
    """All rooted trees with `order` vertices: a leaf put on every vertex of the smaller ones."""
    if order == 1:
        return frozenset({()})
    return frozenset(grown for tree in trees(order - 1) for grown in with_a_leaf_more(tree))


def with_a_leaf_more(tree: Tree) -> Iterable[Tree]:
    yield tuple(sorted([*tree, ()]))
    for k, branch in enumerate(tree):
        for grown in with_a_leaf_more(branch):
            yield tuple(sorted([*tree[:k], grown, *tree[k + 1 :]]))


def size(tree: Tree) -> int:
    return 1 + sum(map(size, tree))


def density(tree: Tree) -> int:
    """gamma(tree) of the condition sum_i b_i phi_i(tree) = 1 / gamma(tree)."""
    return size(tree) * prod(map(density, tree))


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


def test_there_are_as_many_trees_as_butcher_says() -> None:
    assert [len(trees(order)) for order in range(1, 7)] == [1, 1, 2, 4, 9, 20]


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
