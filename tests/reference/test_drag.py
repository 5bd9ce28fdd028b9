"""Drag where one can say what it must be: broadside, lengthwise, and in what it takes from the energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Terminal
from cablefmu.reference.chain import chain_of
from cablefmu.reference.drag import drag_forces, drag_vector
from cablefmu.reference.kinematics import motion_of
from tests.random_cables import random_cable

HEAVE_RATE = 1.5  # m/s, downwards


def test_level_cable_sinking_broadside() -> None:
    """v_n = -v_m with n = (0, -1): every link is pushed up by c v^2, half its own and all beyond turn it."""
    chain = chain_of(random_cable(np.random.default_rng(3), 3, Terminal.LOAD, water=True))
    motion = motion_of(np.array([0.0, *[np.pi / 2] * 3]), np.array([HEAVE_RATE, 0.0, 0.0, 0.0]))
    push = chain.drag * HEAVE_RATE**2
    assert drag_forces(chain, motion) == pytest.approx(np.stack([np.zeros(3), -push], axis=1), abs=1e-12)
    beyond = np.array([push[1] + push[2], push[2], 0.0])
    # an upward force beyond a link turns a link that points right further up: theta grows
    expected = [-push.sum(), *(chain.length * (push / 2 + beyond))]
    assert drag_vector(chain, motion) == pytest.approx(expected)


def test_hanging_cable_sinking_lengthwise_feels_nothing() -> None:
    chain = chain_of(random_cable(np.random.default_rng(3), 3, Terminal.LOAD, water=True))
    motion = motion_of(np.zeros(4), np.array([HEAVE_RATE, 0.0, 0.0, 0.0]))
    assert not np.any(drag_vector(chain, motion))


def test_drag_is_quadratic_and_opposes_the_motion() -> None:
    cable = random_cable(np.random.default_rng(9), 6, Terminal.LOAD, water=True)
    chain, rng = chain_of(cable), np.random.default_rng(10)
    q, v = rng.normal(size=7), rng.normal(size=7)
    once = drag_vector(chain, motion_of(q, v))
    assert drag_vector(chain, motion_of(q, 3 * v)) == pytest.approx(9 * once, rel=1e-12)
    assert drag_vector(chain, motion_of(q, -v)) == pytest.approx(-once, rel=1e-12)
    assert v @ once < 0
    assert not np.any(drag_vector(replace(chain, drag=np.zeros(6)), motion_of(q, v)))
