"""Fixed points: linear problems that diverge by repetition, non-linear ones, and none at all."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.cable import Floats
from cablefmu.coupling.fixed_point import NotFoundError, solve
from cablefmu.coupling.schema import IterationSpec

TIGHT = IterationSpec(tolerance=1e-10)


@pytest.mark.parametrize("size", [1, 2, 5])
def test_a_linear_problem_that_repetition_blows_up_takes_two_evaluations_more_than_values(size: int) -> None:
    draw = np.random.default_rng(size)
    matrix = draw.normal(size=(size, size)) - 5.0 * np.eye(size)
    right = draw.normal(size=size)
    found = solve(lambda w: matrix @ w + right, np.zeros(size), np.ones(size), TIGHT)
    assert found.values == pytest.approx(np.linalg.solve(np.eye(size) - matrix, right), abs=1e-8)
    assert found.evaluations <= size + 3  # one to see that it is there


def test_values_of_very_different_size_are_found_alike() -> None:
    """A force in N and a displacement in m: each is measured by its own scale."""
    matrix = np.array([[0.0, -3e6], [1e-6, 0.0]])
    found = solve(lambda w: matrix @ w + np.array([1e6, 1.0]), np.zeros(2), np.array([1e6, 1.0]), TIGHT)
    exact = np.linalg.solve(np.eye(2) - matrix, [1e6, 1.0])
    assert found.values / exact == pytest.approx([1.0, 1.0], abs=1e-9)


def test_a_nonlinear_problem_is_found_where_repetition_swings() -> None:
    found = solve(lambda w: 4.0 * np.cos(w), np.array([1.0]), np.ones(1), TIGHT)
    assert found.values == pytest.approx(4.0 * np.cos(found.values), abs=1e-9)


def test_nothing_to_find_takes_one_evaluation() -> None:
    assert solve(lambda w: w, np.empty(0), np.empty(0), TIGHT).evaluations == 1


@pytest.mark.parametrize("acceleration", ["quasi-newton", "none"])
def test_where_there_is_none_the_residual_says_how_far_off_it_was(acceleration: str) -> None:
    def shifted(w: Floats) -> Floats:
        return w + np.array([0.0, 2.0])

    settings = IterationSpec.model_validate({"most": 5, "acceleration": acceleration})
    with pytest.raises(NotFoundError) as raised:
        solve(shifted, np.zeros(2), np.array([1.0, 4.0]), settings)
    assert raised.value.residual.tolist() == [0.0, 0.5]
