"""Real workers in processes of their own: the same table whoever runs it, however it is interrupted, whoever dies."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from tests.fmu_helpers import SCENES
from tests.test_sweep_command import without_times

pytestmark = pytest.mark.slow  # processes that load the package, and wait for each other

ROOT = Path(__file__).parents[2]
COUNT = 1200
"""Some 5 s of two workers: seconds are left when a tenth is done, on a machine that is busy too"""
PATIENCE = 300.0
"""Seconds, on a machine that is busy"""


@pytest.fixture
def here(tmp_path: Path) -> Path:
    (tmp_path / "load.toml").write_text(SCENES["load"])
    return tmp_path


def started(arguments: Sequence[str], folder: Path, **named: Any) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", *arguments]
    return subprocess.Popen(
        command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True, **named
    )


def sweeps(folder: Path, output: str, *more: str) -> subprocess.Popen[str]:
    """Cases of a few milliseconds."""
    cases = ["--sample", "M_1=500:900", "Cd=0.5:2", "--count", str(COUNT)]
    return started(["cablefmu", "sweep", "load.toml", *cases, "-o", output, *more], folder)


def ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Status, and errors less how far it was now and then."""
    _, err = process.communicate(timeout=PATIENCE)
    return process.returncode, "".join(line for line in err.splitlines(True) if not line.endswith(" s left\n"))


def wait_for(what: Callable[[], object], process: subprocess.Popen[str] | None = None) -> None:
    until = time.monotonic() + PATIENCE
    while not what():
        assert time.monotonic() < until
        assert process is None or process.poll() is None, process.communicate()
        time.sleep(0.01)


def cases_in(folder: Path) -> int:
    """Of a store that another process writes to."""
    return sum(pq.read_metadata(path).num_rows for path in (folder / "parts").glob("0*.parquet"))


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What one process makes of it, without a cluster."""
    folder = tmp_path_factory.mktemp("alone")
    (folder / "load.toml").write_text(SCENES["load"])
    assert ended(sweeps(folder, "out", "--workers", "0")) == (0, "")
    return without_times(folder / "out" / "cases.csv")


@pytest.mark.parametrize(
    ("number", "end"), [(signal.SIGKILL, (-signal.SIGKILL, "")), (signal.SIGINT, (130, "cablefmu: interrupted\n"))]
)
def test_killed_half_way_it_ends_with_the_same_table(
    number: signal.Signals, end: tuple[int, str], here: Path, table: list[str]
) -> None:
    """The whole process group at once; what was stored is not run again."""
    process = sweeps(here, "out", "--workers", "2")
    wait_for(lambda: cases_in(here / "out") > COUNT // 10, process)
    os.killpg(process.pid, number)
    assert ended(process) == end
    kept = {path.name: path.read_bytes() for path in (here / "out" / "parts").glob("0*.parquet")}
    finished = cases_in(here / "out")
    assert COUNT // 10 < finished < COUNT
    assert not (here / "out" / "cases.csv").exists()
    assert ended(sweeps(here, "out", "--workers", "2")) == (
        0, f"load: {finished} of {COUNT} cases are finished already\n"
    )  # fmt: skip
    assert without_times(here / "out" / "cases.csv") == table
    assert {name: (here / "out" / "parts" / name).read_bytes() for name in kept} == kept


@contextmanager
def scheduler(folder: Path) -> Iterator[str]:
    """A Dask scheduler in a process of its own; its address."""
    file = folder / "scheduler.json"
    options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)]
    process = started(["distributed.cli.dask_scheduler", *options], folder)
    try:
        wait_for(lambda: file.exists() and file.read_text().endswith("}"), process)
        yield json.loads(file.read_text())["address"]
    finally:
        process.kill()
        process.communicate()


@contextmanager
def worker(address: str, folder: Path) -> Iterator[subprocess.Popen[str]]:
    """One of its workers, that nobody starts again."""
    options = ["--no-dashboard", "--no-nanny", "--nthreads", "2", "--local-directory", str(folder / "scratch")]
    process = started(["distributed.cli.dask_worker", address, *options], folder)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def test_workers_of_a_scheduler_that_are_lost_and_come_again(here: Path, table: list[str]) -> None:
    with scheduler(here) as address:
        process = sweeps(here, "out", "--scheduler", address, "--wait", "0.5")
        status, err = ended(process)
        assert status == 1
        assert f"scheduler = {address}: it has no workers after 0.5 s" in err
        with worker(address, here) as lost:
            process = sweeps(here, "out", "--scheduler", address, "--wait", "60")
            wait_for(lambda: cases_in(here / "out") > COUNT // 10, process)
            lost.kill()
            with worker(address, here):
                assert ended(process) == (0, "")
        assert without_times(here / "out" / "cases.csv") == table
        with worker(address, here) as lost:
            process = sweeps(here, "other", "--scheduler", address, "--wait", "2")
            wait_for(lambda: cases_in(here / "other") > COUNT // 10, process)
            lost.kill()
            status, err = ended(process)
            assert status == 1
            assert "all workers were lost, and none came back in 2 s" in err
        assert ended(sweeps(here, "other", "--workers", "1"))[0] == 0
    assert without_times(here / "other" / "cases.csv") == table


def test_a_scheduler_that_is_lost_or_never_was(here: Path) -> None:
    with scheduler(here) as address, worker(address, here):
        process = sweeps(here, "out", "--scheduler", address)
        wait_for(lambda: cases_in(here / "out") > COUNT // 8, process)
    status, err = ended(process)
    assert (status, err) == (1, "cablefmu: the scheduler was lost\n")
    status, err = ended(sweeps(here, "out", "--scheduler", address))
    assert status == 2
    assert f"scheduler = {address}: nothing answers there; the address of a Dask scheduler is expected" in err
    status, err = ended(sweeps(here, "out", "--scheduler", "nonsense://x"))
    assert status == 2
    assert "scheduler = nonsense://x: " in err


def test_a_case_that_kills_its_worker_is_told_of_and_the_others_are_run(tmp_path: Path) -> None:
    """Of 40 cases number 7 ends the process: see tests/sweeping/deadly.py."""
    process = started(["tests.sweeping.deadly"], ROOT)
    out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")
    found = json.loads(out)
    assert sorted(map(int, found)) == list(range(1, 41))
    assert found.pop("7") == ["lost", "the process that ran it died"]
    assert set(map(tuple, found.values())) == {("ended", "")}
