"""Workers of Dask: those of this machine, or those behind a scheduler; batches go out, finished cases come back."""

from __future__ import annotations

import logging
import queue
import time as clock
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import dask
from distributed import Client, KilledWorker, LocalCluster

from ..errors import OptionError, RunError
from .batches import IN_HAND, Sizer
from .store import Row
from .worker import Finished, Job, OpensOnce, Task, Undisturbed, run_batch

__all__ = ["connected", "finished_batches"]

_ANSWER = 10.0
"""Seconds that a scheduler may take to answer."""
_GLANCE = 1.0
"""How often it is looked whether workers are there [s]"""


@contextmanager
def connected(scheduler: str | None, workers: int, wait: float) -> Iterator[Client]:
    """A client of the scheduler at an address, or of so many workers on this machine, a process each.

    Raises
    ------
    OptionError
        If nothing answers at the address.
    RunError
        If it has no workers within `wait` seconds.
    """
    if scheduler is None:
        with _local(workers) as client:
            yield client
        return
    _be_quiet()
    try:
        client = Client(scheduler, timeout=_ANSWER, set_as_default=False)
    except (OSError, ValueError, TypeError, ImportError) as error:
        why = "nothing answers there" if isinstance(error, OSError) else str(error)
        raise OptionError(f"scheduler = {scheduler}: {why}; the address of a Dask scheduler is expected") from None
    with client:
        begun = clock.monotonic()
        while not client.nthreads():
            if clock.monotonic() - begun > wait:
                text = f"it has no workers after {wait:g} s; `dask worker {scheduler}` starts one"
                raise RunError(f"scheduler = {scheduler}: {text}")
            clock.sleep(0.1)
        yield client


@contextmanager
def _local(workers: int) -> Iterator[Client]:
    _be_quiet()
    settings = {
        "distributed.scheduler.allowed-failures": 0,  # who died of what is found out here
        "distributed.worker.memory.terminate": False,  # a worker that is large is not a worker that is ill
        "distributed.worker.daemon": True,
        "distributed.worker.profile.enabled": False,  # every core is for cases
        "distributed.admin.system-monitor.interval": "10s",
    }
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1",
            silence_logs=logging.CRITICAL, memory_limit=0,
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # any port: two sweeps may run beside each other
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):  # fmt: skip
        client.register_plugin(Undisturbed())
        yield client


def _be_quiet() -> None:
    """What Dask logs of workers that come and go is told in the table."""
    for name in list(logging.Logger.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)


def finished_batches(client: Client, job: Job, tasks: Sequence[Task], wait: float) -> Iterator[Finished]:
    """Run tasks on all workers there are; in the order in which they end.

    A batch whose worker died is run again case by case, each alone, so that the one that kills workers is known.

    Raises
    ------
    RunError
        If a worker cannot be used, the scheduler is lost, or there is no worker for `wait` seconds.
    """
    plugin = OpensOnce(job)
    try:
        client.register_plugin(plugin)
    except Exception as error:  # of whatever kind the worker raised
        raise RunError(f"a worker cannot be used: {error}") from None
    try:
        crew = _Crew(client, job, tasks, wait)
        yield from crew.batches()
    finally:
        if client.status == "running":
            client.unregister_worker_plugin(plugin.name)


class _Crew:
    """Batches that are out, and cases that wait."""

    def __init__(self, client: Client, job: Job, tasks: Sequence[Task], wait: float) -> None:
        self._client, self._job, self._wait = client, job, wait
        self._waiting = deque(tasks)
        self._out: dict[Any, list[Task]] = {}
        self._back: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._sizer = Sizer()
        self._workers, self._looked = 0, -_GLANCE
        self._seen = clock.monotonic()

    def batches(self) -> Iterator[Finished]:
        suspects: list[Task] = []
        while self._waiting or self._out:
            self._send()
            yield from self._receive(suspects)
        for task in suspects:
            alone: list[Task] = []
            self._submit([task])
            while self._out:
                yield from self._receive(alone)
            if alone:
                yield Finished([_lost(task)], [], 0.0)

    def _send(self) -> None:
        workers = self._count_workers()
        while self._waiting and len(self._out) < IN_HAND * workers:
            size = self._sizer.next(len(self._waiting), workers)
            self._submit([self._waiting.popleft() for _ in range(size)])

    def _submit(self, tasks: list[Task]) -> None:
        future = self._client.submit(run_batch, self._job.name, tasks, pure=False)
        self._out[future] = tasks
        future.add_done_callback(self._back.put)

    def _receive(self, suspects: list[Task]) -> Iterator[Finished]:
        """What has come back, if anything did within a glance."""
        try:
            future = self._back.get(timeout=_GLANCE)
        except queue.Empty:
            self._check_connection()
            return
        tasks = self._out.pop(future)
        try:
            finished: Finished = future.result()
        except KilledWorker:
            suspects += tasks
            return
        except Exception as error:
            self._check_connection()
            raise RunError(f"a worker could not run its cases: {type(error).__name__}: {error}") from None
        future.release()
        self._sizer.learn(len(tasks), finished.seconds)
        yield finished

    def _count_workers(self) -> int:
        """As of a moment ago."""
        now = clock.monotonic()
        if now - self._looked >= _GLANCE:
            self._check_connection()
        return self._workers

    def _check_connection(self) -> None:
        self._looked = now = clock.monotonic()
        if self._client.status != "running":
            raise RunError("the scheduler was lost")
        try:
            self._workers = len(self._client.nthreads())
        except (OSError, TimeoutError):
            raise RunError("the scheduler was lost") from None
        if self._workers:
            self._seen = now
        elif now - self._seen > self._wait:
            raise RunError(f"all workers were lost, and none came back in {self._wait:g} s")


def _lost(task: Task) -> Row:
    reason = "the process that ran it died"
    return Row(task.case, task.key, task.subject, task.given, "lost", 0.0, reason, {}, 0.0)
