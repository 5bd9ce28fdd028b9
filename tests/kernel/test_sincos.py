"""Sine and cosine against many digits."""

from __future__ import annotations

import ctypes
from heapq import nsmallest

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Floats

RANGE = 1.6e6
"""SINCOS_RANGE of sincos.h [rad]"""
ULP = 0.85
"""Units in the last place that sincos.c promises anywhere ..."""
ULP_HARDEST = 1.1
"""... but at the doubles nearest to some multiples of pi/2 (measured: 1.07 at 263205 pi/2)."""
BITS = 200


def sincos(library: ctypes.CDLL, x: Floats) -> tuple[Floats, Floats]:
    sine, cosine = np.full_like(x, np.nan), np.full_like(x, np.nan)
    library.sincos_array_portable(len(x), x, sine, cosine)
    return sine, cosine


def worst_ulp(library: ctypes.CDLL, x: Floats) -> float:
    """Largest error of either, in spacings of doubles at the exact value."""
    with mpmath.workprec(BITS):
        exact = [split(f(mpmath.mpf(a))) for a in x.tolist() for f in (mpmath.sin, mpmath.cos)]
    high, low = np.array(exact).T
    found = np.stack(sincos(library, x), axis=1).ravel()
    return float(np.max(np.abs((found - high) - low) / np.spacing(np.abs(high))))


def split(value: mpmath.mpf) -> tuple[float, float]:
    """A number as the nearest double and what is left."""
    high = float(value)
    return high, float(value - high)


def nearest_to_multiples(count: int) -> Floats:
    """Of the doubles nearest to k pi/2, for every k in the range, those that come closest."""
    with mpmath.workprec(BITS + 60):
        half_pi = int(mpmath.floor(mpmath.ldexp(mpmath.pi / 2, BITS)))
    one = 1 << BITS

    def distance(k: int) -> int:
        numerator, denominator = (k * half_pi / one).as_integer_ratio()
        return abs(numerator * (one // denominator) - k * half_pi)

    hardest = nsmallest(count, range(1, int(RANGE / (np.pi / 2))), key=distance)
    return np.array([k * half_pi / one for k in hardest])


@pytest.mark.parametrize("reach", [np.pi / 4, np.pi, 100.0, RANGE])
def test_error_at_random(library: ctypes.CDLL, reach: float) -> None:
    assert worst_ulp(library, np.random.default_rng(1).uniform(-reach, reach, 30_000)) < ULP


def test_error_of_small_angles(library: ctypes.CDLL) -> None:
    """A cable at rest hangs at angles of 1e-10 and less."""
    exponents = np.random.default_rng(2).uniform(-300, 0, 3000)
    assert worst_ulp(library, 10.0**exponents) < ULP


def test_error_beside_multiples_of_a_right_angle(library: ctypes.CDLL) -> None:
    """All the cancellation there can be: what is left comes from the later parts of pi/2 alone."""
    hardest = nearest_to_multiples(1000)
    assert worst_ulp(library, hardest) < ULP_HARDEST
    assert worst_ulp(library, np.nextafter(hardest, np.inf)) < ULP
    assert worst_ulp(library, np.nextafter(hardest, 0.0)) < ULP


def test_error_where_the_quadrant_changes(library: ctypes.CDLL) -> None:
    """At odd multiples of pi/4 the rounding decides between two reductions; both must hold."""
    count = np.random.default_rng(3).integers(0, int(RANGE / np.pi * 2), 2000).astype(np.float64)
    odd = (2.0 * count + 1.0) * (np.pi / 4)
    for x in (odd, np.nextafter(odd, np.inf), np.nextafter(odd, 0.0)):
        assert worst_ulp(library, x) < ULP


def test_odd_and_even_to_the_last_bit(library: ctypes.CDLL) -> None:
    """A mirrored cable must be the mirror image (the sine of -0 is 0, which no later sum tells apart)."""
    x = np.concatenate([[0.0], np.random.default_rng(4).uniform(0.0, RANGE, 100_000)])
    (sine, cosine), (mirrored_sine, mirrored_cosine) = sincos(library, x), sincos(library, -x)
    assert np.array_equal(mirrored_sine, -sine)
    assert np.array_equal(mirrored_cosine, cosine)


def test_length_is_one(library: ctypes.CDLL) -> None:
    """e_i is a unit vector within two roundings of each square, of their sum, and 0.85 ulp of each number."""
    sine, cosine = sincos(library, np.random.default_rng(5).uniform(-RANGE, RANGE, 1_000_000))
    assert np.abs(sine**2 + cosine**2 - 1.0).max() < 2 * np.finfo(float).eps


def test_any_count_gives_the_same_bits(library: ctypes.CDLL) -> None:
    """Side by side or one by one: how the compiler vectorises must not show."""
    x = np.random.default_rng(6).uniform(-10.0, 10.0, 37)
    together = np.stack(sincos(library, x))
    apart = np.stack([np.concatenate(sincos(library, x[k : k + 1])) for k in range(len(x))], axis=1)
    assert together.tobytes() == apart.tobytes()


def test_not_a_number_stays_one(library: ctypes.CDLL) -> None:
    assert np.all(np.isnan(sincos(library, np.array([np.nan]))))


def test_both_compiled_variants_give_the_same_bits(library: ctypes.CDLL) -> None:
    x = np.random.default_rng(2).uniform(-RANGE, RANGE, 1_000_003)
    wide = np.full_like(x, np.nan), np.full_like(x, np.nan)
    if library.probe_sincos_avx2(len(x), x, *wide):
        assert all(a.tobytes() == b.tobytes() for a, b in zip(sincos(library, x), wide, strict=True))


@pytest.mark.slow
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 60, reason="needs a long double with more digits than a double")
@pytest.mark.parametrize(("reach", "seed"), [(RANGE, 1), (RANGE, 2), (100.0, 3), (np.pi, 4)])
def test_error_and_bits_over_a_hundred_million_arguments(library: ctypes.CDLL, reach: float, seed: int) -> None:
    """25 million each: against the platform's long double functions, and both variants against each other."""
    worst = library.probe_sincos_worst(25_000, reach, seed)
    assert 0.5 <= worst < ULP
