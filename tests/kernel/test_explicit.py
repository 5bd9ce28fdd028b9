"""The explicit solver against another integrator on other equations; its promises about steps and work."""

from __future__ import annotations

import ctypes
import time
from dataclasses import replace

import mpmath
import numpy as np
import pytest

import cablefmu
from cablefmu.cable import Cable, Floats, Terminal
from cablefmu.reference import integrate
from tests.kernel.library import Kernel, Run, Status, Wave
from tests.random_cables import random_cable


def fall(*, water: bool = True) -> Cable:
    """Twelve links fall from 45 degrees."""
    return cablefmu.load_scene("free-12-water" if water else "free-12-air").cable


def state(run: Run) -> Floats:
    return np.concatenate([run.q, run.v])


def rod(**parameters: float) -> Cable:
    """One link on a floater, equipped for trouble."""
    cable = random_cable(np.random.default_rng(1), 1, Terminal.LOAD, water=False, uneven=False)
    return replace(cable, parameters=cable.parameters | parameters)


# ------------------------------------------------------------------------------------------------ accuracy


@pytest.mark.parametrize("water", [False, True])
def test_motion_is_that_of_another_integrator_on_the_dense_equation(library: ctypes.CDLL, water: bool) -> None:
    """DOP853 of scipy on the reference, 5 s of fall under a heaving force."""
    amplitude, pulsation = 25e3, 0.5 * np.pi
    times = np.arange(0.0, 5.1, 0.5)
    expected = integrate(fall(water=water), lambda t: {"u_m1": amplitude * np.sin(pulsation * t)}, times)
    wave = (0.0, amplitude, pulsation)
    runs = Kernel(library, fall(water=water)).run(times, tolerance=1e-10, waves={"u_m1": wave})
    assert [run.time for run in runs] == times[1:].tolist()
    # twenty times the tolerance: local errors of some fifty steps, of rates up to 1 rad/s
    assert np.array([run.q for run in runs]) == pytest.approx(expected.q[1:], rel=0, abs=2e-9)
    assert np.array([run.v for run in runs]) == pytest.approx(expected.v[1:], rel=0, abs=2e-9)


def test_inputs_that_jump_between_communication_steps(library: ctypes.CDLL) -> None:
    """The slope kept from the last step belongs to the inputs before the jump and must not be used."""
    forces = [0.0, 20e3, -20e3]
    expected = integrate(
        fall(), lambda t: {"u_m1": forces[min(int(t), 2)]}, [0.0, 1.0, 2.0, 3.0], rtol=1e-11, atol=1e-13
    )
    kernel = Kernel(library, fall())
    kernel.start(0.0, kernel.cable.position, kernel.cable.velocity, tolerance=1e-10)
    runs = [kernel.advance(k + 1.0, {"u_m1": (force, 0.0, 0.0)}) for k, force in enumerate(forces)]
    assert np.array([run.q for run in runs]) == pytest.approx(expected.q[1:], rel=0, abs=2e-9)
    assert np.array([run.v for run in runs]) == pytest.approx(expected.v[1:], rel=0, abs=2e-9)


def test_fixed_steps_converge_with_order_five(library: ctypes.CDLL) -> None:
    """A tolerance of 1e9 accepts every step, so that the steps are the communication steps.

    In air: drag is |v| v, whose second derivative jumps where a link's velocity changes sign.
    """
    kernel = Kernel(library, fall(water=False))
    exact = state(kernel.run(np.array([0.0, 2.0]), tolerance=1e-13)[-1])
    errors = []
    for steps in (40, 80, 160):
        last = kernel.run(np.linspace(0.0, 2.0, steps + 1), tolerance=1e9)[-1]
        assert (last.counters["steps"], last.counters["rejected"]) == (steps, 0)
        errors.append(np.abs(state(last) - exact).max())
    orders = -np.diff(np.log2(errors))
    assert orders == pytest.approx([5.0, 5.0], abs=0.4)


def test_error_is_in_proportion_to_the_tolerance(library: ctypes.CDLL) -> None:
    """Measured over 10 s: 1.3 to 4.1 times the tolerance."""
    kernel, span = Kernel(library, fall()), np.array([0.0, 10.0])
    exact = state(kernel.run(span, tolerance=1e-13)[-1])
    tolerances = 10.0 ** -np.arange(5, 11)
    errors = [np.abs(state(kernel.run(span, tolerance=t)[-1]) - exact).max() for t in tolerances.tolist()]
    ratio = errors / tolerances
    assert ratio.min() > 0.3 and ratio.max() < 10.0


@pytest.mark.parametrize("step", [1.0, 0.1, 0.03])
def test_communication_steps_change_no_more_than_the_tolerance(library: ctypes.CDLL, step: float) -> None:
    kernel, tolerance = Kernel(library, fall()), 1e-7
    times = np.append(np.arange(0.0, 9.99, step), 10.0)
    one, many = (kernel.run(grid, tolerance=tolerance)[-1] for grid in (times[[0, -1]], times))
    assert np.abs(state(one) - state(many)).max() < 10 * tolerance
    assert not np.array_equal(state(one), state(many))


# ---------------------------------------------------------------------------------------------- bookkeeping


def test_every_step_ends_on_its_time_to_the_last_bit(library: ctypes.CDLL) -> None:
    """Start + k h, with h = 0.1 that no double is; far from zero; across it, where t + (end - t) != end."""
    grids = [np.linspace(0.0, 5.0, 51), np.array([1e6 + 0.1 * k for k in range(51)])]
    grids += [np.array([-1.0, 1e-3 / k]) for k in range(3, 23)]
    kernel = Kernel(library, fall())
    for times in grids:
        assert [run.time for run in kernel.run(times, tolerance=1e-6)] == times[1:].tolist()


def test_time_of_the_start_does_not_matter(library: ctypes.CDLL) -> None:
    """Nothing but the inputs depends on it, and 1024 s plus quarter seconds are exact."""
    times = np.arange(0.0, 3.1, 0.25)
    kernel = Kernel(library, fall())
    early, late = (kernel.run(times + start, tolerance=1e-8)[-1] for start in (0.0, 1024.0))
    # a step's length is rounded to the spacing of doubles at 1024 s, 2e-13 s
    assert state(late) == pytest.approx(state(early), rel=0, abs=1e-10)


def test_step_size_is_kept_across_communication_points(library: ctypes.CDLL) -> None:
    """Where steps are shorter than communication steps, those cost less than twice the evaluations."""
    kernel = Kernel(library, cablefmu.load_scene("free-60-water").cable)
    grids = np.array([0.0, 2.0]), np.linspace(0.0, 2.0, 21)
    one, many = (kernel.run(grid, tolerance=1e-8)[-1] for grid in grids)
    assert one.counters["steps"] > 40  # shorter than 0.05 s, the half of a communication step
    assert many.counters["rhs"] < 2 * one.counters["rhs"]


def test_a_short_communication_step_does_not_shrink_the_next(library: ctypes.CDLL) -> None:
    """After one of 1 us the solver goes on with the step it had."""
    kernel = Kernel(library, fall())
    plain = kernel.run(np.array([0.0, 5.0, 10.0]), tolerance=1e-6)[-1]
    disturbed = kernel.run(np.array([0.0, 5.0, 5.000001, 10.0]), tolerance=1e-6)[-1]
    assert disturbed.counters["steps"] <= plain.counters["steps"] + 3


def test_evaluations_are_counted(library: ctypes.CDLL) -> None:
    """Six an attempt, the seventh being the next step's first; two more at the start."""
    wave = {"u_m1": (0.0, 1e3, 2.0)}
    counters = Kernel(library, fall()).run(np.linspace(0.0, 10.0, 11), tolerance=1e-6, waves=wave)[-1].counters
    assert counters["rejected"] > 0
    assert counters["rhs"] == 6 * (counters["steps"] + counters["rejected"]) + 2


def test_same_run_same_bits(library: ctypes.CDLL) -> None:
    """On the same kernel after another run, and on a fresh one."""
    times = np.linspace(0.0, 5.0, 51)
    kernel = Kernel(library, fall())
    first = kernel.run(times, tolerance=1e-6)[-1]
    kernel.run(times, tolerance=1e-3)
    for again in (kernel, Kernel(library, fall())):
        assert state(again.run(times, tolerance=1e-6)[-1]).tobytes() == state(first).tobytes()


def test_equilibrium_is_kept_and_costs_little(library: ctypes.CDLL) -> None:
    """Hanging at rest for an hour: steps grow until stability limits them, and rounding stays within the tolerance."""
    still = np.zeros(13)
    cable = replace(fall(), position=still, velocity=still)
    run = Kernel(library, cable).run(np.array([0.0, 3600.0]), tolerance=1e-6)[-1]
    assert run.status == "ok" and np.max(np.abs(state(run))) < 1e-5  # m, rad, m/s, rad/s; ten times the tolerance
    assert run.counters["steps"] < 1000


# -------------------------------------------------------------------------------------------- bounded work


def refused(library: ctypes.CDLL, cable: Cable, times: list[float], **waves: Wave) -> Status:
    """How a run ends that must not end well, and quickly: within 20 s here, where 3 are needed."""
    began = time.monotonic()
    runs = Kernel(library, cable).run(np.array(times), tolerance=1e-6, waves=waves)
    assert time.monotonic() - began < 20.0
    assert times[0] <= runs[-1].time < times[-1]
    assert np.all(np.isfinite(state(runs[-1])))
    return runs[-1].status


def test_far_too_stiff_is_given_up(library: ctypes.CDLL) -> None:
    """A joint of 1e16 N m/rad on one rod turns at some 1e6 rad/s: a million attempts are not 10 s."""
    assert refused(library, rod(k_joint=1e16), [0.0, 10.0]) == "too many steps"


def test_steps_below_the_resolution_of_time_are_refused(library: ctypes.CDLL) -> None:
    """The same at t = 1e12 s, where doubles are 1e-4 s apart."""
    assert refused(library, rod(k_joint=1e16), [1e12, 1e12 + 10.0]) == "step too small"


def test_a_violent_state_is_followed_as_long_as_steps_are_steps(library: ctypes.CDLL) -> None:
    """A rod at 1e8 rad/s pulls the floater with 1e16 m/s^2: too much work, not too small a step."""
    cable = replace(rod(), velocity=np.array([0.0, 1e8]))
    assert Kernel(library, cable).run(np.array([0.0, 1e-6]), tolerance=1e-6)[-1].status == "ok"
    assert refused(library, cable, [0.0, 1.0]) == "too many steps"


def test_a_state_beyond_numbers_is_refused(library: ctypes.CDLL) -> None:
    """1e155 rad/s squared is infinite; no NaN comes out."""
    cable = replace(rod(), velocity=np.array([0.0, 1e155]))
    assert refused(library, cable, [0.0, 1.0]) == "step too small"


def test_wound_up_beyond_the_sine_is_refused(library: ctypes.CDLL) -> None:
    cable = replace(
        rod(c_joint=0.0, k_joint=0.0), position=np.array([0.0, 1.6e6 - 10.0]), velocity=np.array([0.0, 100.0])
    )
    assert refused(library, cable, [0.0, 10.0]) == "angle too large"


def test_inputs_that_are_not_finite_are_refused(library: ctypes.CDLL) -> None:
    assert refused(library, fall(), [0.0, 1.0], u_m1=(np.nan, 0.0, 0.0)) == "input failed"
    assert refused(library, fall(), [0.0, 1.0], u_m1=(np.inf, 0.0, 0.0)) == "input failed"


# ---------------------------------------------------------------------------------------------- fifth root


def test_fifth_root(library: ctypes.CDLL) -> None:
    """Within 2 units in the last place over all the range that doubles have (measured: 1.8)."""
    powers = np.arange(1.0, 30.0) ** 5
    random = 10.0 ** np.random.default_rng(1).uniform(-300, 300, 3000)
    x = np.concatenate([random, 2.0 ** np.arange(-999, 999), powers])
    with mpmath.workdps(40):
        for value in x.tolist():
            exact = mpmath.mpf(value) ** (mpmath.mpf(1) / 5)
            assert abs(library.fifth_root(value) - exact) <= 2 * np.spacing(float(exact)), value


def test_fifth_root_grows(library: ctypes.CDLL) -> None:
    """Never backwards by more than a rounding from one double to the next, at powers of two most of all."""
    for start in 2.0 ** np.arange(-60.0, 60.0, 3.0):
        x = np.nextafter(start, 0.0) + np.spacing(start) * np.arange(50)
        roots = np.array([library.fifth_root(value) for value in x.tolist()])
        assert np.diff(roots).min() >= -np.spacing(roots[0])
