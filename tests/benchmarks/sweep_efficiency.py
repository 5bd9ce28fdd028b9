"""How much of two cores a sweep uses: `python -m tests.benchmarks.sweep_efficiency [CASES [WORKERS]]`.

One process runs the cases one after the other, without a cluster and without a store. Then as many workers as there
are cores to be used run the same cases, each finished batch stored on the disk before it counts. Efficiency is the
first time over the second and over the number of workers; workers take some seconds to start, which are told apart.
Both must give the same rows.
"""

from __future__ import annotations

import sys
import tempfile
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from cablefmu.sweeping.cluster import connected, finished_batches
from cablefmu.sweeping.description import make_sweep
from cablefmu.sweeping.run import Work, prepared
from cablefmu.sweeping.store import Row
from cablefmu.sweeping.worker import Bench

__all__ = ["measured"]

SCENE = "free-60-water"
RANGES = {"M_1": [4000.0, 8000.0], "Cd": [0.8, 1.2]}


def measured(cases: int, workers: int) -> dict[str, float]:
    """Seconds of one process and of the workers, of starting these, and efficiencies."""
    sample = {"count": cases, "seed": 1, "ranges": RANGES}
    work = prepared(make_sweep({"scenes": [SCENE], "sample": sample}, name="efficiency"))
    alone, one = in_one_process(work)
    begun = time.perf_counter()
    with connected(None, workers, 60.0) as client, tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        with closing(work.store(Path(folder), keep_series=False)) as store:
            rows: list[Row] = []
            for batch in finished_batches(client, work.job(keep_series=False), work.tasks(), 60.0):
                store.add(batch.rows)
                rows += batch.rows
        ended = time.perf_counter()
    if untimed(rows) != untimed(one):
        raise SystemExit("the workers' rows are others than those of one process")
    return {
        "one process": alone, "workers": ended - started, "starting them": started - begun,
        "efficiency": alone / (workers * (ended - started)),
        "efficiency, starting them included": alone / (workers * (ended - begun)),
    }  # fmt: skip


def in_one_process(work: Work) -> tuple[float, list[Row]]:
    with closing(Bench(work.job(keep_series=False))) as bench:
        finished = bench.run(work.tasks())
    return finished.seconds, list(finished.rows)


def untimed(rows: list[Row]) -> list[Row]:
    return sorted((replace(row, run_time=0.0) for row in rows), key=lambda row: row.case)


def main() -> None:
    cases, workers = (*map(int, sys.argv[1:]), *(1000, 2)[len(sys.argv) - 1 :])
    print(f"{cases} cases of {SCENE} with {workers} workers")
    for name, value in measured(cases, workers).items():
        print(f"{name:<36} {value:8.3f}" + ("" if "efficiency" in name else " s"))


if __name__ == "__main__":
    main()
