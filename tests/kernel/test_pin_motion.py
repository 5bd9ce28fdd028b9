"""The pin holds the cable's end where it is, whatever integrates and however long."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from cablefmu.cable import SolverChoice
from cablefmu.reference import integrate
from cablefmu.scene import load_scene
from tests.kernel.library import Kernel, Wave
from tests.kernel.motions import SOLVERS, places, speeds, waves_of

AUTOMATIC, EXPLICIT, IMPLICIT = SOLVERS
SCENE = load_scene("seabed-pin-60")


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
@pytest.mark.parametrize("waves", [waves_of(SCENE), {"u_m1": (5e3, 0.0, 0.0)}], ids=["driven", "resting inputs"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_end_stays_on_the_pin_for_a_minute(
    library: ctypes.CDLL, solver: SolverChoice, waves: dict[str, Wave], tolerance: float
) -> None:
    """Within 1e-8 m, from the angles, and 1e-8 m/s, through jerks of 20 kN or under a force that rests.

    With resting inputs the implicit states come of dense output, which knows nothing of the pin by itself.
    """
    cable = SCENE.cable
    kernel, pin = Kernel(library, cable), np.array(cable.rest_position)
    kernel.start(0.0, cable.position, cable.velocity, tolerance=tolerance, solver=solver)
    assert np.linalg.norm(places(cable, cable.position)[-1] - pin) < 1e-8
    moved = 0.0
    for k in range(600):
        run = kernel.advance(0.1 * (k + 1), waves)
        assert run.status == "ok"
        assert np.linalg.norm(places(cable, run.q)[-1] - pin) < 1e-8
        assert speeds(cable, run.q, run.v)[-1] < 1e-8
        moved = max(moved, abs(run.q[0]))
    assert moved > 0.5  # the floater, meanwhile


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_holds_the_end_does_not_change_the_order(library: ctypes.CDLL, solver: SolverChoice) -> None:
    """Back onto the pin after every step, by less than the step's error: within 1e-7 m of DOP853 on the reference."""
    cable, times = SCENE.cable, np.linspace(0.0, 3.0, 7)
    constant, amplitude, pulsation, _ = waves_of(SCENE)["u_m1"]
    expected = integrate(
        cable, lambda t: {"u_m1": constant + amplitude * np.sin(pulsation * t)}, times, rtol=1e-9, atol=1e-10
    )
    runs = Kernel(library, cable).run(times, tolerance=1e-9, waves=waves_of(SCENE), solver=solver)
    for run, q in zip(runs, expected.q[1:], strict=True):
        assert np.abs(places(cable, run.q) - places(cable, q)).max() < 1e-7
