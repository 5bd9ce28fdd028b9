"""In a worker: whatever happens to one case, the others are run, and all are told of."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from cablefmu.fmu.archive import build_fmu
from cablefmu.simulate import simulate
from cablefmu.sweeping.figures import Plan
from cablefmu.sweeping.store import Row
from cablefmu.sweeping.subjects import Outcome, Output, ScenePackage
from cablefmu.sweeping.worker import Bench, Job, OpensOnce, Task
from tests.fmu_helpers import small_scene


class Falling:
    """A subject that does what its case asks for."""

    outputs: Sequence[Output] = (Output("y", "m", ""),)
    settings = {}  # noqa: RUF012  # the protocol's mapping
    opened = 0

    def check(self, name: str, value: float | str) -> None:
        raise AssertionError

    def run(self, given: object) -> Outcome:
        what = dict(given)["what"]  # type: ignore[call-overload]
        if what == "raises":
            raise ZeroDivisionError("division by zero")
        count = {"ends": 3, "fails": 2, "never starts": 0}[what]
        reason = "" if what == "ends" else "it broke\n  in two"
        return Outcome(np.arange(float(count)), np.arange(float(count))[:, None], reason, 0.25)

    def close(self) -> None:
        type(self).opened -= 1


class Package:
    name = "falling"
    identity = ""

    def open(self, folder: object = None) -> Falling:
        Falling.opened += 1
        return Falling()


def job(packages: Sequence[Package | ScenePackage], plan: Plan, keep_series: bool = False) -> Job:
    return Job("job", packages, {package.name: plan for package in packages}, {"M_1": 700.0}, keep_series)


def test_a_case_that_fails_says_why_and_when() -> None:
    asked = ("ends", "raises", "fails", "never starts")
    tasks = [Task(k, f"key{k}", "falling", {"what": what}) for k, what in enumerate(asked, start=1)]
    with closing(Bench(job([Package()], Plan({"y": 0}, [], 3.0), keep_series=True))) as bench:
        found = bench.run(tasks)
        bench.run(tasks)
        assert Falling.opened == 1
    assert Falling.opened == 0

    def row(case: int, what: str, status: str, ended_at: float, reason: str, run_time: float) -> Row:
        figures = {"y.min": 0.0, "y.max": 2.0, "y.final": 2.0} if status == "ended" else {}
        return Row(case, f"key{case}", "falling", {"what": what}, status, ended_at, reason, figures, run_time)

    assert found.rows[0] == row(1, "ends", "ended", 2.0, "", 0.25)
    raised = found.rows[1]
    assert (raised.status, raised.reason) == ("failed", "ZeroDivisionError: division by zero")
    assert found.rows[2] == row(3, "fails", "failed", 1.0, "it broke in two", 0.25)
    assert found.rows[3] == row(4, "never starts", "failed", 0.0, "it broke in two", 0.25)
    assert [(series.case, series.times.tolist()) for series in found.series] == [(1, [0.0, 1.0, 2.0]), (3, [0.0, 1.0])]


def test_figures_are_those_of_the_run(tmp_path: Path) -> None:
    path = build_fmu(small_scene("load"), tmp_path / "load.fmu")
    package = ScenePackage("load", path.read_bytes(), "cs", 1.0, None, None)
    with closing(package.open()) as subject:
        column = [output.name for output in subject.outputs].index("y_c")
    with closing(Bench(job([package], Plan({"y_c": column}, [], 3.0)), tmp_path)) as bench:
        (row,) = bench.run([Task(1, "", "load", {"Cd": 2.0})]).rows
    y = simulate(small_scene("load"), stop_time=1.0, parameters={"M_1": 700.0, "Cd": 2.0})["y_c"].values
    assert row.figures == {"y_c.min": y.min(), "y_c.max": y.max(), "y_c.final": y[-1]}
    assert row.ended_at == 1.0
    assert not list(tmp_path.glob("cablefmu-*"))


def test_a_worker_of_another_version_is_refused() -> None:
    with pytest.raises(RuntimeError, match=r"cablefmu .* is installed there; 99\.0 is expected"):
        OpensOnce(job([], Plan({}, [], 3.0)), version="99.0").setup(None)
