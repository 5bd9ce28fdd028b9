"""The coefficients of the Rosenbrock methods fulfil their order conditions, on ordinary and on index-1 equations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from importlib.resources import files
from math import prod
from typing import Any

import numpy as np
import pytest

from cablefmu.cable import Floats
from tests.kernel.rosenbrock import DENSE_ORDER, NAMES, ROUNDING, Method
from tests.kernel.trees import IndexOneTree, Tree, density, index_one_density, index_one_trees, trees

INSIDE = (0.1, 0.5, 0.9)
"""Conditions of dense output are polynomials in s of degree 4 at most, zero at s = 0 and s = 1: three points decide."""

ENOUGH = 1e-4
"""The least that a condition beyond the order is off by."""


def phi(method: Method, tree: Tree) -> Floats:
    """Over the branches, the product of sum_j alpha_ij phi_j(branch); of a single branch, with beta_ij."""
    matrix = method.betas if len(tree) == 1 else method.alphas
    return prod((matrix @ phi(method, branch) for branch in tree), start=np.ones(method.stages))


def residuals(method: Method, weights: Floats, order: int, s: float = 1.0) -> Floats:
    """sum_i b_i phi_i - s^order / density of all trees of that order."""
    return np.array([weights @ phi(method, tree) - s**order / density(tree) for tree in sorted(trees(order))])


class IndexOne:
    """The same for y' = f(y, z), 0 = g(y, z) of index 1, each phi computed once."""

    def __init__(self, method: Method) -> None:
        self._stages, self._alphas, self._betas = method.stages, method.alphas, method.betas
        self._inverse, self._known = np.linalg.inv(self._betas), dict[IndexOneTree, Floats]()

    def phi(self, tree: IndexOneTree) -> Floats:
        """Like phi(), and for a fat root through the inverse of the matrix (beta_ij)."""
        if tree not in self._known:
            fat, branches = tree
            matrix = self._betas if len(branches) == 1 else self._alphas
            product = prod((matrix @ self.phi(branch) for branch in branches), start=np.ones(self._stages))
            self._known[tree] = self._inverse @ product if fat else product
        return self._known[tree]

    def worst(self, weights: Floats, order: int, *, fat: bool, s: float = 1.0) -> float:
        """The largest residual of that order."""
        some = index_one_trees(order, fat=fat)
        return max(abs(float(weights @ self.phi(tree)) - s**order / index_one_density(tree)) for tree in some)


def worst(method: Method, weights: Floats, order: int, s: float = 1.0) -> float:
    """The largest residual of at most that order."""
    return max(float(abs(residuals(method, weights, p, s)).max()) for p in range(1, order + 1))


def worst_of_index_one(method: Method, weights: Floats, order: int, s: float = 1.0) -> float:
    """Likewise; convergence of order p takes the trees of y up to order p and those of z up to p - 1 (VI.4)."""
    index_one = IndexOne(method)
    y = [index_one.worst(weights, p, fat=False, s=s) for p in range(1, order + 1)]
    z = [index_one.worst(weights, p, fat=True, s=s) for p in range(1, order)]
    return max(*y, *z)


def test_methods_are_of_the_published_size(method: Method) -> None:
    expected = {"Rodas4": (6, 4, 3, 2), "Rodas4P2": (6, 4, 3, 2), "Rodas5P": (8, 5, 4, 3)}
    assert (method.stages, method.order, method.error_order, len(method.dense)) == expected[method.name]


def test_times_and_their_derivatives_are_row_sums(method: Method) -> None:
    assert method.alpha == pytest.approx(method.alphas.sum(1), rel=0, abs=ROUNDING)
    assert method.d == pytest.approx(method.gammas.sum(1), rel=0, abs=ROUNDING)


def test_solution_is_of_its_order_and_no_higher(method: Method) -> None:
    assert worst(method, method.b, method.order) < ROUNDING
    assert worst_of_index_one(method, method.b, method.order) < ROUNDING
    assert worst(method, method.b, method.order + 1) > ENOUGH


def test_without_the_error_it_is_one_order_lower(method: Method) -> None:
    """Or the error estimate would vanish with it."""
    assert method.error_order == method.order - 1
    assert worst(method, method.b_embedded, method.error_order) < ROUNDING
    assert worst_of_index_one(method, method.b_embedded, method.error_order) < ROUNDING
    assert worst(method, method.b_embedded, method.order) > ENOUGH


@pytest.mark.parametrize("s", INSIDE)
def test_dense_output_is_of_its_order_and_no_higher(method: Method, s: float) -> None:
    order = DENSE_ORDER[method.name]
    assert worst(method, method.b_dense(s), order, s) < ROUNDING
    assert worst_of_index_one(method, method.b_dense(s), order, s) < ROUNDING
    assert worst(method, method.b_dense(s), order + 1, s) > ENOUGH


def test_order_two_survives_a_wrong_jacobian(method: Method) -> None:
    """The condition of a W-method of order 2, sum b_i gamma_i = 0; Rodas4 does not claim it."""
    assert (abs(method.b @ method.gammas.sum(1)) < ROUNDING) == (method.name != "Rodas4")


def left_free_by_order(method: Method) -> Floats:
    """What fixes the last stage's weight in each row of dense output; no condition up to the order sees it.

    Rodas4 and Rodas4P2 have none. Rodas5P has the least sum of squares of the k_i's weights (observed, not in the
    source): they are normal to the one direction that is free, the embedded error's. Relative to the sum
    without signs.
    """
    if method.name != "Rodas5P":
        return method.dense[:, -1]
    free = method.e @ method.gammas
    products = method.dense @ method.gammas @ free
    return np.asarray(products / (abs(method.dense) @ abs(method.gammas) @ abs(free)), dtype=float)


def conditions(method: Method) -> Floats:
    """Everything that is zero for the right coefficients."""
    dense = [(method.b_dense(s), s, order) for s in INSIDE for order in range(1, DENSE_ORDER[method.name] + 1)]
    return np.concatenate([
        method.alphas.sum(1) - method.alpha,
        method.gammas.sum(1) - method.d,
        method.m - method.e - method.a[-1],
        *(residuals(method, method.b, order) for order in range(1, method.order + 1)),
        *(residuals(method, method.b_embedded, order) for order in range(1, method.order)),
        *(residuals(method, weights, order, s) for weights, s, order in dense),
        left_free_by_order(method),
    ])  # fmt: skip


def with_one_slip(method: Method, slip: float) -> Iterator[tuple[str, Method]]:
    """The method with each coefficient in turn off by `slip`, the zeros on and above diagonals aside."""
    for field in fields(method):
        right = getattr(method, field.name)
        if field.name == "gamma":
            yield field.name, replace(method, gamma=right + slip)
        elif isinstance(right, np.ndarray):
            for index in np.ndindex(right.shape):
                if field.name in "ac" and index[1] >= index[0]:
                    continue
                wrong = right.copy()
                wrong[index] += slip
                changes: dict[str, Any] = {field.name: wrong}
                yield f"{field.name}{index}", replace(method, **changes)


def test_a_slip_in_any_coefficient_would_show(method: Method) -> None:
    """One coefficient off by 1e-8: some condition fails by ten times what passes for rounding."""
    assert abs(conditions(method)).max() < ROUNDING
    seen = {where: float(abs(conditions(wrong)).max()) for where, wrong in with_one_slip(method, 1e-8)}
    assert len(seen) == 1 + method.stages * (method.stages - 1) + (4 + len(method.dense)) * method.stages
    assert [where for where, size in seen.items() if size < 10 * ROUNDING] == []


def test_an_fmu_holds_the_method_in_use_and_no_other() -> None:
    content = (files("cablefmu") / "binaries" / "x86_64-linux" / "cable.so").read_bytes()
    assert [name for name in NAMES if name.encode() + b"\0" in content] == ["Rodas5P"]
