"""Every host does what docs/hosts.md says, and the README says the same.

Those marked hosts install importers from PyPI, each in an environment of its own; `.ci/run` runs them.
"""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from cablefmu.fmu.archive import build_fmu
from cablefmu.scene import load_scene
from tests.hosts.catalogue import CO_SIMULATION, HOSTS, SCENES, WAYS, Way, ways_of
from tests.hosts.environments import INSIDE, requirements
from tests.hosts.expected import start_and_end
from tests.hosts.runs import Outcome, ask, outcomes
from tests.hosts.table import FAILS, page, readme, row_of, rows_in, short

ROOT = Path(__file__).parents[2]
PAGE = rows_in((ROOT / "docs" / "hosts.md").read_text("utf-8"))
ANEW = "python -m tests.hosts --markdown docs/hosts.md --readme README.md"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fmus")


@pytest.mark.hosts
@pytest.mark.parametrize("way", WAYS, ids=lambda way: f"{way.host}-{way.fmi}-{way.interface}")
def test_host_does_what_the_page_says(way: Way, built: Path) -> None:
    measured = row_of(way, outcomes(way, built))
    assert FAILS not in measured.result
    said = [row for row in PAGE if replace(row, ends=measured.ends) == measured]
    assert len(said) == 1, f"docs/hosts.md is stale: {ANEW}"
    assert [end == "–" for end in said[0].ends] == [end == "–" for end in measured.ends]


@pytest.mark.hosts
@pytest.mark.parametrize("scene", SCENES)
def test_the_end_is_more_than_a_metre_from_the_start(scene: str) -> None:
    start, end = start_and_end(scene)
    assert max(abs(end[name] - start[name]) for name in start) > 1.0


@pytest.mark.hosts
def test_the_checkers_see_a_description_that_is_wrong(tmp_path: Path) -> None:
    good, bad = build_fmu(load_scene(SCENES[0]), tmp_path / "good.fmu"), tmp_path / "bad.fmu"
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(bad, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename == "modelDescription.xml":
                content = content.replace(b'causality="input"', b'causality="inlet"')
            target.writestr(entry, content)
    said = ask("toolbox_host", {"interface": "check", "fmu": str(bad), "fmi": 2})
    assert any("inlet" in complaint for complaint in said["complaints"])


def test_the_readme_has_the_table_of_the_page() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert readme(text, PAGE) == text, f"README.md is stale: {ANEW}"


def test_the_page_has_every_way_in_the_versions_asked_for_and_no_other_text() -> None:
    asked = [(HOSTS[way.host], _version(way.host), str(way.fmi), way.interface) for way in WAYS]
    assert [(row.host, row.version, row.fmi, row.interface) for row in PAGE] == asked, f"docs/hosts.md is stale: {ANEW}"
    assert page(PAGE) == (ROOT / "docs" / "hosts.md").read_text("utf-8")
    assert not any(FAILS in row.result for row in PAGE)


def test_every_host_has_a_script_a_list_and_a_way() -> None:
    assert {path.stem for path in INSIDE.glob("*.txt")} == set(HOSTS)
    assert {path.stem for path in INSIDE.glob("*.py")} == {*HOSTS, "exchange"}
    assert all(ways_of(host) for host in HOSTS)


@pytest.mark.parametrize(
    ("error", "said", "result"),
    [
        (1e-6, "", "within 1e-5 m"),
        (2e-5, "", f"{FAILS}heave-60-water: 2e-5 instead of 1e-5"),
        (float("nan"), "", f"{FAILS}heave-60-water: nan instead of 1e-5"),
        (None, "Error: no", f"{FAILS}heave-60-water: Error: no"),
    ],
)
def test_one_bad_scene_fails_the_row(error: float | None, said: str, result: str) -> None:
    way = Way("fmpy_host", 2, "CS", {})
    good = [Outcome(scene, "1", 1e-8, CO_SIMULATION, "") for scene in SCENES[:2]]
    assert row_of(way, [*good, Outcome(SCENES[2], "1", error, CO_SIMULATION, said)]).result == result


def test_a_refusal_counts_only_in_the_words_expected_and_for_every_scene() -> None:
    way = Way("fmpy_host", 3, "CS", {}, refusal="no FMI 3", because="it has none")
    refused = [Outcome(scene, "1", None, CO_SIMULATION, "Error: no FMI 3 here") for scene in SCENES]
    assert row_of(way, refused).result == "refused: it has none"
    other = replace(refused[0], said="Error: no memory")
    assert row_of(way, [other, *refused[1:]]).result == f"{FAILS}{SCENES[0]}: Error: no memory"
    works = [replace(outcome, error=1e-8, said="") for outcome in refused]
    assert row_of(way, works).result == f"{FAILS}{SCENES[0]}: no longer refused"


def test_versions_of_fmi_with_one_result_share_a_line() -> None:
    rows = [row for row in PAGE if "FMPy" in row.host and row.interface == "CS"]
    assert [row.fmi for row in rows] == ["2", "3"]
    assert short(rows).count("\n") == 2
    assert "| 2, 3 | CS |" in short(rows)
    assert short([rows[0], replace(rows[1], result="other")]).count("\n") == 3


def _version(host: str) -> str:
    return requirements(host)[0].partition("==")[2]
