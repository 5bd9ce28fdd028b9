"""The terminal's force: virtual work against the Lagrangian, and the dissertation's rule beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Floats, Terminal, Top
from cablefmu.reference.chain import Chain, chain_of
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.terminal import departure, projected, terminal_force, terminal_vector, virtual_work
from tests.random_cables import random_cable
from tests.reference.lagrangian import DERIVED, derive, same


def straight(n: int, length: float, degrees: float) -> tuple[Chain, Motion]:
    """n equal links in a line at rest."""
    cable = random_cable(np.random.default_rng(5), n, Terminal.LOAD, water=False)
    chain = replace(chain_of(cable), length=np.full(n, length))
    q = np.concatenate([[0.0], np.full(n, np.radians(degrees))])
    return chain, motion_of(q, np.zeros(n + 1))


def force_at(size: float, degrees: float) -> Floats:
    """A force at an angle from the downward vertical, positive towards +x [N]."""
    return size * np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])


@pytest.mark.parametrize(("n", "top"), DERIVED)
def test_virtual_work_of_inputs_springs_and_preload(n: int, top: Top) -> None:
    derivation = derive(n, top)
    force = terminal_force(derivation.chain, derivation.motion, derivation.inputs)
    actual = terminal_vector(derivation.chain, derivation.motion, force, "virtual_work")
    for row, expected in enumerate(derivation.end_forces()):
        assert same(actual[row], expected), row


def test_example_of_both_rules() -> None:
    """5 links of 10 m at 30 degrees, 200 N at 40 degrees: 2000 N m sin 10 deg, times cos 10 deg projected."""
    chain, motion = straight(5, 10.0, 30.0)
    force = force_at(200.0, 40.0)
    assert virtual_work(chain, motion, force)[1:] == pytest.approx([347.3] * 5, abs=0.05)
    assert projected(chain, motion, force)[1:] == pytest.approx([342.0] * 4 + [347.3], abs=0.05)
    moment = 2000.0 * np.sin(np.radians(10.0))
    lost = moment * (1 - np.cos(np.radians(10.0)))
    assert departure(chain, motion, force)[1:] == pytest.approx([-lost] * 4 + [0.0], abs=1e-10)


def test_projected_rule_loses_a_cosine_at_every_bend() -> None:
    """Links at 0, 10, 30, 60 degrees; the factors written out by hand from the rule's definition."""
    chain, _ = straight(4, 1.0, 0.0)
    angles = np.radians([0.0, 10.0, 30.0, 60.0])
    motion = motion_of(np.concatenate([[0.0], angles]), np.zeros(5))
    force = force_at(100.0, 75.0)
    cos_alpha = np.cos(np.radians(15.0))
    factors = [
        cos_alpha * np.cos(np.radians(20.0)) * np.cos(np.radians(30.0)),
        cos_alpha * np.cos(np.radians(30.0)),
        cos_alpha,
        1.0,
    ]
    moments = 100.0 * np.sin(np.radians(75.0) - angles)
    assert projected(chain, motion, force) == pytest.approx([0.0, *(factors * moments)], rel=1e-13)


def test_without_force_no_rule_does_anything() -> None:
    chain, motion = straight(3, 10.0, 20.0)
    assert not np.any(projected(chain, motion, np.zeros(2)))
    assert not np.any(virtual_work(chain, motion, np.zeros(2)))
