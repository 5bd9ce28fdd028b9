"""Rest shapes between two ports, against balances that do not know how they were found."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq

from cablefmu.shapes import Catenary, NoCatenaryError, catenary, end_point, ending_at, straight

# Weight per metre of the common cable in water: pi (0.01 m)^2 (7850 - 1000) kg/m^3 9.81 m/s^2.
PER_METRE = math.pi * 1e-4 * 6850.0 * 9.81
END = 1e-9  # [m], what the format promises


def even(n: int, length: float = 240.0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    lengths = np.full(n, length / n)
    return lengths, PER_METRE * lengths


def assert_links_balance(shape: Catenary, lengths: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
    """Moments of each link about its upper end: the pull of what hangs below against half its weight.

    The force on the lower end of link i is (H, V - weights down to and with i), as the part above it must
    carry them; a frictionless joint takes no moment.
    """
    below = shape.vertical - np.cumsum(weights)
    sin, cos = np.sin(shape.angles), np.cos(shape.angles)
    # Force (H, below) at l e and weight (0, w) at l/2 e: x F_y - y F_x with y downward
    moments = lengths * (sin * (below + weights / 2.0) - cos * shape.horizontal)
    size = np.max(np.abs(weights)) + abs(shape.horizontal) + abs(shape.vertical)
    # sin and cos of angles that are right to rounding
    assert np.max(np.abs(moments)) < 1e-13 * size * np.max(lengths)


@pytest.mark.parametrize(
    ("n", "end"),
    [
        (60, (120.0, 200.0)),
        (110, (120.0, 200.0)),
        (80, (160.0, 0.0)),
        (10_000, (120.0, 200.0)),
        (80, (-160.0, 0.0)),
        (2, (100.0, 200.0)),
        (60, (1e-3, 200.0)),
        (60, (3.0, -200.0)),
        (60, (239.9999, 0.0)),
    ],
)
def test_the_chain_meets_both_ports_and_every_link_balances(n: int, end: tuple[float, float]) -> None:
    lengths, weights = even(n)
    shape = catenary(lengths, weights, end)
    assert end_point(lengths, shape.angles) == pytest.approx(end, abs=END)
    assert_links_balance(shape, lengths, weights)


def test_links_may_all_differ() -> None:
    lengths = np.array([3.0, 11.0, 0.5, 7.0, 20.0, 2.0, 9.0])
    weights = np.array([40.0, 3.0, 11.0, 90.0, 1.0, 70.0, 30.0])
    shape = catenary(lengths, weights, (25.0, 18.0))
    assert end_point(lengths, shape.angles) == pytest.approx((25.0, 18.0), abs=END)
    assert_links_balance(shape, lengths, weights)


def test_equal_floaters_carry_half_the_cable_each() -> None:
    lengths, weights = even(80)
    shape = catenary(lengths, weights, (160.0, 0.0))
    assert shape.vertical == pytest.approx(2533.3, abs=0.1)
    assert np.max(np.abs(shape.angles + shape.angles[::-1] - math.pi)) < 1e-12  # mirror image


def test_many_links_approach_the_smooth_catenary() -> None:
    # y = a cosh(x / a): span 160 m and arc 240 m give 2 a sinh(80 / a) = 240, and H = a weight per metre.
    a = brentq(lambda a: 2.0 * a * math.sinh(80.0 / a) - 240.0, 20.0, 200.0)
    errors = []
    for n in (40, 80, 160):
        lengths, weights = even(n)
        errors.append(abs(catenary(lengths, weights, (160.0, 0.0)).horizontal / (PER_METRE * a) - 1.0))
    assert errors[0] < 2e-3
    # second order: a link stands for its arc up to its length squared
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.02)


def test_a_cable_that_floats_hangs_upwards() -> None:
    lengths, weights = even(40)
    down, up = catenary(lengths, weights, (160.0, 30.0)), catenary(lengths, -weights, (160.0, -30.0))
    assert up.angles == pytest.approx(math.pi - down.angles, abs=1e-12)
    assert up.vertical == pytest.approx(-down.vertical, rel=1e-12)


@pytest.mark.parametrize(
    ("end", "says"),
    [
        ((240.0, 0.0), "240 m apart, and the cable is 240 m long"),
        ((200.0, 200.0), "must be longer"),
        ((0.0, 0.0), "too close together"),
        ((5.0, 0.0), "too close together"),
    ],
)
def test_ports_that_the_cable_cannot_join_are_refused(end: tuple[float, float], says: str) -> None:
    lengths, weights = even(3)
    with pytest.raises(NoCatenaryError, match=says):
        catenary(lengths, weights, end)


def test_a_cable_without_weight_has_no_rest_shape() -> None:
    with pytest.raises(NoCatenaryError, match="without weight"):
        catenary(np.ones(5), np.zeros(5), (3.0, 0.0))


def test_rounded_angles_are_brought_to_the_port() -> None:
    """Angles of three decimals miss it by centimetres; the nearest ones that do not differ by as little."""
    lengths = np.full(30, 8.0)
    exact = catenary(lengths, np.full(30, 100.0), (120.0, 200.0)).angles
    rounded = np.round(exact, 3)
    found = ending_at(lengths, rounded, (120.0, 200.0))
    assert np.hypot(*np.subtract(end_point(lengths, rounded), (120.0, 200.0))) > 1e-3
    assert end_point(lengths, found) == pytest.approx((120.0, 200.0), rel=0, abs=1e-12)  # ulps of 240 m
    assert np.linalg.norm(found - rounded) <= np.linalg.norm(exact - rounded)


def test_straight_is_straight() -> None:
    assert end_point(np.full(4, 2.0), straight(4, math.pi / 6.0)) == pytest.approx((4.0, 4.0 * math.sqrt(3.0)))
