"""Positions by hand, velocities and accelerations as their derivatives along a path."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Terminal
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import accelerations, centres, motion_of, points, velocities
from tests.random_cables import random_cable, random_state
from tests.reference.lagrangian import vectorised


def test_two_links_by_hand() -> None:
    """2 m straight down from (0, 0.5), then 4 m at 30 degrees to the right."""
    cable = random_cable(np.random.default_rng(0), 2, Terminal.LOAD, water=False)
    chain = replace(chain_of(cable), length=np.array([2.0, 4.0]))
    at = points(chain, motion_of(np.array([0.5, 0.0, np.pi / 6]), np.zeros(3)))
    assert at == pytest.approx(np.array([[0.0, 0.5], [0.0, 2.5], [2.0, 2.5 + 2 * np.sqrt(3.0)]]))
    assert centres(at) == pytest.approx(np.array([[0.0, 1.5], [1.0, 2.5 + np.sqrt(3.0)]]))


def test_velocity_and_acceleration_are_derivatives_of_position() -> None:
    """Along q + v t + a t^2/2, by central differences in 60 digits: 1e-15 steps err by 1e-30."""
    rng = np.random.default_rng(2)
    cable = random_cable(rng, 7, Terminal.LOAD, water=False)
    exact = vectorised(mpmath.mpf)
    with mpmath.workdps(60):
        chain = chain_of(cable, mpmath.mpf)
        q, v = (exact(x) for x in random_state(rng, cable))
        a, step = exact(rng.normal(size=8)), mpmath.mpf(10) ** -15

        def at(t: object) -> np.ndarray:
            moved = motion_of(q + v * t + a * t * t / 2, v + a * t, vectorised(mpmath.sin), vectorised(mpmath.cos))
            return points(chain, moved)

        now = motion_of(q, v, vectorised(mpmath.sin), vectorised(mpmath.cos))
        rate = (at(step) - at(-step)) / (2 * step)
        bend = (at(step) - 2 * at(0 * step) + at(-step)) / step**2
        assert abs(rate - velocities(chain, now)).max() < 1e-25
        assert abs(bend - accelerations(chain, now, a)).max() < 1e-25
