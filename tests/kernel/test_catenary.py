"""The rest shape in the kernel; what balances it has to keep: tests/test_shapes.py."""

from __future__ import annotations

import ctypes
import math

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Floats

OK, TOO_SHORT, WEIGHTLESS, NO_FIT = range(4)


Place = tuple[float, float]


def catenary(library: ctypes.CDLL, lengths: Floats, weights: Floats, end: Place) -> tuple[int, Floats, Floats]:
    angles, pull = np.full(len(lengths), np.nan), np.full(2, np.nan)
    status = library.catenary(len(lengths), lengths, weights, np.array(end), angles, pull)
    return status, angles, pull


@pytest.mark.parametrize("n", [2, 3, 7, 40, 300])
def test_the_pull_that_a_shape_was_made_of_is_found(library: ctypes.CDLL, n: int) -> None:
    """Backwards: from a pull, by numpy's arc tangent, to where links end that hang in it; no two pulls end alike."""
    rng = np.random.default_rng(n)
    for _ in range(20):
        lengths, weights = rng.uniform(1.0, 3.0, n), rng.uniform(5.0, 50.0, n)
        pull = np.sum(weights) * np.array(
            [rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-2.0, 0.5), rng.uniform(-1, 2)]
        )
        angles = np.arctan2(pull[0], pull[1] - (np.cumsum(weights) - weights / 2.0))
        end = (float(lengths @ np.sin(angles)), float(lengths @ np.cos(angles)))
        status, found, found_pull = catenary(library, lengths, weights, end)
        assert status == OK
        # Where links hang straight, the end hardly moves with the pull: rounding of the end, 1e-16, comes back larger.
        np.testing.assert_allclose(found_pull, pull, rtol=0, atol=1e-10 * np.sum(weights))
        np.testing.assert_allclose(found, angles, rtol=0, atol=1e-10)


@pytest.mark.parametrize("n", [2, 60, 1000, 10_000])
def test_the_port_is_met_to_the_last_digits(library: ctypes.CDLL, n: int) -> None:
    """In many digits: what is left is the rounding of n angles and of the sum, not of the search."""
    lengths = np.full(n, 240.0 / n)
    status, angles, _ = catenary(library, lengths, lengths * 21.0, (120.0, 200.0))
    assert status == OK
    with mpmath.workdps(30):
        x = mpmath.fsum(mpmath.mpf(l_i) * mpmath.sin(mpmath.mpf(a)) for l_i, a in zip(lengths, angles, strict=True))
        y = mpmath.fsum(mpmath.mpf(l_i) * mpmath.cos(mpmath.mpf(a)) for l_i, a in zip(lengths, angles, strict=True))
    # A sum of n terms in double precision: 240 m 1.1e-16 sqrt(n) as roundings come, n at the worst.
    assert float(mpmath.hypot(x - 120, y - 200)) < 240.0 * 1.1e-16 * (4.0 + math.sqrt(n))


def test_angles_are_those_of_the_pull(library: ctypes.CDLL) -> None:
    """All round the circle, without an arc tangent: links heavy and light, above the port and below, left and right."""
    rng = np.random.default_rng(6)
    for end in ((3.0, 1.0), (-3.0, 1.0), (3.0, -4.0), (-1.0, -5.0), (0.5, 5.0)):
        lengths, weights = np.ones(80), rng.uniform(1.0, 2.0, 80) * rng.choice([1.0, 1e-6], 80)
        status, angles, pull = catenary(library, lengths, weights, (10.0 * end[0], 10.0 * end[1]))
        assert status == OK
        expected = np.arctan2(pull[0], pull[1] - (np.cumsum(weights) - weights / 2.0))
        # The last correction, which brings the end to the port, moves them by what the search left.
        np.testing.assert_allclose(angles, expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("length", "weight", "end", "status"),
    [
        (1.0, 5.0, (3.0, 0.0), TOO_SHORT),
        (1.0, 5.0, (2.0, 2.5), TOO_SHORT),
        (1.0, 0.0, (2.0, 0.0), WEIGHTLESS),
        (1.0, 5.0, (0.0, 0.0), NO_FIT),
        (1.0, 5.0, (0.1, 0.0), NO_FIT),
        (1.0, math.inf, (1.0, 1.0), NO_FIT),
        (math.inf, 1.0, (1.0, 1.0), NO_FIT),
        (1.0, 1.0, (math.inf, 1.0), TOO_SHORT),
        (1.0, 1.0, (math.nan, 1.0), TOO_SHORT),
    ],
)
def test_what_cannot_be_is_told(
    library: ctypes.CDLL, length: float, weight: float, end: tuple[float, float], status: int
) -> None:
    assert catenary(library, np.full(3, length), np.full(3, weight), end)[0] == status
