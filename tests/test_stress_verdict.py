"""Verdicts: right answers pass, planted wrong ones do not; chaos ends at its horizon, errors need a reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cablefmu.stress_grid import Case
from cablefmu.stress_run import Answer, Request, answer_to
from cablefmu.stress_verdict import Row, judge
from tests.test_stress_run import case_of

Change = Callable[[Answer], Answer]


def judged(case: Case, folder: Path, *, of: str | None = "", change: Change = lambda answer: answer) -> Row:
    """Judge a case in this process, the answer of one solver ("": none, None: the run itself) being changed."""
    return judge(case, lambda r, _: change(answer_to(r)) if r.solver == of else answer_to(r), folder)


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
    assert list(tmp_path.iterdir()) == [], "its FMU is gone"


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
        return answer_to(request) if request.solver in (None, "implicit") else Answer("hang")

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
