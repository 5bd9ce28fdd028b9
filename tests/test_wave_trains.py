"""Waves of which seas are made: dispersion and its limits, harmonics, amplitudes."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from cablefmu.scene_mistakes import MistakeFoundError
from cablefmu.wave_trains import airy, breaking_height, irregular, nonlinear, profiles, wave_number

G = 9.81


def test_dispersion_from_shallow_to_deep() -> None:
    """omega^2 = g k tanh(k d) in 40 digits, k d from 1e-4 to 1e4."""
    for depth in (0.3, 20.0, 4000.0):
        k = np.logspace(-4.0, 4.0, 81) / depth
        with mpmath.workdps(40):
            omega = [float(mpmath.sqrt(G * mpmath.mpf(v) * mpmath.tanh(mpmath.mpf(v) * depth))) for v in k.tolist()]
        assert np.abs(wave_number(np.array(omega), depth, G) / k - 1.0).max() < 1e-14
    assert np.array_equal(wave_number(np.array([2.0]), np.inf, G), [4.0 / G])


def test_profiles_without_overflow() -> None:
    k, depth = np.array([1e-3, 0.4, 90.0, 5000.0]), 35.0
    for y in (0.0, 0.1, 34.0, 35.0):
        along, up = profiles(k, y, depth)
        with mpmath.workdps(60):
            for number, v in enumerate(map(mpmath.mpf, k.tolist())):
                whole, place = mpmath.cosh(v * depth), v * (depth - mpmath.mpf(y))
                assert along[number] == pytest.approx(float(mpmath.cosh(place) / whole), rel=1e-12, abs=1e-300)
                assert up[number] == pytest.approx(float(mpmath.sinh(place) / whole), rel=1e-12, abs=1e-300)
    deep = profiles(k[:2], 3.0, np.inf)
    assert np.array_equal(deep[0], np.exp(-3.0 * k[:2])) and np.array_equal(deep[1], deep[0])


def test_shallow_and_deep_limits_of_the_regular_wave() -> None:
    """A long wave runs with sqrt(g d) and moves the whole column alike; a short one does not feel the seabed."""
    shallow = airy(0.01, 200.0, None, 1.0, G)
    kd = shallow.k[0] * 1.0
    assert 2.0 * np.pi / 200.0 / shallow.k[0] == pytest.approx(np.sqrt(G), rel=kd**2)
    assert shallow.speed[0] == pytest.approx(0.005 * np.sqrt(G), rel=kd**2)
    assert profiles(shallow.k, 1.0, 1.0)[0][0] == pytest.approx(1.0, rel=kd**2)
    bottomless, far = airy(2.0, 6.0, None, np.inf, G), airy(2.0, 6.0, None, 500.0, G)
    assert far.k[0] == pytest.approx(bottomless.k[0], rel=1e-15)
    assert far.speed[0] == bottomless.speed[0] == pytest.approx(2.0 * np.pi / 6.0, rel=1e-15)


def test_breaking_heights_of_miche() -> None:
    """0.142 of the length in deep water, 0.89 of the depth in shallow water."""
    assert breaking_height(2.0 * np.pi / 50.0, np.inf) == pytest.approx(7.1)
    assert breaking_height(2.0 * np.pi / 1e5, 3.0) == pytest.approx(0.142 * 2.0 * np.pi * 3.0, rel=1e-6)


def test_the_stream_function_wave_is_stokes_wave_where_that_is_good() -> None:
    """Deep water: c^2 = g/k (1 + e^2 + e^4/2) to the fifth order, e = k H/2 (Fenton 1985); e = 0.1 leaves 1e-6."""
    train = nonlinear("Fenton", 0.2 / 0.05, None, 2.0 * np.pi / 0.05, np.inf, G, 10)
    speed = 2.0 * np.pi / train.period / 0.05
    e = 0.05 * 4.0 / 2.0
    assert speed**2 == pytest.approx(G / 0.05 * (1.0 + e**2 + 0.5 * e**4), rel=3e-6)
    assert train.elevation[0] == pytest.approx(2.0, rel=e**2)
    assert train.elevation[1] == pytest.approx(0.5 * 0.05 * 4.0, rel=2.0 * e**2)


def test_amplitudes_of_an_irregular_sea_hold_its_height_exactly() -> None:
    for gamma in (None, 1.0, 3.3, 7.0):
        train = irregular(4.0, 10.0, gamma, 10_800.0, 50.0, G)
        assert 4.0 * np.sqrt(np.sum(train.elevation**2) / 2.0) == pytest.approx(4.0, rel=1e-14)
        assert train.first == 540 and len(train.k) == 6480 - 540 + 1
        assert (train.first + int(train.elevation.argmax())) / 10_800.0 == pytest.approx(0.1, rel=1e-3)
    plain, one = (irregular(4.0, 10.0, gamma, 1000.0, 50.0, G).elevation for gamma in (None, 1.0))
    assert np.abs(plain / one - 1.0).max() < 1e-12  # gamma = 1 is Pierson and Moskowitz' spectrum


@pytest.mark.parametrize("height", [17.0, 30.0, 1e6])
def test_waves_that_do_not_exist_are_not_found(height: float) -> None:
    for theory in ("Stokes", "Fenton"):
        for length, period in ((100.0, None), (None, 7.5)):
            with pytest.raises(MistakeFoundError, match="break from"):
                nonlinear(theory, height, period, length, np.inf, G, 5)
