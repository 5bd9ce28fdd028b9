"""Polynomials through samples: exact for polynomials of their order, at uneven times too."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.coupling.extrapolation import through

TIMES = (0.3, 0.41, 0.7, 0.75)
ROUNDING = 1e-12
"""Of values of order 1 to 10; divided differences over 0.05 s lose two digits."""


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_polynomial_of_the_order_is_continued_exactly_with_its_derivatives(order: int) -> None:
    exact = np.polynomial.Polynomial([2.0, -3.0, 5.0][: order + 1])
    found = through([(time, float(exact(time))) for time in TIMES], order)
    for time in (0.1, 0.75, 0.9):
        assert found(time) == pytest.approx(exact(time), abs=ROUNDING)
        expected = [exact.deriv(k)(time) for k in range(1, order + 1)]
        assert found.derivatives(time) == pytest.approx(expected, abs=100.0 * ROUNDING)


def test_with_few_samples_the_order_is_lower() -> None:
    assert through([(0.0, 4.0)], 2)(7.0) == 4.0
    assert through([(0.0, 4.0), (1.0, 6.0)], 2)(3.0) == 10.0


def test_only_the_newest_samples_count() -> None:
    assert through([(0.0, 1e9), (1.0, 2.0), (2.0, 3.0)], 1)(3.0) == 4.0
