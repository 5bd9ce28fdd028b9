"""Verdicts: right answers pass, planted wrong ones do not; chaos ends at its horizon, errors need a reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cablefmu.stress_baseline import Measured
from cablefmu.stress_grid import Case
from cablefmu.stress_run import ACCELERATIONS, Answer, Request, answer_to
from cablefmu.stress_verdict import Row, judge
from tests.test_stress_run import case_of

Change = Callable[[Answer], Answer]


def judged(
    case: Case, folder: Path, *, of: str | None = "", change: Change = lambda answer: answer,
    measured: Measured | None = None,
) -> Row:  # fmt: skip
    """Judge a case in this process, the answer of one solver ("": none, None: the run itself) being changed."""
    return judge(case, lambda r, _: change(answer_to(r)) if r.solver == of else answer_to(r), folder, measured)


def shifted(by: float) -> Change:
    """The motion `by` metres farther right from the middle of the run on."""

    def change(answer: Answer) -> Answer:
        points = answer.points.copy()
        points[len(points) // 2 :, 1:, 0] += by
        return replace(answer, points=points)

    return change


def test_a_right_answer_is_within_tolerance_of_three_references(tmp_path: Path) -> None:
    row = judged(case_of("cable.links = 3"), tmp_path)
    assert (row.verdict, row.message, row.references) == ("within tolerance", "", "implicit, explicit, dense")
    assert 0.0 < row.spread < row.error < 240.0 * 1e-6
    assert row.ratio == pytest.approx(row.error / (5.0 * 240.0 * 1e-6 * row.growth), rel=0.5)
    assert (row.n, row.tolerance, row.horizon, row.stop_time) == (3, 1e-6, 1.0, 1.0)
    assert 0.0 < row.energy < 0.5 and 0.0 < row.accelerations < 1e-3 and np.isnan(row.worse)
    assert list(tmp_path.iterdir()) == [], "its FMU is gone"


def test_what_was_once_measured_must_not_be_exceeded_by_much(tmp_path: Path) -> None:
    case = case_of("cable.links = 3")
    row = judged(case, tmp_path)
    again = judged(case, tmp_path, measured=Measured(row.ratio, row.energy, 50))
    assert (again.verdict, again.worse) == ("within tolerance", pytest.approx(1.0, rel=0.1))
    worse = judged(case, tmp_path, measured=Measured(row.ratio / 20.0, row.energy, 50))
    assert (worse.verdict, worse.passed, worse.worse) == ("worse", False, pytest.approx(20.0, rel=0.1))
    assert worse.message.startswith("20 times what was once measured: of the allowed error 0.00")
    energy = judged(case, tmp_path, measured=Measured(row.ratio, row.energy / 20.0, 50))
    assert (energy.verdict, energy.worse) == ("worse", pytest.approx(20.0, rel=0.1))


def test_steps_once_measured_must_not_be_exceeded_by_much(tmp_path: Path) -> None:
    def change(answer: Answer) -> Answer:
        return replace(answer, figures={**answer.figures, "steps": 2e4})

    case, measured = case_of("cable.links = 3"), Measured(1.0, 1.0, 5000)
    row = judged(case, tmp_path, of=None, change=change, measured=measured)
    assert (row.verdict, row.passed, row.longer) == ("worse", False, 4.0)
    assert row.message == "20,000 steps, 4 times what was once measured"
    assert judged(case, tmp_path, measured=measured).verdict == "within tolerance"


def test_what_references_cannot_tell_apart_is_not_worse(tmp_path: Path) -> None:
    """Once measured as nothing at all: there are still the references' own errors and rounding."""
    case = case_of("cable.links = 3, run.tolerance = 1e-11")  # references are at 1e-12, and no better than the run
    row = judged(case, tmp_path, measured=Measured(0.0, 1.0, 10_000))
    assert (row.verdict, row.message) == ("within tolerance", "")


def test_an_energy_balance_that_is_off_is_wrong(tmp_path: Path) -> None:
    def change(answer: Answer) -> Answer:
        return replace(answer, figures={**answer.figures, "energy_residual": 0.05 * 60.0 * 9.81 * 240.0})

    row = judged(case_of("cable.links = 3"), tmp_path, of=None, change=change)
    assert row.verdict == "wrong" and row.energy > 1.0
    assert row.message.startswith("the energy balance is off by ")


@pytest.mark.parametrize("share", [1.5, np.inf, np.nan])
def test_accelerations_that_are_not_the_dense_equations_are_wrong(share: float, tmp_path: Path) -> None:
    def change(answer: Answer) -> Answer:
        return replace(answer, figures={"accelerations": share})

    row = judged(case_of("cable.links = 3"), tmp_path, of=ACCELERATIONS, change=change)
    assert row.verdict == "wrong"
    assert row.message.startswith("accelerations differ from those of the dense equation, ")


@pytest.mark.parametrize("solver", ["explicit", "implicit", "DOP853", ACCELERATIONS])
def test_a_crash_beside_the_run_is_one_as_well(solver: str, tmp_path: Path) -> None:
    row = judged(case_of("cable.links = 3"), tmp_path, of=solver, change=lambda _: Answer("crash", "the worker died"))
    assert (row.verdict, row.message) == ("crash", f"the run for {solver}: the worker died")


@pytest.mark.parametrize("solver", [None, "explicit", "implicit", "DOP853"])
def test_a_planted_wrong_answer_is_found_wherever_it_is(solver: str | None, tmp_path: Path) -> None:
    row = judged(case_of("cable.links = 3"), tmp_path, of=solver, change=shifted(5e-3))
    assert row.verdict == "wrong" and not row.passed
    assert row.message.startswith("0.005 m from a reference")


def test_a_single_joint_that_is_wrong_is_found(tmp_path: Path) -> None:
    def change(answer: Answer) -> Answer:
        points = answer.points.copy()
        points[3, 2] += 5e-3
        return replace(answer, points=points)

    assert judged(case_of("cable.links = 3"), tmp_path, of=None, change=change).verdict == "wrong"


def test_what_is_not_a_number_is_wrong(tmp_path: Path) -> None:
    row = judged(case_of("cable.links = 3"), tmp_path, of=None, change=shifted(np.nan))
    assert (row.verdict, row.error) == ("wrong", np.inf)


def test_a_reference_that_remains_alone_is_run_once_more_at_a_tenth(tmp_path: Path) -> None:
    def ask(request: Request, limit: float) -> Answer:
        return answer_to(request) if request.solver in (None, "implicit", ACCELERATIONS) else Answer("hang")

    row = judge(case_of("cable.links = 3"), ask, tmp_path)
    assert (row.verdict, row.references) == ("within tolerance", "implicit, implicit at a tenth")


def test_without_two_references_nothing_is_within_tolerance(tmp_path: Path) -> None:
    def ask(request: Request, limit: float) -> Answer:
        return answer_to(request) if request.solver is None else Answer("hang")

    row = judge(case_of("cable.links = 3"), ask, tmp_path)
    assert (row.verdict, row.message) == ("wrong", "there are no two references to judge by")


@pytest.mark.parametrize("outcome", ["hang", "crash"])
def test_a_hang_and_a_crash_are_failures(outcome: str, tmp_path: Path) -> None:
    row = judge(case_of("cable.links = 3"), lambda *_: Answer(outcome, "why"), tmp_path)
    assert (row.verdict, row.message, row.passed) == (outcome, "why", False)


def test_an_error_needs_a_reason_and_a_reason_an_error(tmp_path: Path) -> None:
    too_far = 'terminal = { kind = "pin", position = [200, 200] }, shape = { kind = "catenary" }'
    assert judged(case_of(too_far), tmp_path).verdict == "wrong"
    assert judged(case_of(f'{too_far}, fails = "too far"'), tmp_path).verdict == "clean error"
    fine = judged(case_of('cable.links = 3, fails = "too far"'), tmp_path)
    assert (fine.verdict, fine.message) == ("wrong", "this should have ended in an error: too far")


def test_chaos_is_compared_up_to_its_horizon_and_a_mistake_before_it_is_found(tmp_path: Path) -> None:
    # a chain upside down falls where the smallest error pushes it
    case = case_of('cable.links = 4, cable.joint_stiffness = 0, shape.angle = "180 deg", run.stop_time = "20 s"')
    row = judged(case, tmp_path)
    assert row.verdict == "within tolerance"
    assert 1.0 < row.horizon < 15.0 and row.growth > 10.0

    def early(answer: Answer) -> Answer:
        points = answer.points.copy()
        points[1:4] += 5e-3
        return replace(answer, points=points)

    def late(answer: Answer) -> Answer:
        points = answer.points.copy()
        points[answer.times > row.horizon + 0.05] += 100.0
        return replace(answer, points=points)

    assert judged(case, tmp_path, of=None, change=early).verdict == "wrong"
    assert judged(case, tmp_path, of=None, change=late).verdict == "within tolerance"


def test_too_few_times_before_the_horizon_are_no_comparison(tmp_path: Path) -> None:
    upside_down = 'cable.links = 4, cable.joint_stiffness = 0, shape.angle = "180 deg"'
    row = judged(case_of(f'{upside_down}, run.stop_time = "60 s", run.step = "10 s"'), tmp_path)
    assert (row.verdict, row.message) == ("wrong", "too chaotic for its output times: nothing to compare")
