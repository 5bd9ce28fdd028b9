"""Energy changes by the powers that act, and by nothing where none acts."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

import cablefmu
from cablefmu.cable import Floats, Terminal
from cablefmu.reference.kinematics import motion_of, velocities
from cablefmu.reference.outputs import powers
from tests.kernel.cases import case
from tests.kernel.library import Kernel
from tests.random_cables import KINDS

CENTRAL = {-3: -1 / 60, -2: 9 / 60, -1: -45 / 60, 1: 45 / 60, 2: -9 / 60, 3: 1 / 60}
"""Weights of the sixth-order central first difference."""


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("n", [1, 3, 12, 60])
def test_energy_changes_by_the_powers(library: ctypes.CDLL, n: int, kind: int) -> None:
    """dE/dt along (v, x''), all of it damped, with drag and inputs, against the sum of powers.

    The difference over 1 ms is of sixth order, so what is left is the rounding of energies of up to 1e8 J:
    1e-16 x 1e8 J / 1e-3 s = 1e-5 W beside powers of 1e3 W and more. Off its constraint, as here, a pin's force works
    on what moves.
    """
    c, step = case(library, n, kind), 1e-3
    a = c.kernel.acceleration(c.q, c.v, c.inputs)
    rate = sum(
        weight * c.kernel.outputs_without_tensions(c.q + c.v * k * step, c.v + a * k * step)["energy"]
        for k, weight in CENTRAL.items()
    )
    chain, motion = c.reference.chain, motion_of(c.q, c.v)
    flows = list(powers(chain, motion, c.inputs).values())
    if c.cable.terminal is Terminal.PIN:
        flows.append(-c.reference.joint_forces(c.q, c.v, c.inputs)[-1] @ velocities(chain, motion)[-1])
    assert rate / step == pytest.approx(sum(flows), rel=0, abs=1e-8 * sum(map(abs, flows)))


def drift(library: ctypes.CDLL, tolerance: float) -> float:
    """Largest change of energy in 31 s of the undamped free fall, every 0.5 s, over the energy it releases.

    That scale is what the weights lose from the start at 45 degrees to hanging straight down: 245 kJ.
    """
    cable = cablefmu.load_scene("free-12-air").cable
    kernel = Kernel(library, replace(cable, parameters=cable.parameters | {"c_joint": 0.0, "c_m1": 0.0}))
    still = np.zeros(cable.n + 1)

    def energy(q: Floats, v: Floats) -> float:
        return kernel.outputs_without_tensions(q, v)["energy"]

    start = energy(cable.position, cable.velocity)
    released = start - energy(still, still)
    assert released == pytest.approx(245e3, rel=0.01)
    runs = kernel.run(np.arange(0, 31.1, 0.5), tolerance=tolerance)
    assert runs[-1].status == "ok" and runs[-1].time == 31.0
    return max(abs(energy(run.q, run.v) - start) for run in runs) / released


def test_undamped_fall_keeps_its_energy(library: ctypes.CDLL) -> None:
    """At least as well as asked for, and better the tighter the tolerance (measured: 3e-7, 8e-9, 9e-11)."""
    coarse, middle, fine = (drift(library, tolerance) for tolerance in (1e-5, 1e-7, 1e-9))
    assert coarse < 1e-5 and middle < 1e-7 and fine < 1e-9
    assert coarse > 5 * middle > 25 * fine
