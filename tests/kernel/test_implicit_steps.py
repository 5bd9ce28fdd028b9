"""The implicit solver's bookkeeping: steps, their memory, rejections, restarts, and how it gives up."""

from __future__ import annotations

import ctypes
import time
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Floats, SolverChoice, Terminal
from cablefmu.scene import load_scene
from tests.kernel.library import Kernel, Run, Status, Wave
from tests.kernel.motions import SOLVERS, make_scene, state, waves_of
from tests.random_cables import KINDS, random_cable

AUTOMATIC, EXPLICIT, IMPLICIT = SOLVERS
PULL: dict[str, Wave] = {"F_cx": (200.0, 0.0, 0.0)}
PUSH: dict[str, Wave] = {"F_cx": (-400.0, 0.0, 0.0)}


def fall() -> Cable:
    """Twelve links fall from 45 degrees."""
    return load_scene("free-12-water").cable


def stiff() -> Cable:
    """Sixty links of EI = 1e6 N m^2 that hang at rest."""
    return make_scene(Terminal.LOAD, 60, bending=1e6, angle=0.0).cable


def rod(**parameters: float) -> Cable:
    """One link on a floater, equipped for trouble."""
    cable = random_cable(np.random.default_rng(1), 1, Terminal.LOAD, water=False, uneven=False)
    return replace(cable, parameters=cable.parameters | parameters)


# --------------------------------------------------------------------------------------- steps and their memory


def test_every_step_ends_on_its_time_to_the_last_bit(library: ctypes.CDLL) -> None:
    """Inside steps and at their ends; start + k h, with h = 0.1 that no double is; far from zero; across it."""
    grids = [np.linspace(0.0, 5.0, 51), np.array([1e6 + 0.1 * k for k in range(51)])]
    grids += [np.array([-1.0, 1e-3 / k]) for k in range(3, 23)]
    kernel = Kernel(library, fall())
    for times in grids:
        runs = kernel.run(times, tolerance=1e-6, solver=IMPLICIT)
        assert [run.time for run in runs] == times[1:].tolist()


def test_resting_inputs_cost_no_steps_at_communication_points(library: ctypes.CDLL) -> None:
    """Steps go beyond them: a thousand looks at 10 s take about the steps of one, and a right-hand side each."""
    kernel = Kernel(library, stiff())
    one, many = (
        kernel.run(np.linspace(0.0, 10.0, count + 1), tolerance=1e-4, waves=PULL, solver=IMPLICIT)[-1].counters
        for count in (1, 1000)
    )
    assert many["steps"] < 1.5 * one["steps"]
    assert many["jacobians"] == many["steps"] + many["rejected"]
    assert many["rhs"] < 9.0 * many["steps"] + 1010.0


def test_steps_end_where_inputs_jump(library: ctypes.CDLL) -> None:
    """The rest of a step that went beyond is dropped: as accurate as steps that never went beyond."""
    cable = stiff()

    def pushed(solver: SolverChoice, tolerance: float) -> Floats:
        kernel = Kernel(library, cable)
        kernel.start(0.0, cable.position, cable.velocity, tolerance=tolerance, solver=solver)
        for k in range(100):
            run = kernel.advance(0.1 * (k + 1), PULL if k < 33 or k >= 66 else PUSH)
            assert run.status == "ok" and run.time == 0.1 * (k + 1)
        return run.q

    exact = pushed(EXPLICIT, 1e-10)
    for tolerance in (1e-3, 1e-5, 1e-7):
        assert np.abs(pushed(IMPLICIT, tolerance) - exact).max() < 10.0 * tolerance


def test_a_short_communication_step_does_not_shrink_the_next(library: ctypes.CDLL) -> None:
    """After one of 1 us the solver goes on with the step it had; with inputs that vary, so that steps end there."""
    kernel, waves = Kernel(library, fall()), {"u_m1": (0.0, 1e3, 1.0)}
    plain = kernel.run(np.array([0.0, 5.0, 10.0]), tolerance=1e-6, waves=waves, solver=IMPLICIT)[-1]
    disturbed = kernel.run(np.array([0.0, 5.0, 5.000001, 10.0]), tolerance=1e-6, waves=waves, solver=IMPLICIT)[-1]
    assert disturbed.counters["steps"] <= plain.counters["steps"] + 3


def test_evaluations_are_counted(library: ctypes.CDLL) -> None:
    """Eight a step, seven an attempt that is refused; the first step's guess costs one, the end's point one more."""
    wave = {"u_m1": (0.0, 25e3, 2.0)}
    counters = Kernel(library, fall()).run(np.linspace(0.0, 10.0, 11), tolerance=1e-6, waves=wave, solver=IMPLICIT)[-1]
    count = counters.counters
    assert count["rejected"] > 0
    assert count["jacobians"] == count["steps"] + count["rejected"]
    assert count["rhs"] == 8 * count["steps"] + 7 * count["rejected"] + 2
    assert count["stiff"] == 1.0


# ---------------------------------------------------------------------------------------------------- rejections


def test_refused_steps_leave_no_trace(library: ctypes.CDLL) -> None:
    """Jerks of a slack cable refuse steps by the dozen; the motion is the explicit one's all the same."""
    scene = load_scene("seabed-spring-60")
    kernel, times = Kernel(library, scene.cable), np.linspace(0.0, 10.0, 101)
    run = kernel.run(times, tolerance=1e-7, waves=waves_of(scene), solver=IMPLICIT)[-1]
    other = kernel.run(times, tolerance=1e-11, waves=waves_of(scene))[-1]
    assert run.counters["rejected"] > 10
    assert np.abs(run.q - other.q).max() < 1e-5


def test_a_stage_beyond_numbers_leads_to_a_shorter_step(library: ctypes.CDLL) -> None:
    """A rod at 1e150 rad/s: in steps of 1e-140 s a stage's speed squared overflows, in the first ones it does not.

    Every step that gives numbers passes at a tolerance of 1e9, so that what is refused here gave none.
    """
    kernel = Kernel(library, replace(rod(), velocity=np.array([0.0, 1e150])))
    _, _, error = kernel.implicit_steps(1e-140, 1, {})
    assert np.isnan(error)
    kernel.start(0.0, kernel.cable.position, kernel.cable.velocity, tolerance=1e9, solver=IMPLICIT)
    run = kernel.advance(1e-140, {})
    assert run.counters["rejected"] > 0 and np.all(np.isfinite(state(run)))


# -------------------------------------------------------------------------------------------- the same bits again


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_restart_forgets_everything(library: ctypes.CDLL, solver: SolverChoice) -> None:
    """Stopped inside a step or in the middle of a trial, then from the start: the same bits as on a new solver."""
    times = np.linspace(0.0, 3.0, 31)
    for cable, waves in ((stiff(), PULL), (fall(), {"u_m1": (0.0, 25e3, 2.0)})):
        fresh = Kernel(library, cable)
        expected = [state(run) for run in fresh.run(times, tolerance=1e-5, waves=waves, solver=solver)]
        for stop in (1.03, 1.9, 2.77):
            kernel = Kernel(library, cable)
            kernel.start(0.0, cable.position, cable.velocity, tolerance=1e-5, solver=solver)
            for end in (0.4, stop):
                kernel.advance(end, {name: (force, 10.0 * wave, 1.0) for name, (force, wave, _) in waves.items()})
            kernel.forget(0.0, cable.position, cable.velocity)
            again = [state(kernel.advance(end, waves)) for end in times[1:].tolist()]
            assert np.array(again).tobytes() == np.array(expected).tobytes()


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_spoilt_scratch_and_other_variant_give_the_same_bits(library: ctypes.CDLL, kind: int) -> None:
    """A whole run of every kind of cable, after NaN in all the scratch, and in plain C instead of AVX2."""
    terminal, water, drag = KINDS[kind]
    cable = random_cable(np.random.default_rng([13, kind]), 13, terminal, water, drag=drag)
    waves = {"u_m1": (0.0, 2e3, 3.0)}

    def ends(solver: SolverChoice, *, spoilt: bool = False, wide: bool = True) -> bytes:
        kernel = Kernel(library, cable)
        kernel.use_avx2(wide)
        if spoilt:
            kernel.spoil_scratch()
            kernel.spoil_solver()
        looks = kernel.run(np.linspace(0.0, 2.0, 21), tolerance=1e-4, waves=waves, solver=solver)
        still = [kernel.advance(2.0 + 0.1 * (k + 1), {}) for k in range(10)]  # then resting inputs: dense output
        assert looks[-1].status == still[-1].status == "ok" and still[-1].time == 3.0
        return np.array([state(run) for run in looks + still]).tobytes()

    for solver in SOLVERS:
        plain = ends(solver)
        assert ends(solver, spoilt=True) == plain
        assert ends(solver, wide=False) == plain


# ---------------------------------------------------------------------------------------------- how it gives up


def refused(library: ctypes.CDLL, cable: Cable, times: list[float], **waves: Wave) -> Status:
    """How an implicit run ends that must not end well: quickly, and with numbers."""
    began = time.monotonic()
    run: Run = Kernel(library, cable).run(np.array(times), tolerance=1e-6, waves=waves, solver=IMPLICIT)[-1]
    assert time.monotonic() - began < 30.0
    assert times[0] <= run.time < times[-1]
    assert np.all(np.isfinite(state(run)))
    return run.status


def test_what_is_too_stiff_for_explicit_steps_is_not_for_these(library: ctypes.CDLL) -> None:
    """A joint of 1e16 N m/rad that starts at rest: the explicit solver gives up after a million attempts."""
    still = np.zeros(2)
    cable = replace(rod(k_joint=1e16), position=still, velocity=still)
    run = Kernel(library, cable).run(
        np.array([0.0, 10.0]), tolerance=1e-6, waves={"F_cx": (1e3, 0.0, 0.0)}, solver=IMPLICIT
    )[-1]
    assert run.status == "ok" and run.counters["steps"] < 1000


def test_too_much_motion_is_given_up(library: ctypes.CDLL) -> None:
    """A rod at 1e8 rad/s must be followed: a million attempts are not 1 s."""
    assert refused(library, replace(rod(), velocity=np.array([0.0, 1e8])), [0.0, 1.0]) == "too many steps"


def test_steps_below_the_resolution_of_time_are_refused(library: ctypes.CDLL) -> None:
    """The same at t = 1e12 s, where doubles are 1e-4 s apart."""
    assert refused(library, replace(rod(), velocity=np.array([0.0, 1e8])), [1e12, 1e12 + 10.0]) == "step too small"


def test_a_state_beyond_numbers_is_refused(library: ctypes.CDLL) -> None:
    """1e155 rad/s squared is infinite; no NaN comes out."""
    assert refused(library, replace(rod(), velocity=np.array([0.0, 1e155])), [0.0, 1.0]) == "step too small"


def test_wound_up_beyond_the_sine_is_refused(library: ctypes.CDLL) -> None:
    cable = replace(
        rod(c_joint=0.0, k_joint=0.0), position=np.array([0.0, 1.6e6 - 10.0]), velocity=np.array([0.0, 100.0])
    )
    assert refused(library, cable, [0.0, 10.0]) == "angle too large"


def test_inputs_that_are_not_finite_are_refused(library: ctypes.CDLL) -> None:
    assert refused(library, fall(), [0.0, 1.0], u_m1=(np.nan, 0.0, 0.0)) == "input failed"
    assert refused(library, fall(), [0.0, 1.0], u_m1=(np.inf, 0.0, 0.0)) == "input failed"
