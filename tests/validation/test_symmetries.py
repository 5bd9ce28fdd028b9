"""What no frame or mirror may change, over whole runs and at single instants."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Terminal
from tests.kernel.library import Kernel
from tests.random_cables import random_cable, random_state
from tests.validation.cables import FIXED

SEED = 20260101
SOLVER = 1e-9
"""Two runs at a local tolerance of 1e-10 take different steps"""


def free_cable(n: int, **parameters: float) -> Cable:
    """A random cable in air with a load, its floater on no spring or damper."""
    cable = random_cable(np.random.default_rng([SEED, n]), n, Terminal.LOAD, False)
    return replace(cable, parameters=cable.parameters | {"k_m1": 0.0, "c_m1": 0.0} | parameters)


@pytest.mark.parametrize("water", [False, True])
def test_run_of_the_mirror_image_is_the_mirror_image_of_the_run(library: ctypes.CDLL, water: bool) -> None:
    """x -> -x: link angles and sideways forces change sign, heave does not; to the last bit."""
    cable = random_cable(np.random.default_rng(SEED), 12, Terminal.LOAD, water)
    flip = np.array([1.0] + [-1.0] * cable.n)
    other = replace(cable, position=cable.position * flip, velocity=cable.velocity * flip)
    times = np.linspace(0.0, 2.0, 5)
    heave, pull, pushed = (500.0, 2e3, 3.0), (100.0, 800.0, 2.0), (-100.0, -800.0, 2.0)
    runs = Kernel(library, cable).run(times, tolerance=1e-6, waves={"u_m1": heave, "F_cx": pull})
    mirrored = Kernel(library, other).run(times, tolerance=1e-6, waves={"u_m1": heave, "F_cx": pushed})
    assert np.ptp([run.q[1:] for run in runs], axis=0).min() > 1e-3
    for run, image in zip(runs, mirrored, strict=True):
        assert np.array_equal(image.q, run.q * flip)
        assert np.array_equal(image.v, run.v * flip)


@pytest.mark.parametrize("water", [False, True])
@pytest.mark.parametrize("n", [1, 12])
def test_depth_does_not_matter(library: ctypes.CDLL, n: int, water: bool) -> None:
    """Moved down by 100 m, with k_m1 = 0: gravity and water are the same everywhere; accelerations to the last bit."""
    rng = np.random.default_rng([SEED, n])
    cable = random_cable(rng, n, Terminal.LOAD, water)
    cable = replace(cable, parameters=cable.parameters | {"k_m1": 0.0})
    q, v = random_state(rng, cable)
    lower = q + np.array([100.0] + [0.0] * n)
    kernel = Kernel(library, cable)
    assert np.array_equal(kernel.acceleration(lower, v, {}), kernel.acceleration(q, v, {}))


def test_galilei_in_air_an_even_motion_of_the_whole_cable_changes_nothing(library: ctypes.CDLL) -> None:
    """With another 5 m/s downwards every link swings as before, and the floater is 5 m/s t lower."""
    cable, speed = free_cable(12), 5.0
    boost = np.array([speed] + [0.0] * 12)
    times = np.linspace(0.0, 2.0, 5)
    still = Kernel(library, cable).run(times, tolerance=1e-10)
    moving = Kernel(library, replace(cable, velocity=cable.velocity + boost)).run(times, tolerance=1e-10)
    for a, b in zip(still, moving, strict=True):
        np.testing.assert_allclose(b.q, a.q + boost * a.time, rtol=0.0, atol=100.0 * SOLVER)
        np.testing.assert_allclose(b.v, a.v + boost, rtol=0.0, atol=100.0 * SOLVER)


def test_galilei_does_not_hold_in_water_which_is_at_rest(library: ctypes.CDLL) -> None:
    rng = np.random.default_rng(SEED)
    cable = random_cable(rng, 12, Terminal.LOAD, True)
    cable = replace(cable, parameters=cable.parameters | {"c_m1": 0.0})
    q, v = random_state(rng, cable)
    kernel = Kernel(library, cable)
    change = kernel.acceleration(q, v + np.array([5.0] + [0.0] * 12), {}) - kernel.acceleration(q, v, {})
    assert np.abs(change).max() > 0.1


@pytest.mark.parametrize("n", [1, 2, 12, 60])
def test_einstein_gravity_is_a_frame_that_falls_upwards(library: ctypes.CDLL, n: int) -> None:
    """In a frame that falls with g nothing has weight. The floater, which has none in ours, is then pushed up by M g:

    y_m'' (g) = g + y_m'' (g = 0, u_m1 - M_1 g), and the links' angles know of no difference. Rounding: 1e-11 of the
    largest acceleration.
    """
    cable = free_cable(n, static_load=0.0)
    rng = np.random.default_rng([SEED, n, 1])
    q, v = random_state(rng, cable)
    g, mass = cable.parameters["g"], cable.parameters["M_1"]
    weightless = replace(cable, parameters=cable.parameters | {"g": 0.0})
    forces = {"u_m1": 300.0, "F_cx": 200.0, "F_cy": -100.0}
    here = Kernel(library, cable).acceleration(q, v, forces)
    there = Kernel(library, weightless).acceleration(q, v, forces | {"u_m1": 300.0 - mass * g})
    there[0] += g
    np.testing.assert_allclose(here, there, rtol=0.0, atol=1e-11 * np.abs(here).max())


def test_pushed_sideways_without_weight_the_end_starts_as_a_straight_rod_does(library: ctypes.CDLL) -> None:
    """One link below a fixed top: th'' = F l / (m l^2/3 + m_c l^2), by any textbook."""
    cable = free_cable(1, g=0.0, static_load=0.0, M_1=FIXED, k_joint=0.0, c_joint=0.0, m_c=40.0, I_Rc=0.0)
    link = cable.links
    still = np.zeros(2)
    turning = Kernel(library, cable).acceleration(still, still, {"F_cx": 200.0})[1]
    arm, inertia = link.length[0], link.inertia[0] + (link.mass[0] / 4 + 40.0) * link.length[0] ** 2
    assert turning == pytest.approx(200.0 * arm / inertia, rel=1e-14)
