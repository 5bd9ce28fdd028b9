"""Intermediate update of FMI 3: what is told and asked inside a step, and steps that the host ends early."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmi.raw import Raw, integers, numbers, references, size

OUTPUTS = ("y_m1", "x_c", "y_c", "vx_c", "tension_top", "energy")
SOLVERS = {"explicit": 2, "implicit": 3}


@dataclass
class Update:
    """The arguments of one call-back."""

    time: float
    asked: bool
    readable: bool
    finished: bool
    may_return: bool


def force(time: float) -> float:
    return 800.0 * math.sin(2.0 * math.pi * time)


def set_solver(raw: Raw, solver: str) -> None:
    reference, one = references(raw.reference["solver"]), size(1)
    raw.must("SetInt64", reference, one, (np.ctypeslib.as_ctypes(np.array([SOLVERS[solver]], dtype=np.int64))), one)


class Watch:
    """A host that writes down every update, drives u_m1 if asked, reads if allowed, and ends steps if it is to."""

    def __init__(self, *, reads: bool = False, ends: dict[float, float] | None = None) -> None:
        self.updates: list[Update] = []
        self.values: dict[float, list[float]] = {}
        self.reads, self.ends = reads, ends or {}

    def __call__(
        self, raw: Raw, time: float, asked: bool, readable: bool, finished: bool, may_return: bool
    ) -> float | None:
        self.updates.append(Update(time, asked, readable, finished, may_return))
        if readable and self.reads:
            self.values[time] = raw.get(*OUTPUTS)
            value, one = numbers(0.0), size(1)
            raw.must("GetOutputDerivatives", references(raw.reference["x_c"]), one, integers(1), value, one)
        if asked:
            assert raw.set(u_m1=force(time)) == 0
        wish = next((end for start, end in self.ends.items() if time >= start), None)
        return wish if may_return else None


def run(raw: Raw, stop: float, step: float) -> list[float]:
    """Communication steps of this length, continued after an early return."""
    time, reached = 0.0, [0.0]
    while time < stop - 1e-12:
        status, early, now = raw.step(time, min(step, stop - time))
        assert status == 0, raw.messages
        assert early == (now < time + min(step, stop - time))
        time = now
        reached.append(now)
    return reached


def test_the_description_promises_it(unpacked: Unpacked) -> None:
    text = (unpacked("load", 3) / "modelDescription.xml").read_text()
    (offered,) = (line for line in text.splitlines() if "<CoSimulation" in line)
    for flag in ("providesIntermediateUpdate", "mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate"):
        assert f'{flag}="true"' in offered
    described = [line for line in text.splitlines() if 'intermediateUpdate="true"' in line]
    assert all('causality="input"' in line or 'causality="output"' in line for line in described)
    assert {"u_m1", "x_c", "tension_max"} <= {line.split('name="')[1].split('"')[0] for line in described}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("listen", [("u_m1", "x_c"), ("x_c", "energy")])
def test_updates_are_as_the_standard_says(solver: str, listen: tuple[str, ...], unpacked: Unpacked) -> None:
    watch = Watch(reads=True)
    with Raw(unpacked("load", 3), "cs", inside=watch, listen=listen, returns_early=True) as raw:
        set_solver(raw, solver)
        raw.initialize()
        for start in (0.0, 0.5):
            watch.updates.clear()
            assert raw.step(start, 0.5) == (0, False, start + 0.5)
            latest = start
            for update in watch.updates:
                assert start <= update.time <= start + 0.5
                assert update.time >= latest, "never before an accepted step"
                assert update.readable == update.finished
                assert update.asked == ("u_m1" in listen)
                assert update.may_return == (update.finished and update.time < start + 0.5)
                latest = update.time if update.finished else latest
            finished = [update.time for update in watch.updates if update.finished]
            assert len(finished) > 2 or "u_m1" not in listen
            assert finished == sorted(set(finished)) and finished[-1] == start + 0.5
            assert ("u_m1" in listen) == any(not update.finished for update in watch.updates)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", ["load", "pin"])
def test_what_is_read_inside_is_what_a_step_to_there_gives_and_leaves_no_trace(
    solver: str, kind: str, unpacked: Unpacked
) -> None:
    """The solver's bits are those of a run that nobody watches."""
    ends: list[list[float]] = []
    watch = Watch(reads=True)
    for inside in (watch, Watch()):
        with Raw(unpacked(kind, 3), "cs", inside=inside, listen=("u_m1",)) as raw:
            set_solver(raw, solver)
            raw.initialize()
            run(raw, 1.0, 0.25)
            ends.append(raw.get(*OUTPUTS, "solver.steps", "solver.rhs"))
    assert ends[0] == ends[1]
    times = sorted(watch.values)
    with Raw(unpacked(kind, 3), "cs", inside=Watch(), listen=("u_m1",)) as raw:
        set_solver(raw, solver)
        raw.initialize(tolerance=1e-9)
        for start, end in itertools.pairwise([0.0, *times]):
            assert raw.step(start, end - start)[0] == 0
            # Both within their tolerances; a tension is a force of some 1e4 N through stiff links.
            np.testing.assert_allclose(watch.values[end], raw.get(*OUTPUTS), rtol=2e-4, atol=2e-4)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("listen", [("u_m1",), ("x_c",), ()])
def test_an_early_return_costs_nothing(solver: str, listen: tuple[str, ...], unpacked: Unpacked) -> None:
    """It comes at the time that was asked for, or at once if that is past, and the run goes on to the same answer."""
    ends: list[list[float]] = []
    for watch in (Watch(), Watch(ends={0.9: 0.0, 0.55: 0.625, 0.1: 0.3})):
        with Raw(unpacked("load", 3), "cs", inside=watch, listen=listen, returns_early=True) as raw:
            set_solver(raw, solver)
            raw.initialize()
            reached = run(raw, 1.2, 0.4)
            ends.append(raw.get("y_m1", "x_c", "y_c", "vx_c"))
        if watch.ends:
            assert {0.3, 0.625} <= set(reached)
            assert [time for time in reached if 0.9 <= time < 1.2], "the next possible time after 0.9 s"
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=2e-5)  # tolerance 1e-6, a second of motion


def test_nobody_returns_early_unasked(unpacked: Unpacked) -> None:
    watch = Watch(ends={0.0: 0.0})
    with Raw(unpacked("load", 3), "cs", inside=watch, listen=("u_m1",)) as raw:
        raw.initialize()
        assert raw.step(0.0, 0.4) == (0, False, 0.4)
    assert not any(update.may_return for update in watch.updates)


def test_a_wish_that_was_not_offered_changes_nothing(unpacked: Unpacked) -> None:
    def always(raw: Raw, time: float, *_: Any) -> float:
        return 0.0

    with Raw(unpacked("load", 3), "cs", inside=always, listen=("u_m1", "x_c")) as raw:
        raw.initialize()
        assert raw.step(0.0, 0.4) == (0, False, 0.4)


def test_no_time_to_return_at(unpacked: Unpacked) -> None:
    with Raw(unpacked("load", 3), "cs", inside=Watch(ends={0.0: math.nan}), returns_early=True) as raw:
        raw.initialize()
        assert raw.step(0.0, 0.4)[0] == 3
        assert "earlyReturnTime is not a number" in raw.messages[0][2]
        assert "the host gave no time to return at" in raw.messages[1][2]
        assert raw.step(0.0, 0.4)[0] == 3


@pytest.mark.parametrize(
    ("name", "says"),
    [("m_c", "it is not set or read inside a step"), ("solver.steps", "it is not set or read inside a step")],
)
def test_what_cannot_be_had_inside_is_told_at_once(name: str, says: str, unpacked: Unpacked) -> None:
    with Raw(unpacked("load", 3), "cs", inside=Watch(), listen=(name,)) as raw:
        assert raw.pointer is None
        ((status, category, message),) = raw.messages
        assert (status, category) == (3, "logStatusError") and says in message and name in message


def test_a_refused_force_at_an_accepted_step_ends_it(unpacked: Unpacked) -> None:
    def tell(raw: Raw, time: float, asked: bool, readable: bool, *_: bool) -> None:
        raw.set(u_m1=math.nan if readable else 1.0)

    with Raw(unpacked("load", 3), "cs", inside=tell, listen=("u_m1",)) as raw:
        raw.initialize()
        assert raw.step(0.0, 0.4)[0] == 3
        assert raw.messages[0][2].startswith("u_m1 = nan")


def test_there_is_no_event_mode(unpacked: Unpacked) -> None:
    with Raw(unpacked("load", 3), "cs", event_mode=True) as raw:
        assert raw.pointer is None
        assert "hasEventMode = false" in raw.messages[0][2]
