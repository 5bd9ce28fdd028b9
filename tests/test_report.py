"""A whole report of a small scene: what it holds, its files, its page; and the command that makes it."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from lxml import html

from cablefmu import report_command, report_refinement
from cablefmu.cli import main
from cablefmu.errors import OptionError, RunError
from cablefmu.report import Report, check_options, made_on, make_report
from cablefmu.report_files import write_index, write_markdown, write_report
from cablefmu.report_ladder import PEERS, TOLERANCES
from cablefmu.report_runs import SOLVERS
from cablefmu.report_tables import overview, sheets
from tests.fmu_helpers import SCENES, small_scene

SHORT = SCENES["load"].replace("links = 5", "links = 12").replace("stop_time = 2", "stop_time = 1")
FEW = (12, 24, 48)


@pytest.fixture(scope="module")
def few_links() -> Iterator[None]:
    """Refinement with few links: this is about the report, not about convergence."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_refinement, "LINKS", FEW)
        original = report_refinement.refinement

        def fewer(*given: Any, **named: Any) -> Any:
            return original(*given, **{"numbers": FEW} | named)

        patch.setattr("cablefmu.report.refinement", fewer)
        yield


@pytest.fixture(scope="module")
def report(few_links: None) -> Report:
    return make_report(small_scene("load"), limit=20.0)


@pytest.fixture(scope="module")
def folder(report: Report, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("report")
    write_report(report, made)
    write_index([report, report], made)
    return made


# --- what it holds ---


def test_every_solver_is_measured_at_every_tolerance(report: Report) -> None:
    assert [(row.solver, row.tolerance) for row in report.ladder] == [
        (solver, tolerance) for solver in (*SOLVERS, *PEERS) for tolerance in TOLERANCES
    ]
    assert all(row.error is not None for row in report.ladder)


def test_the_default_setting_keeps_its_promise_and_is_in_the_ladder(report: Report) -> None:
    default = report.default
    assert (default.solver, default.tolerance, default.step) == ("automatic", 1e-6, report.scene.step)
    assert default.error is not None and default.error.position < 1e-4


def test_the_recommended_setting_was_measured_and_nothing_cheaper_is_good(report: Report) -> None:
    best = report.recommended
    rows = [*report.ladder, *report.communication, *report.at_best_step]
    assert best in rows and best is not None and best.error is not None
    assert best.error.position <= report.accuracy
    for row in rows:
        if row.is_own and row.error is not None and row.error.position <= report.accuracy:
            assert row.cpu_time >= best.cpu_time / 1.1 - 1e-12


@pytest.mark.parametrize(
    ("accuracy", "limit"), [(0.0, 1.0), (1e-7, 1.0), (math.nan, 1.0), (1e-4, 0.0), (1e-4, math.nan)]
)
def test_numbers_that_make_no_sense_are_refused(accuracy: float, limit: float) -> None:
    with pytest.raises(OptionError, match="is expected"):
        check_options(accuracy, limit)


def test_versions_and_machine_are_told() -> None:
    assert re.match(
        r"cablefmu [\d.]+, fmpy [\d.]+, numpy [\d.]+, scipy [\d.]+, Python 3\.\d+\.\d+; .+ cores, \w+$", made_on()
    )


# --- files ---


def finite(data: Any) -> bool:
    if isinstance(data, dict):
        return all(map(finite, data.values()))
    if isinstance(data, list):
        return all(map(finite, data))
    return not isinstance(data, float) or math.isfinite(data)


def test_json_holds_all_of_it_in_finite_numbers(report: Report, folder: Path) -> None:
    data = json.loads((folder / "load.report.json").read_text())
    assert finite(data)
    assert len(data["ladder"]) == len(report.ladder) == 56
    assert data["default"]["error"]["position"] == report.default.error.position  # type: ignore[union-attr]
    assert data["reference"]["is_independent"] is True
    assert data["horizon"] == {"time_s": 2.0, "is_chaotic": False, "growth_m": data["horizon"]["growth_m"]}
    assert [step["links"] for step in data["refinement"]["steps"]] == [12, 24]


def test_csv_has_a_line_per_run(report: Report, folder: Path) -> None:
    lines = list(csv.DictReader((folder / "load.report.csv").read_text().splitlines()))
    parts = [line["part"] for line in lines]
    assert parts.count("ladder") == 56
    assert parts.count("communication") == len(report.communication) == 20
    assert parts.count("refinement") == 2
    first = report.ladder[0]
    assert first.error is not None
    assert (lines[0]["solver"], float(lines[0]["position"]), int(lines[0]["rhs"])) == (
        "explicit", first.error.position, first.rhs,
    )  # fmt: skip


# --- the page ---


@pytest.mark.parametrize("name", ["load.report.html", "index.html"])
def test_a_page_needs_nothing_but_itself(name: str, folder: Path) -> None:
    text = (folder / name).read_text(encoding="utf-8")
    page = html.document_fromstring(text)
    assert page.xpath("//script | //link | //img | //iframe | //object") == []
    # the names of XML's vocabularies are addresses in form only
    assert {*re.findall(r"\w+://[^\"'\s<>]+", text)} <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    assert "@import" not in text
    assert {*re.findall(r"url\((.)", text)} <= {"#"}
    assert all(
        target.startswith("#") or (folder / target).is_file()
        for target in page.xpath("//@href | //@*[name()='xlink:href']")
    )


def test_its_figures_are_in_it(folder: Path) -> None:
    text = (folder / "load.report.html").read_text(encoding="utf-8")
    page = html.document_fromstring(text)
    drawn = page.xpath("//figure/svg")
    assert len(drawn) == 7
    assert all(len(figure.xpath(".//path")) > 20 for figure in drawn)
    ids = page.xpath("//@id")
    assert len(ids) == len(set(ids)) > 100
    used = {*re.findall(r'(?:href="|url\()#([^")]+)', text)}
    assert used <= set(ids)


def test_its_tables_say_what_was_measured(report: Report, folder: Path) -> None:
    page = html.document_fromstring((folder / "load.report.html").read_text(encoding="utf-8"))
    tables = page.xpath("//table")
    assert [len(table.xpath("./tbody/tr")) for table in tables] == [len(sheet.rows) for sheet in sheets(report)]
    assert "the dense NumPy model" in tables[0].text_content()


def test_a_name_cannot_break_the_page(report: Report) -> None:
    from dataclasses import replace

    from cablefmu.report_page import page

    spec = report.scene.spec.model_copy(update={"description": "<script>alert(1)</script> & more"})
    document = html.document_fromstring(page(replace(report, scene=replace(report.scene, spec=spec))))
    assert document.xpath("//script") == []
    assert "<script>alert(1)</script> & more" in document.text_content()


def test_markdown_is_a_table_that_says_how_it_was_made(report: Report, tmp_path: Path) -> None:
    write_markdown([report, report], tmp_path / "all.md", "cablefmu report --all")
    text = (tmp_path / "all.md").read_text()
    lines = [line for line in text.splitlines() if line.startswith("|")]
    assert len(lines) == 4
    assert len({line.count("|") for line in lines}) == 1
    assert len(overview([report]).head) == len(overview([report]).rows[0])
    assert "Made by `cablefmu report --all`" in text and made_on() in text


# --- the command ---


class Ended(Exception):  # noqa: N818
    """With its exit status."""


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Any]:
    """`cablefmu report ...` in a folder of its own: exit status, what it printed, and its errors."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(SHORT)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "short.toml").write_text(SHORT)

    def run(*arguments: str) -> tuple[int, str, str]:
        status = 0
        try:
            main(("report", *arguments))
        except SystemExit as end:
            status = int(end.code or 0)
        return status, *capsys.readouterr()

    return run


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "names of scenes are expected, or --all"),
        (("--all", "short.toml"), "and not both"),
        (("nosuch",), 'no scene "nosuch" ships'),
        (("short.toml", "nosuch.toml"), "there is no such file"),
        (("short.toml", "other/short.toml"), "scene short: it was named before"),
        (("short.toml", "--accuracy", "0"), "accuracy = 0"),
        (("short.toml", "--limit", "-1"), "limit = -1"),
        (("short.toml", "--limit", "soon"), "soon"),
        (("short.toml", "-o", "short.toml"), "cannot be written"),
        (("short.toml", "--markdown", "other"), "is a folder"),
    ],
)
def test_a_mistake_is_refused_before_anything_is_run(
    arguments: tuple[str, ...], words: str, command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report_command, "make_report", lambda *given, **named: pytest.fail("it was run"))
    status, out, err = command(*arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


def test_without_matplotlib_it_is_said_what_to_install(
    command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    status, _, err = command("short.toml")
    assert status == 2
    assert "pip install 'cablefmu[plot]'" in err


def test_a_real_run_leaves_its_files_and_a_table(command: Callable[..., Any], few_links: None, tmp_path: Path) -> None:
    status, out, err = command("short.toml", "--limit", "20", "--no-peers", "--markdown", "all.md")
    assert (status, err) == (0, "")
    made = tmp_path / "build" / "report"
    assert {path.name for path in made.iterdir()} == {f"short.report.{kind}" for kind in ("json", "csv", "html")}
    for words in ("What it says", "Error against price", "Communication step", "Number of links", "automatic"):
        assert words in out
    assert "LSODA" not in out
    asked = "cablefmu report short.toml --limit 20 --no-peers --markdown all.md"
    assert asked in (tmp_path / "all.md").read_text()


def test_a_scene_without_a_reference_does_not_keep_others_from_theirs(
    command: Callable[..., Any], report: Report, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def fails_once(scene: Any, **named: Any) -> Report:
        if scene.name == "free-12-air":
            raise RunError("free-12-air: no reference")
        return report

    monkeypatch.setattr(report_command, "make_report", fails_once)
    status, out, err = command("free-12-air", "short.toml", "-o", "here")
    assert status == 1
    assert "free-12-air: no reference" in err
    assert (tmp_path / "here" / "load.report.html").is_file()
    assert "position" in out
