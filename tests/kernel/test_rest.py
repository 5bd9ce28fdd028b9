"""A run from an equilibrium stays there, whichever method integrates."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, SolverChoice, Terminal
from cablefmu.reference import Reference
from tests.kernel.library import Kernel
from tests.kernel.motions import SOLVERS, make_scene, places, speeds
from tests.random_cables import TERMINALS

AUTOMATIC, EXPLICIT, IMPLICIT = SOLVERS
LENGTH = {12: 240.0, 120: 240.0, 1000: 100.0}


def cable_of(terminal: Terminal, links: int) -> Cable:
    """A cable of every terminal kind; the anchor's mass such that the pull on it moves it by nothing in a minute.

    The seabed's 8e8 kg do creep, by pull / mass: 2e-4 m/s after a minute, as they must. 1e17 kg do not.
    """
    cable = make_scene(terminal, links, length=LENGTH[links], angle=0.3 if terminal is Terminal.LOAD else None).cable
    if terminal is Terminal.ANCHOR_MASS:
        cable = replace(cable, parameters=cable.parameters | {"m_c": 1e17})
    return cable


@pytest.mark.parametrize("solver", [AUTOMATIC, IMPLICIT])
@pytest.mark.parametrize("links", LENGTH)
@pytest.mark.parametrize("terminal", TERMINALS)
def test_rest_stays_rest(library: ctypes.CDLL, terminal: Terminal, links: int, solver: SolverChoice) -> None:
    """No point of the cable is faster than 1e-9 m/s at any time of a minute (measured: 6e-10 m/s at worst).

    Accelerations at the equilibrium are rounding: what pulls at a link is some kN over an inertia that falls with the
    third power of its length. An anchor that is held by nothing but its mass keeps what that gives it in velocity:
    1,000 links, 3e-9 m/s. Two floaters swing on it softly: 1,000 links, 6e-10 to 2e-9 m/s from starts 1e-14 apart.
    """
    bound = {(Terminal.ANCHOR_MASS, 1000): 1e-8, (Terminal.FLOATER, 1000): 4e-9}.get((terminal, links), 1e-9)
    cable = cable_of(terminal, links)
    forces = {"F_cx": 200.0} if terminal is Terminal.LOAD else {}
    kernel = Kernel(library, cable)
    status, q, _, _ = kernel.equilibrium(cable.position, forces)
    assert status == 0
    kernel.start(0.0, q, np.zeros_like(q), tolerance=1e-6, solver=solver)
    waves = {name: (force, 0.0, 0.0) for name, force in forces.items()}
    for k in range(600):
        run = kernel.advance(0.1 * (k + 1), waves)
        assert run.status == "ok" and speeds(cable, run.q, run.v).max() < bound
    assert np.abs(places(cable, run.q) - places(cable, q)).max() < 60.0 * bound
    assert run.counters["rejected"] == 0
    if solver is IMPLICIT:
        assert run.counters["steps"] < 20  # one grows from the other, far beyond the communication steps


def test_an_anchor_of_finite_mass_creeps_by_its_pull(library: ctypes.CDLL) -> None:
    """v = F t / m: 8e8 kg, after a minute, to a thousandth; F from the dense equations."""
    cable = make_scene(Terminal.ANCHOR_MASS, 12).cable
    kernel = Kernel(library, cable)
    _, q, _, _ = kernel.equilibrium(cable.position, {})
    pull = float(np.linalg.norm(Reference(cable).joint_forces(q, np.zeros_like(q), {})[-1]))
    assert 1e3 < pull < 2e3
    for solver in SOLVERS:
        kernel.start(0.0, q, np.zeros_like(q), tolerance=1e-8, solver=solver)
        run = kernel.advance(60.0, {})
        assert speeds(cable, run.q, run.v)[-1] == pytest.approx(pull * 60.0 / 8e8, rel=1e-3)
