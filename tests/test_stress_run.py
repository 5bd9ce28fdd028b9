"""Runs in processes of their own: answers, errors, hangs and crashes, each told from the others."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cablefmu.scene import Scene
from cablefmu.stress_grid import Case, grid_from
from cablefmu.stress_run import Request, Worker, answer_to

GENEROUS = 60.0  # seconds: a machine may be busy


class Sleeping(Case):
    """Its scene is not made within a minute."""

    def scene(self) -> Scene:
        time.sleep(60.0)
        return super().scene()


class Dying(Case):
    """Its process ends, as by a segmentation fault."""

    def scene(self) -> Scene:
        os._exit(3)


class Killed(Case):
    """Its process is killed, as by a system that is out of memory."""

    def scene(self) -> Scene:
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError


class Buggy(Case):
    """Its scene raises what is no message to a user."""

    def scene(self) -> Scene:
        raise ZeroDivisionError


def case_of(changes: str, kind: type[Case] = Case) -> Case:
    stop = "" if "run.stop_time" in changes else 'run.stop_time = "1 s", '
    text = f'[[group]]\nname = "g"\nbase = "free-12-water"\n[group.cases]\na = {{ {stop}{changes} }}'
    (case,) = grid_from(text)
    return kind(**vars(case))


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    worker = Worker()
    yield worker
    worker.close()


@pytest.fixture
def fmu(tmp_path: Path) -> Path:
    return tmp_path / "case.fmu"


def test_a_run_gives_the_joints_over_time(worker: Worker, fmu: Path) -> None:
    answer = worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS)
    assert (answer.outcome, answer.message) == ("ended", "")
    assert answer.points.shape == (11, 5, 2)
    assert dict(answer.facts) == {"n": 4, "length": 240.0, "stop_time": 1.0, "step": 0.1, "tolerance": 1e-6}
    assert answer.figures["steps"] > 5 and answer.figures["implicit"] in (0.0, 1.0)
    # straight at 45 degrees at first, rigid links ever after
    np.testing.assert_allclose(answer.points[0, -1], 240.0 * np.sqrt([0.5, 0.5]), rtol=1e-14)
    gaps = np.diff(answer.points, axis=1)
    np.testing.assert_allclose(np.hypot(gaps[..., 0], gaps[..., 1]), 60.0, rtol=1e-13)


@pytest.mark.parametrize("solver", ["explicit", "implicit", "DOP853", "Radau"])
def test_every_reference_tells_the_same_motion(solver: str, fmu: Path) -> None:
    case = case_of("cable.links = 3")
    answer = answer_to(Request(case, fmu))
    reference = answer_to(Request(case, fmu, solver=solver, tolerance=1e-8, step=0.5))
    np.testing.assert_array_equal(reference.times, [0.0, 0.5, 1.0])
    # 1e-6 in three angles of 240 m
    np.testing.assert_allclose(reference.points, answer.points[::5], atol=240.0 * 1e-6)


def test_a_nudge_moves_the_start_by_as_much_and_always_alike(fmu: Path) -> None:
    request = Request(case_of("cable.links = 3"), fmu)
    plain, nudged, again = (answer_to(replace(request, nudge=nudge)) for nudge in (0.0, 1e-6, 1e-6))
    apart = float(np.max(np.abs(nudged.points[0] - plain.points[0])))
    assert 1e-6 * 80.0 * 0.1 < apart < 1e-6 * 240.0 * 4.0
    np.testing.assert_array_equal(nudged.points, again.points)


def test_an_error_says_what_and_when(worker: Worker, fmu: Path) -> None:
    unreachable = case_of('terminal = { kind = "pin", position = [200, 200] }, shape = { kind = "catenary" }')
    answer = worker.ask(Request(unreachable, fmu), GENEROUS)
    assert answer.outcome == "error"
    assert answer.message.startswith("g-a.toml: terminal.position = [200.0, 200.0]: the ports are 282.843 m apart")
    sinking = case_of('top.stiffness = 0, inputs.u_m1 = 1000, run.initial = "equilibrium"')
    answer = worker.ask(Request(sinking, fmu), GENEROUS)
    assert answer.outcome == "error"
    assert answer.message.startswith("no stable equilibrium was found near the start shape at t = 0 s")


def test_a_hang_is_told_and_the_next_run_is_served(worker: Worker, fmu: Path) -> None:
    worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS)
    began = time.monotonic()
    answer = worker.ask(Request(case_of("cable.links = 4", Sleeping), fmu), 0.5)
    assert (answer.outcome, answer.message) == ("hang", "no end after 0.5 s")
    assert time.monotonic() - began < 30.0
    assert worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS).outcome == "ended"


def test_a_crash_is_told_and_the_next_run_is_served(worker: Worker, fmu: Path) -> None:
    answer = worker.ask(Request(case_of("cable.links = 4", Dying), fmu), GENEROUS)
    assert (answer.outcome, answer.message) == ("crash", "the worker died: it ended with status 3")
    assert worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS).outcome == "ended"


def test_a_worker_that_the_system_kills_is_told_and_the_next_run_is_served(worker: Worker, fmu: Path) -> None:
    answer = worker.ask(Request(case_of("cable.links = 4", Killed), fmu), GENEROUS)
    assert answer.outcome == "crash"
    assert answer.message == "the worker died: killed by SIGKILL, by the system for want of memory perhaps"
    assert worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS).outcome == "ended"


def test_an_idle_worker_that_is_killed_is_told_at_the_next_request(fmu: Path) -> None:
    others, worker = set(multiprocessing.active_children()), Worker()
    try:
        worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS)
        (process,) = set(multiprocessing.active_children()) - others
        assert process.pid is not None
        os.kill(process.pid, signal.SIGKILL)
        process.join(GENEROUS)
        answer = worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS)
        assert (answer.outcome, answer.message[:34]) == ("crash", "the worker died: killed by SIGKILL")
        assert worker.ask(Request(case_of("cable.links = 4"), fmu), GENEROUS).outcome == "ended"
    finally:
        worker.close()


def test_the_largest_force_is_told(fmu: Path) -> None:
    """That of a sine of 50 Hz as well, which is zero at all output times."""
    sine = 'inputs.u_m1 = { signal = "sine", amplitude = "1e6 N", frequency = "50 Hz" }'
    assert answer_to(Request(case_of(f"cable.links = 3, {sine}"), fmu)).figures["force"] == pytest.approx(1e6, rel=0.01)
    pull = answer_to(Request(case_of("cable.links = 4"), fmu.with_name("other.fmu"))).figures["force"]
    assert 500.0 < pull < 1e5  # a cable of 240 m and 60 kg that falls


def test_what_is_no_message_to_a_user_is_a_crash(worker: Worker, fmu: Path) -> None:
    answer = worker.ask(Request(case_of("cable.links = 4", Buggy), fmu), GENEROUS)
    assert answer.outcome == "crash" and "ZeroDivisionError" in answer.message
