"""Forty cases for two workers, one of which ends the process that runs it; prints what came of each as JSON."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cablefmu.sweeping.cases import Given
from cablefmu.sweeping.cluster import connected, finished_batches
from cablefmu.sweeping.figures import Plan
from cablefmu.sweeping.subjects import Outcome, Output
from cablefmu.sweeping.worker import Job, Task


@dataclass(frozen=True)
class Deadly:
    """Package and subject in one."""

    name: str = "deadly"
    identity: str = ""
    outputs: Sequence[Output] = (Output("y", "m", ""),)

    def open(self, folder: Path | None = None) -> Deadly:
        return self

    def run(self, given: Given) -> Outcome:
        if given["x"] == 7.0:
            os.kill(os.getpid(), signal.SIGKILL)
        return Outcome(np.zeros(1), np.zeros((1, 1)), "", 0.0)

    def check(self, name: str, value: float | str) -> None:
        """Everything goes."""

    def close(self) -> None:
        """Nothing is open."""

    @property
    def settings(self) -> dict[str, float | str]:
        return {}


def main() -> None:
    # Under its importable name, as workers have no other.
    from tests.sweeping.deadly import Deadly as Importable

    job = Job("deadly", [Importable()], {"deadly": Plan({"y": 0}, [], 3.0)}, {}, False)
    tasks = [Task(case, "", "deadly", {"x": float(case)}) for case in range(1, 41)]
    with connected(None, 2, 30.0) as client:
        rows = [row for batch in finished_batches(client, job, tasks, 30.0) for row in batch.rows]
    print(json.dumps({row.case: (row.status, row.reason) for row in rows}))


if __name__ == "__main__":
    main()
