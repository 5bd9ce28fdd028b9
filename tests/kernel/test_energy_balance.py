"""The solver's own account of energy: E - E_0 - work of the inputs + what drag and dampers took."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import simpson

from cablefmu.cable import Cable, SolverChoice
from cablefmu.reference import Reference
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.outputs import energy, powers
from cablefmu.scene import load_scene
from tests.kernel.library import Kernel, Run, Wave
from tests.kernel.motions import SOLVERS

AUTOMATIC, EXPLICIT, IMPLICIT = SOLVERS
CABLES = ("free-12-water", "seabed-pin-60", "floaters-both-80", "seabed-spring-60")
SPAN = 4
FORCES: dict[str, list[dict[str, Wave]]] = {
    "constant": [{"u_m1": (4e3, 0.0, 0.0)}],
    "sine": [{"u_m1": (1e3, 5e3, 2.0)}],
    "jumping": [{"u_m1": (force, 0.0, 0.0)} for force in (4e3, -3e3, 0.0, 5e3)],
}
"""By its pieces, of one second each, the last one going on."""


@dataclass(frozen=True)
class Account:
    """What the solver says of a run."""

    work: float
    """Of the inputs [J]"""
    taken: float
    """By drag and dampers [J]"""
    residual: float
    """E - E_0 - work + taken [J]"""
    runs: list[Run]


def account(
    library: ctypes.CDLL, cable: Cable, forces: str, *, tolerance: float, solver: SolverChoice, looks: int
) -> Account:
    """Of four seconds, with that many communication steps a second."""
    kernel, pieces = Kernel(library, cable), FORCES[forces]
    kernel.start(0.0, cable.position, cable.velocity, tolerance=tolerance, solver=solver)
    runs = [kernel.advance((k + 1) / looks, pieces[min(k // looks, len(pieces) - 1)]) for k in range(SPAN * looks)]
    assert {run.status for run in runs} == {"ok"}
    return Account(*kernel.energy_parts(), runs[-1].counters["energy_residual"], runs)


def by_quadrature(cable: Cable, forces: str, runs: list[Run], looks: int) -> Account:
    """The same of the states as they stand: the reference's energy and powers, Simpson's rule second by second."""
    chain = Reference(cable).chain
    motions = [motion_of(cable.position, cable.velocity), *(motion_of(run.q, run.v) for run in runs)]
    pieces, work, taken = FORCES[forces], 0.0, 0.0
    for second in range(SPAN):
        constant, amplitude, pulsation = pieces[min(second, len(pieces) - 1)]["u_m1"]
        inside = range(second * looks, (second + 1) * looks + 1)
        force = [constant + amplitude * np.sin(pulsation * k / looks) for k in inside]
        flows = [powers(chain, motions[k], {"u_m1": f}) for k, f in zip(inside, force, strict=True)]
        work += simpson([flow["u_m1"] for flow in flows], dx=1.0 / looks)
        taken -= simpson([sum(flow.values()) - flow["u_m1"] for flow in flows], dx=1.0 / looks)
    gained = energy(chain, motions[-1]) - energy(chain, motions[0])
    return Account(work, taken, float(gained - work + taken), runs)


@pytest.mark.parametrize("forces", FORCES)
@pytest.mark.parametrize("solver", [EXPLICIT, IMPLICIT])
@pytest.mark.parametrize("name", CABLES)
def test_work_and_losses_are_those_of_another_quadrature(
    library: ctypes.CDLL, name: str, solver: SolverChoice, forces: str
) -> None:
    """Every 5 ms of a run at 1e-9; both quadratures leave less than a part in a million of what went round."""
    cable = load_scene(name).cable
    found = account(library, cable, forces, tolerance=1e-9, solver=solver, looks=200)
    other = by_quadrature(cable, forces, found.runs, 200)
    scale = abs(other.work) + other.taken
    assert scale > 100.0
    assert found.work == pytest.approx(other.work, rel=0, abs=1e-6 * scale)
    assert found.taken == pytest.approx(other.taken, rel=0, abs=1e-5 * scale)
    assert abs(found.residual) < 1e-5 * scale


@pytest.mark.parametrize("forces", FORCES)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", CABLES)
def test_the_residual_falls_with_the_tolerance(
    library: ctypes.CDLL, name: str, solver: SolverChoice, forces: str
) -> None:
    """By two orders of magnitude and more from 1e-4 to 1e-8, or to 1e-7 of what went round."""
    cable = load_scene(name).cable
    found = [account(library, cable, forces, tolerance=t, solver=solver, looks=1) for t in (1e-4, 1e-8)]
    coarse, fine = (abs(one.residual) for one in found)
    scale = abs(found[1].work) + found[1].taken
    assert fine < 1e-2 * coarse or fine < 1e-7 * scale
    assert coarse < 1e-2 * scale and fine < 1e-4 * scale


def test_the_residual_is_the_error_of_the_motion(library: ctypes.CDLL) -> None:
    """Without any damping or force the residual is E - E_0, and that is the energy's error by another's account."""
    cable = load_scene("free-12-air").cable
    cable = replace(cable, parameters=cable.parameters | {"c_joint": 0.0, "c_m1": 0.0})
    chain = Reference(cable).chain
    start = energy(chain, motion_of(cable.position, cable.velocity))
    for solver in (EXPLICIT, IMPLICIT):
        run = Kernel(library, cable).run(np.array([0.0, 5.0]), tolerance=1e-3, solver=solver)[-1]
        error = energy(chain, motion_of(run.q, run.v)) - start
        assert abs(error) > 1e-3
        assert run.counters["energy_residual"] == pytest.approx(error, rel=0, abs=1e-8)
