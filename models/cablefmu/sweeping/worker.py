"""What happens in a worker: subjects are opened once a process, then batches of cases come by."""

from __future__ import annotations

import signal
import threading
import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin, get_worker

from .. import __version__
from ..errors import CableError
from .cases import Given
from .figures import Plan, figures
from .store import Row, Series
from .subjects import Package, Subject

__all__ = ["Bench", "Finished", "Job", "OpensOnce", "Task", "Undisturbed", "run_batch"]


@dataclass(frozen=True, slots=True)
class Task:
    """One case as a worker gets it."""

    case: int
    key: str
    subject: str
    given: Given
    """What varies"""


@dataclass(frozen=True, slots=True)
class Job:
    """What all cases have in common."""

    name: str
    """Of the plug-in, unlike those of other sweeps on the same scheduler"""
    packages: Sequence[Package]
    plans: Mapping[str, Plan]
    always: Given
    """Set in every case"""
    keep_series: bool


@dataclass(frozen=True, slots=True)
class Finished:
    """What comes back of a batch."""

    rows: Sequence[Row]
    series: Sequence[Series]
    seconds: float


class Bench:
    """A job's subjects, opened when a case first needs them."""

    def __init__(self, job: Job, folder: Path | None = None) -> None:
        self._job, self._folder = job, folder
        self._packages = {package.name: package for package in job.packages}
        self._open: dict[str, Subject] = {}
        self._lock = threading.Lock()  # FMPy changes the folder of the process while it loads a library

    def run(self, tasks: Sequence[Task]) -> Finished:
        """Run them one after the other; whatever happens to one, the others are run."""
        with self._lock:
            for task in tasks:
                self._subject(task.subject)  # what opening takes says nothing of what cases take
            began = clock.perf_counter()
            series: list[Series] = []
            rows = [self._row(task, series) for task in tasks]
            return Finished(rows, series, clock.perf_counter() - began)

    def close(self) -> None:
        for subject in self._open.values():
            subject.close()
        self._open.clear()

    def _row(self, task: Task, series: list[Series]) -> Row:
        began = clock.perf_counter()
        try:
            outcome = self._subject(task.subject).run({**self._job.always, **task.given})
        except CableError as error:
            return _failed(task, str(error), clock.perf_counter() - began)
        except Exception as error:  # nothing that one case does may end a sweep
            return _failed(task, f"{type(error).__name__}: {error}", clock.perf_counter() - began)
        plan = self._job.plans[task.subject]
        ended_at = float(outcome.times[-1]) if outcome.times.size else 0.0
        if self._job.keep_series and outcome.times.size:
            kept = {name: outcome.values[:, column] for name, column in plan.kept.items()}
            series.append(Series(task.case, outcome.times, kept))
        if outcome.reason:
            return _failed(task, outcome.reason, outcome.seconds, ended_at)
        found = figures(outcome, plan)
        return Row(task.case, task.key, task.subject, task.given, "ended", ended_at, "", found, outcome.seconds)

    def _subject(self, name: str) -> Subject:
        if name not in self._open:
            self._open[name] = self._packages[name].open(self._folder)
        return self._open[name]


def _failed(task: Task, reason: str, seconds: float, ended_at: float = 0.0) -> Row:
    text = " ".join(reason.split())
    return Row(task.case, task.key, task.subject, task.given, "failed", ended_at, text, {}, seconds)


class OpensOnce(WorkerPlugin):
    """Gives every worker a bench, those that come later or again as well."""

    def __init__(self, job: Job, version: str = __version__) -> None:
        self.name = job.name
        self._job, self._version = job, version

    def setup(self, worker: Any) -> None:
        if self._version != __version__:
            raise RuntimeError(f"cablefmu {__version__} is installed there; {self._version} is expected")
        worker.__dict__.setdefault(_BENCHES, {})[self.name] = Bench(self._job, Path(worker.local_directory))

    def teardown(self, worker: Any) -> None:
        bench = worker.__dict__.get(_BENCHES, {}).pop(self.name, None)
        if bench is not None:
            bench.close()


class Undisturbed(WorkerPlugin):
    """Ctrl-C at a terminal reaches all its processes: the parent ends the workers of its own machine, in order."""

    name = "cablefmu-undisturbed"

    def setup(self, worker: Any) -> None:
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGINT, signal.SIG_IGN)


_BENCHES = "cablefmu_benches"


def run_batch(job: str, tasks: Sequence[Task]) -> Finished:
    """On a worker: with the bench that the plug-in put there."""
    bench: Bench = get_worker().__dict__[_BENCHES][job]
    return bench.run(tasks)
