"""A sweep, from what is asked for to its table.

`run_sweep` is the table of contents: build what is run, check every value, open the store, run what is not in it yet.
"""

from __future__ import annotations

import hashlib
import os
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import __version__
from ..errors import OptionError, SweepError
from .api import Crew, Progress
from .batches import Sizer
from .cluster import connected, finished_batches
from .description import Sweep
from .figures import EXTREMES, Plan, plan_for
from .store import Store, remove
from .subjects import Output, Package, packages_of
from .table import write_table
from .worker import Bench, Finished, Job, Task

__all__ = ["Work", "prepared", "run_sweep"]


def run_sweep(
    asked: Sweep, folder: Path, crew: Crew, *, keep_series: bool = False, restart: bool = False,
    progress: Progress | None = None,
) -> list[Path]:  # fmt: skip
    """Run what is not in the folder yet, and write the table.

    Returns the files that hold it, the table first.

    Raises
    ------
    UserError, RunError
        See `sweep`.
    """
    crew.check()
    work = prepared(asked)
    if restart:
        remove(folder)
    with closing(work.store(folder, keep_series)) as store:
        finished = store.finished()
        tasks = work.tasks()
        waiting = [task for task in tasks if finished.get(task.case) != task.key]
        done, failed = len(tasks) - len(waiting), store.failed()
        if progress:
            progress(done, failed, len(tasks))
        for batch in _run(work.job(keep_series), waiting, crew):
            store.add(batch.rows, batch.series)
            done += len(batch.rows)
            failed += sum(row.status != "ended" for row in batch.rows)
            if progress:
                progress(done, failed, len(tasks))
        return write_table(folder)


@dataclass(frozen=True, slots=True)
class _Subject:
    """One scene (or coupling), looked at."""

    package: Package
    identity: str
    settings: Mapping[str, float | str]
    outputs: Sequence[Output]
    plan: Plan


@dataclass(frozen=True, slots=True)
class Work:
    """A sweep whose scenes and values are in order."""

    asked: Sweep
    subjects: Mapping[str, _Subject]

    def tasks(self) -> list[Task]:
        """All cases, each with the hash of what decides on its result."""
        always = self.asked.spec.set
        begins = {
            name: hashlib.sha256(repr((__version__, s.identity, s.settings, s.plan)).encode())
            for name, s in self.subjects.items()
        }  # fmt: skip
        tasks = []
        for case in self.asked.axes.cases():
            digest = begins[case.subject].copy()
            digest.update(repr(sorted({**always, **case.given}.items())).encode())
            tasks.append(Task(case.number, digest.hexdigest(), case.subject, case.given))
        return tasks

    def job(self, keep_series: bool) -> Job:
        plans = {name: subject.plan for name, subject in self.subjects.items()}
        packages = [subject.package for subject in self.subjects.values()]
        return Job(f"cablefmu-{uuid.uuid4().hex}", packages, plans, self.asked.spec.set, keep_series)

    def store(self, folder: Path, keep_series: bool) -> Store:
        axes = self.asked.axes
        words = list(dict.fromkeys(name for name, value in axes.settings() if isinstance(value, str)))
        units = {name: unit for s in self.subjects.values() for name, unit in _columns(s)}
        about = {
            "title": self.asked.name, "description": self.asked.spec.description, "cases": len(axes),
            "values": axes.names, "figures": units,
        }  # fmt: skip
        return Store(folder, self._identity(keep_series), values=axes.names, words=words, about=about)

    def _identity(self, keep_series: bool) -> dict[str, Any]:
        """What decides on results, by what a person calls it."""
        spec, axes = self.asked.spec, self.asked.axes
        found: dict[str, Any] = {"version of cablefmu": __version__, "list of scenes": list(axes.subjects)}
        for name, subject in self.subjects.items():
            found |= {f"{key} of {name}": value for key, value in subject.settings.items()}
            found[f"content of {name}"] = subject.identity
        values = hashlib.sha256("".join(task.key for task in self.tasks()).encode()).hexdigest()
        return found | {
            "[set]": dict(spec.set), "[statistics]": spec.statistics.model_dump(mode="json"),
            "number of cases": len(axes), "list of varied names": axes.names, "list of cases": values,
            "keeping of series": keep_series,
        }  # fmt: skip


def _columns(subject: _Subject) -> Iterator[tuple[str, str]]:
    """Names and units of what is measured."""
    units = {output.name: output.unit for output in subject.outputs}
    for name in subject.plan.kept:
        yield from ((f"{name}.{what}", units[name]) for what in EXTREMES)
    for name in subject.plan.fatigue:
        yield f"{name}.equivalent", units[name]


def prepared(asked: Sweep) -> Work:
    """Everything that can be refused is refused here, all of it at once."""
    found: dict[str, _Subject] = {}
    mistakes: dict[str, None] = {}
    values = [*asked.spec.set.items(), *asked.axes.settings()]
    for package in packages_of(asked):
        with closing(package.open()) as subject:
            for name, value in values:
                try:
                    subject.check(name, value)
                except OptionError as error:
                    mistakes[f"{asked.source}: {package.name}: {error}"] = None
            plan = plan_for(subject.outputs, asked.spec.statistics)
            found[package.name] = _Subject(package, package.identity, subject.settings, subject.outputs, plan)
    known = {output.name for subject in found.values() for output in subject.outputs}
    for key, names in (("outputs", asked.spec.statistics.outputs), ("fatigue", asked.spec.statistics.fatigue)):
        for name in names or ():
            if name not in known:
                mistakes[f"{asked.source}: statistics.{key}: there is no output {name}"] = None
    if mistakes:
        shown = list(mistakes)[:_MOST_LINES]
        raise SweepError("\n".join(shown + ["... and more"] * (len(mistakes) > _MOST_LINES)))
    return Work(asked, found)


_MOST_LINES = 50


def _run(job: Job, tasks: Sequence[Task], crew: Crew) -> Iterator[Finished]:
    """Finished cases as they come."""
    if not tasks:
        return
    if crew.workers == 0:
        yield from _run_here(job, tasks)
        return
    with connected(crew.scheduler, crew.workers or min(_cores(), len(tasks)), crew.wait) as client:
        yield from finished_batches(client, job, tasks, crew.wait)


def _run_here(job: Job, tasks: Sequence[Task]) -> Iterator[Finished]:
    """In this process; what is stored at once is as large as with a cluster."""
    sizer, done = Sizer(), 0
    with closing(Bench(job)) as bench:
        while done < len(tasks):
            size = sizer.next(len(tasks) - done, 1)
            finished = bench.run(tasks[done : done + size])
            sizer.learn(size, finished.seconds)
            done += size
            yield finished


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
