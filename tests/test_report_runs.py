"""Runs to be compared: what `apart` measures, and that a course is the run that `simulate` makes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import cablefmu
from cablefmu.cable import Floats, Initial
from cablefmu.errors import RunError
from cablefmu.report_runs import OUTPUTS, Course, TooSlowError, apart, course, fmu_runs, output_times, timed, whole
from cablefmu.scene import Scene
from tests.fmu_helpers import SCENES, from_equilibrium, small_scene


def constant(times: Floats, **off: float) -> Course:
    """A course that stays where it is: 1000 N, and all else 0, but for what is said."""
    values = dict.fromkeys(OUTPUTS, 0.0) | {"tension_top": 1000.0} | off
    return course(times, np.tile([values[name] for name in OUTPUTS], (len(times), 1)), 0.0, rhs=0)


TENTHS = np.arange(11) * 0.1


def test_the_terminal_is_as_far_off_as_both_its_coordinates_say() -> None:
    off = apart(constant(TENTHS, x_c=3.0, y_c=4.0, y_m1=-1.0), constant(TENTHS), 1.0)
    assert off.position == 5.0


def test_a_floater_counts_where_it_is_further_off() -> None:
    assert apart(constant(TENTHS, x_c=1.0, y_m1=-2.0), constant(TENTHS), 1.0).position == 2.0


def test_the_pull_is_off_by_a_share_of_the_largest_of_the_reference() -> None:
    off = apart(constant(TENTHS, tension_top=1010.0, energy=-7.0), constant(TENTHS), 1.0)
    assert (off.tension, off.energy) == (10.0, 7.0)
    assert off.tension_relative == pytest.approx(0.01)


def test_nothing_is_compared_beyond_the_horizon() -> None:
    reference = constant(TENTHS)
    late = constant(TENTHS)
    late.outputs["x_c"][6:] = 1.0
    assert apart(late, reference, 0.5).position == 0.0
    assert apart(late, reference, 0.6).position == 1.0


@pytest.mark.parametrize("step", [0.3, 0.05, 1.0])
def test_courses_with_other_steps_are_compared_where_both_have_a_time(step: float) -> None:
    """x = t exactly: if a time were taken for its neighbour, positions would be off by a tenth."""
    times = np.append(np.arange(0.0, 1.0 - 1e-9, step), 1.0)
    one, other = constant(times), constant(TENTHS)
    one.outputs["x_c"][:], other.outputs["x_c"][:] = times, TENTHS
    assert apart(one, other, 1.0).position < 1e-15


def test_the_start_alone_is_nothing_to_compare() -> None:
    with pytest.raises(RunError, match="a shorter step is needed"):
        apart(constant(TENTHS), constant(TENTHS), 0.05)


def test_a_number_that_is_not_finite_is_no_course() -> None:
    with pytest.raises(RunError, match="not a finite number"):
        constant(TENTHS, energy=float("nan"))


def test_output_times_end_with_the_stop_time() -> None:
    scene = small_scene("load")
    assert output_times(scene).tolist() == [k * 0.1 for k in range(20)] + [2.0]
    assert output_times(scene, 0.3).tolist() == [k * 0.3 for k in range(7)] + [2.0]


# --- through the FMU ---


@pytest.mark.parametrize("solver", ["explicit", "implicit"])
def test_a_course_is_what_simulate_gives(solver: str) -> None:
    scene = small_scene("floater")
    with fmu_runs(scene) as runs:
        found = runs.run(tolerance=1e-7, solver=solver)
    given = cablefmu.simulate(scene, tolerance=1e-7, parameters={"solver": solver})
    for name in OUTPUTS:
        np.testing.assert_array_equal(found.outputs[name], given[name].values)
    assert (found.rhs, found.steps) == (given.attrs["solver_rhs"], given.attrs["solver_steps"])
    assert found.energy_residual == given.attrs["solver_energy_residual"]
    assert found.cpu_time > 0.0


def test_model_exchange_counts_what_cvode_asked_for() -> None:
    scene = small_scene("load")
    with fmu_runs(scene) as runs:
        found = runs.run(tolerance=1e-7, interface="me")
    assert found.rhs == cablefmu.simulate(scene, interface="me", tolerance=1e-7).attrs["solver_rhs"]


def test_a_run_stops_when_its_time_is_up() -> None:
    with fmu_runs(small_scene("load")) as runs, pytest.raises(TooSlowError, match="more than 1e-09 s of CPU time"):
        runs.run(tolerance=1e-6, limit=1e-9)


def test_the_cheapest_of_three_runs_counts() -> None:
    costs = iter([0.3, 0.1, 0.2])
    assert timed(lambda: replace(constant(TENTHS), cpu_time=next(costs))).cpu_time == 0.1


def test_a_run_that_takes_long_is_not_repeated() -> None:
    costs = iter([5.0])
    assert timed(lambda: replace(constant(TENTHS), cpu_time=next(costs))).cpu_time == 5.0


def test_outputs_that_a_scene_drops_are_measured_nevertheless() -> None:
    text = SCENES["load"] + '[outputs]\ndrop = ["x_c", "tension_top", "energy"]\nsolver = false\n'
    with fmu_runs(whole(Scene.from_text(text, name="lean"))) as lean, fmu_runs(small_scene("load")) as full:
        assert apart(lean.run(tolerance=1e-6), full.run(tolerance=1e-6), 2.0).position == 0.0


def test_a_start_from_equilibrium_becomes_a_start_where_that_is() -> None:
    """So that a nudge of the start is not taken back by the search; 1e-9 m is the search's own accuracy."""
    scene = from_equilibrium(small_scene("load"))
    resting = whole(scene)
    assert resting.cable.initial is Initial.SHAPE
    with fmu_runs(resting) as settled, fmu_runs(scene) as searching:
        assert apart(settled.run(tolerance=1e-9), searching.run(tolerance=1e-9), 2.0).position < 1e-9
