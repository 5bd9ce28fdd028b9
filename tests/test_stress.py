"""The command `cablefmu stress`: its short subset for real, its options, its exit status."""

from __future__ import annotations

import json
import resource
import tomllib
from pathlib import Path

import pytest

from cablefmu import stress
from cablefmu.scene import Scene
from cablefmu.stress_baseline import Measured, baseline
from cablefmu.stress_grid import Case, grid
from cablefmu.stress_verdict import Row
from tests.test_cli import Command, command  # noqa: F401  (a fixture)
from tests.test_stress_run import Killed, case_of

SHORT_LIMIT = 60.0
"""[s] of processor time, and so of time on a machine that does nothing else."""


def processor_time() -> float:
    """What ended child processes have used [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_the_short_subset_passes_within_a_minute(command: Command) -> None:  # noqa: F811
    began = processor_time()
    told = command("stress", "--short")
    assert (told.status, told.err) == (0, "")
    assert 0.0 < processor_time() - began < SHORT_LIMIT
    lines = told.out.splitlines()
    short = [case.name for case in grid() if case.short]
    assert [line.split()[0] for line in lines[1:-2]] == short and len(short) >= 12
    assert lines[-2] == f"{len(short)} cases: {len(short)} within tolerance"
    cases = json.loads(Path("build/stress/stress.json").read_text())["cases"]
    assert {case["solver"] for case in cases} >= {"explicit", "implicit"}
    assert Path("build/stress/stress.csv").exists() and Path("build/stress/stress.html").exists()


def test_a_case_is_printed_as_a_scene(command: Command) -> None:  # noqa: F811
    text = command("stress", "--show", "links-2").out
    assert tomllib.loads(text)["cable"]["links"] == 2
    assert Scene.from_text(text, name="mine").cable.n == 2


def test_what_failed_is_named_and_the_status_is_1(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: F811
    monkeypatch.setattr(stress, "judge", lambda case, *_: Row(case, "wrong" if case.name == "links-2" else "hang"))
    told = command("stress", "--only", "links-[23]", "--jobs", "1")
    assert told.status == 1
    assert told.err == "cablefmu: 2 of 2 cases failed: links-2, links-3\n"
    assert json.loads(Path("build/stress/stress.json").read_text())["cases"][1]["verdict"] == "hang"


def test_a_worker_that_is_killed_costs_its_case_alone() -> None:
    cases = [case_of("cable.links = 2", kind) for kind in (Case, Killed, Case)]
    rows = list(stress.rows_of(cases, 1, {}))
    assert [row.verdict for row in rows] == ["within tolerance", "crash", "within tolerance"]
    assert rows[1].message.startswith("the worker died: killed by SIGKILL")


def test_a_mistake_of_the_verdict_costs_its_case_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def judge(case: Case, *_: object) -> Row:
        if case.name == "links-2":
            raise ZeroDivisionError
        return Row(case, "within tolerance")

    monkeypatch.setattr(stress, "judge", judge)
    rows = list(stress.rows_of([case for case in grid() if case.name in ("links-2", "links-3")], 2, {}))
    assert [row.verdict for row in rows] == ["crash", "within tolerance"]
    assert "ZeroDivisionError" in rows[0].message


def test_what_the_whole_grid_measured_is_written(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: F811
    asked: dict[str, Measured | None] = {}  # cases are judged side by side, in no order

    def judge(case: Case, _ask: object, _folder: object, measured: Measured | None) -> Row:
        asked[case.name] = measured
        return (
            Row(case, "clean error")
            if case.fails
            else Row(case, "within tolerance", figures={"steps": 7.0}, ratio=2e-3, energy=3e-4)
        )

    monkeypatch.setattr(stress, "judge", judge)
    assert command("stress", "--record", "measured.csv").status == 0
    names = [case.name for case in grid() if not case.fails]
    lines = Path("measured.csv").read_text(encoding="utf-8").splitlines()
    assert lines == ["case,position,energy,steps", *(f"{name},2.0e-03,3.0e-04,7" for name in names)]
    assert set(asked.values()) == {None}, "compared with nothing measured"
    assert command("stress", "--short").status == 0
    assert asked["equilibrium-pin"] == baseline()["equilibrium-pin"]


def test_a_group_and_a_pattern_choose_cases(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: F811
    monkeypatch.setattr(stress, "judge", lambda case, *_: Row(case, "within tolerance"))
    group = [case.name for case in grid() if case.group == "step"]
    for options in (["step"], ["step-*"]):
        lines = command("stress", "--only", *options).out.splitlines()
        assert [line.split()[0] for line in lines[1:-2]] == group


def test_the_table_of_the_whole_grid_is_written(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: F811
    monkeypatch.setattr(stress, "judge", lambda case, *_: Row(case, "within tolerance"))
    assert command("stress", "--markdown", "docs/table.md").status == 0
    text = Path("docs/table.md").read_text()
    assert all(f"| {case.name.removeprefix(case.group + '-')} |" in text for case in grid())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--only", "nonsense"],
            "only nonsense: no case matches; 'links-*' would be a pattern; groups: shipped,",
        ),
        (["--show", "link-2"], "show link-2: there is no such case; did you mean links-2"),
        (["--show", "links-2", "--short"], "show: it goes with no other option"),
        (["--markdown", "table.md", "--short"], "markdown: the table is that of the whole grid"),
        (["--record", "table.csv", "--only", "links"], "record: the table is that of the whole grid"),
        (["--record", "table.md"], "record = table.md: a name that ends with .csv is expected"),
        (["--markdown", "table.txt"], "markdown = table.txt: a name that ends with .md is expected"),
        (["--jobs", "0"], "jobs = 0: 1 to 256 are expected"),
        (["--nonsense"], "Unknown option: "),
    ],
)
def test_wrong_options_are_refused(options: list[str], message: str, command: Command) -> None:  # noqa: F811
    told = command("stress", *options)
    assert told.status == 2 and told.out == ""
    assert told.err.startswith(f"cablefmu: {message}")


def test_the_committed_table_is_that_of_this_grid() -> None:
    text = (Path(__file__).parents[1] / "docs" / "stress" / "README.md").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| ") and not line.startswith("| case |")]
    assert len(rows) == len(grid())
    for row, case in zip(rows, grid(), strict=True):
        assert row.startswith(f"| {case.name.removeprefix(case.group + '-')} | {case.base}")
        assert (": " + case.changed if case.changed else "").replace("|", "\\|") + " |" in row
        assert row.split(" | ")[-1].startswith("clean error" if case.fails else "within tolerance")
