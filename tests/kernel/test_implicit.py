"""The implicit solver: accuracy against other integrators, orders, tolerances, and communication steps of any size."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest

from cablefmu.cable import Cable, Floats, SolverChoice, Terminal
from cablefmu.reference import integrate
from cablefmu.scene import load_scene, shipped_scenes
from tests.kernel.library import Kernel, Run, Wave
from tests.kernel.motions import SOLVERS, make_scene, places, state, waves_of

AUTOMATIC, EXPLICIT, IMPLICIT = SOLVERS
HEAVE: dict[str, Wave] = {"u_m1": (1e3, 25e3, np.pi)}


def fall(*, water: bool = True) -> Cable:
    """Twelve links fall from 45 degrees."""
    return load_scene("free-12-water" if water else "free-12-air").cable


def stiff() -> tuple[Cable, dict[str, Wave]]:
    """Sixty links of EI = 1e6 N m^2, pulled sideways from rest by 200 N: joints vibrate at 160 rad/s."""
    return make_scene(Terminal.LOAD, 60, bending=1e6, angle=0.0).cable, {"F_cx": (200.0, 0.0, 0.0)}


def distance(cable: Cable, one: Floats, other: Floats) -> float:
    """Largest of any joint between two q [m]."""
    return float(np.linalg.norm(places(cable, one) - places(cable, other), axis=1).max())


# ------------------------------------------------------------------------------------------------ accuracy


@pytest.mark.parametrize("water", [False, True])
def test_motion_is_that_of_another_integrator_on_the_dense_equation(library: ctypes.CDLL, water: bool) -> None:
    """DOP853 of scipy on the reference, 5 s of fall under a heaving force."""
    times = np.arange(0.0, 5.1, 0.5)
    constant, amplitude, pulsation = HEAVE["u_m1"]
    expected = integrate(fall(water=water), lambda t: {"u_m1": constant + amplitude * np.sin(pulsation * t)}, times)
    runs = Kernel(library, fall(water=water)).run(times, tolerance=1e-10, waves=HEAVE, solver=IMPLICIT)
    assert [run.time for run in runs] == times[1:].tolist()
    # twenty times the tolerance: local errors of some hundred steps, of rates up to 1 rad/s
    assert np.array([run.q for run in runs]) == pytest.approx(expected.q[1:], rel=0, abs=2e-9)
    assert np.array([run.v for run in runs]) == pytest.approx(expected.v[1:], rel=0, abs=2e-9)


@pytest.mark.parametrize("name", shipped_scenes())
def test_explicit_and_implicit_agree(library: ctypes.CDLL, name: str) -> None:
    """Every joint within 1e-8 m at any time, at a tolerance of 1e-11 (measured: 9e-10 m at worst, free-12-air).

    Two methods that share the right-hand side alone; load-lift-80 as far as any two runs of it agree. With 8e8 kg at
    the end, the implicit method's error estimate meets rounding below 1e-9 and steps become many: 1e-10.
    """
    scene = load_scene(name)
    tolerance = 1e-10 if scene.cable.terminal is Terminal.ANCHOR_MASS else 1e-11
    span = 0.7 if name == "load-lift-80" else min(scene.stop_time, 10.0)
    times = np.linspace(0.0, span, 21)
    kernel = Kernel(library, scene.cable)
    one, other = (kernel.run(times, tolerance=tolerance, waves=waves_of(scene), solver=s) for s in (EXPLICIT, IMPLICIT))
    assert other[-1].counters["jacobians"] > 0 == one[-1].counters["jacobians"]
    assert max(distance(scene.cable, a.q, b.q) for a, b in zip(one, other, strict=True)) < 1e-8


# -------------------------------------------------------------------------------------------------- orders


def orders(error: Callable[[int], float], steps: list[int]) -> Floats:
    """What each doubling of the number of steps shows."""
    return -np.diff(np.log2([error(number) for number in steps]))


def test_fixed_steps_converge_with_order_five(library: ctypes.CDLL) -> None:
    """A tolerance of 1e9 accepts every step, so that steps are the communication steps, under a force that varies.

    In air, as drag is |v| v, whose second derivative jumps where a link's velocity changes sign. Measured: 4.6, 4.6.
    """
    kernel = Kernel(library, fall(water=False))
    exact = state(kernel.run(np.array([0.0, 2.0]), tolerance=1e-13, waves=HEAVE)[-1])

    def error(steps: int) -> float:
        run = kernel.run(np.linspace(0.0, 2.0, steps + 1), tolerance=1e9, waves=HEAVE, solver=IMPLICIT)[-1]
        assert (run.counters["steps"], run.counters["rejected"]) == (steps, 0)
        return float(np.abs(state(run) - exact).max())

    assert orders(error, [80, 160, 320]) == pytest.approx([5.0, 5.0], abs=0.5)


@pytest.mark.parametrize(("still", "order"), [(False, 5.0), (True, 2.0)])
def test_the_order_needs_the_slopes_of_the_inputs(library: ctypes.CDLL, still: bool, order: float) -> None:
    """The same steps one by one; where forces look constant as their slopes are measured, order two is left of five."""
    kernel = Kernel(library, fall(water=False))
    exact = state(kernel.run(np.array([0.0, 2.0]), tolerance=1e-13, waves=HEAVE)[-1])

    def error(steps: int) -> float:
        end, _, _ = kernel.implicit_steps(2.0 / steps, steps, HEAVE, still=still)
        return float(np.abs(end - exact).max())

    assert orders(error, [80, 160, 320]) == pytest.approx([order, order], abs=0.5)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_between_the_ends_of_a_step_the_order_is_four(library: ctypes.CDLL, share: float) -> None:
    """One step of h, and the state inside it by dense output: an error of h^5 at least (measured: 5.0 to 5.7)."""
    kernel = Kernel(library, fall(water=False))

    def error(steps: int) -> float:
        h = 0.1 / steps
        _, between, _ = kernel.implicit_steps(h, 1, HEAVE, share=share)
        exact = state(kernel.run(np.array([0.0, share * h]), tolerance=1e-14, waves=HEAVE)[-1])
        return float(np.abs(between - exact).max())

    found = orders(error, [1, 2, 4, 8])
    assert found.min() > 4.7 and found.max() < 6.0


def test_the_error_estimate_falls_as_its_order_says(library: ctypes.CDLL) -> None:
    """As h^5 at least (measured: 5.4 to 5.7), and it is larger than the error of the step itself."""
    kernel = Kernel(library, fall(water=False))
    assert orders(lambda steps: kernel.implicit_steps(1.0 / steps, steps, HEAVE)[2], [10, 20, 40, 80]).min() > 4.7
    end, _, estimate = kernel.implicit_steps(0.1, 1, HEAVE)
    exact = state(kernel.run(np.array([0.0, 0.1]), tolerance=1e-13, waves=HEAVE)[-1])
    assert np.max(np.abs(end - exact) / (1.0 + np.abs(exact))) < estimate


# ------------------------------------------------------------------------------------ tolerance and its meaning


@pytest.mark.parametrize("waves", [{}, HEAVE], ids=["free", "driven"])
def test_error_is_in_proportion_to_the_tolerance(library: ctypes.CDLL, waves: dict[str, Wave]) -> None:
    """Over 10 s and eight orders of magnitude; measured: 0.2 to 1.0 times the tolerance, driven 0.25 to 2.6."""
    kernel, span = Kernel(library, fall()), np.array([0.0, 10.0])
    exact = state(kernel.run(span, tolerance=1e-13, waves=waves, solver=IMPLICIT)[-1])
    tolerances = 10.0 ** -np.arange(3, 11)
    runs = [kernel.run(span, tolerance=t, waves=waves, solver=IMPLICIT)[-1] for t in tolerances.tolist()]
    ratio = np.array([np.abs(state(run) - exact).max() for run in runs]) / tolerances
    assert ratio.min() > 0.05 and ratio.max() < 5.0


def test_a_stiff_cable_stays_within_the_tolerance(library: ctypes.CDLL) -> None:
    """Explicit steps are 5 ms; at loose tolerances those here get a hundred times longer. Measured: 0.02 to 18."""
    cable, pull = stiff()
    kernel, span = Kernel(library, cable), np.array([0.0, 10.0])
    exact = state(kernel.run(span, tolerance=1e-11, waves=pull, solver=IMPLICIT)[-1])
    for tolerance in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        run = kernel.run(span, tolerance=tolerance, waves=pull, solver=IMPLICIT)[-1]
        assert np.abs(state(run) - exact).max() < 30.0 * tolerance
        if tolerance == 1e-3:
            assert run.counters["steps"] < 100 and run.counters["step_size"] > 0.3


# -------------------------------------------------------------------------------------- communication steps


def splits() -> dict[str, Floats]:
    """Ways from 0 to 10 s."""
    scattered = np.sort(np.random.default_rng(3).uniform(0.0, 10.0, 150))
    steps = {f"{step:g} s": np.append(np.arange(0.0, 9.9999 - step / 2, step), 10.0) for step in (3.0, 1.0, 0.1, 0.03)}
    return steps | {"1 ms": np.linspace(0.0, 10.0, 10_001), "scattered": np.concatenate([[0.0], scattered, [10.0]])}


@pytest.mark.parametrize("split", splits())
@pytest.mark.parametrize("solver", [IMPLICIT, AUTOMATIC])
@pytest.mark.parametrize("case", ["resting", "driven", "stiff"])
def test_communication_steps_change_no_more_than_the_tolerance(
    library: ctypes.CDLL, case: str, solver: SolverChoice, split: str
) -> None:
    """Resting inputs come of dense output, others of shorter steps. Measured: 6 times the tolerance at worst.

    But the stiff cable's rates, of vibrations that the explicit method leaves at the limit of its stability, are off by
    up to 100 times; there the joints' places are compared, in metres.
    """
    tolerance = 1e-5
    cable, waves = stiff() if case == "stiff" else (fall(), HEAVE if case == "driven" else {})
    kernel = Kernel(library, cable)
    one: Run = kernel.run(np.array([0.0, 10.0]), tolerance=tolerance, waves=waves, solver=solver)[-1]
    many = kernel.run(splits()[split], tolerance=tolerance, waves=waves, solver=solver)[-1]
    assert one.status == many.status == "ok" and one.time == many.time == 10.0
    if case != "stiff":
        assert np.abs(state(one) - state(many)).max() < 10 * tolerance
    assert distance(cable, one.q, many.q) < 100.0 * tolerance  # angles over up to 240 m
    assert not np.array_equal(state(one), state(many))


def test_states_inside_a_step_are_the_motion_s_own(library: ctypes.CDLL) -> None:
    """Every hundredth of a second of a run that takes a tenth as many steps, against one at a tolerance of 1e-12."""
    cable, pull = stiff()
    kernel, times = Kernel(library, cable), np.linspace(0.0, 10.0, 1001)
    looks = kernel.run(times, tolerance=1e-4, waves=pull, solver=IMPLICIT)
    exact = kernel.run(times, tolerance=1e-9, waves=pull, solver=IMPLICIT)
    assert looks[-1].counters["steps"] < 200
    assert max(distance(cable, a.q, b.q) for a, b in zip(looks, exact, strict=True)) < 1e-3
    # the velocities are those of the places: a step's inside has no kinks
    drift = [np.abs((b.q - a.q) / 0.02 - m.v).max() for a, m, b in zip(looks, looks[1:], looks[2:], strict=False)]
    assert max(drift) < 1e-2
