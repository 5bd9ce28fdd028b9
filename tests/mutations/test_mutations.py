"""Tests that would let a wrong kernel pass are no tests: defects planted in copies of the C sources are caught."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.mutations.defects import DEFECTS, GUARDS
from tests.mutations.run import Told, failures, package_of, rewritten, row_of, told_by_stress
from tests.sources import Change, changed_copy

PAGE = Path(__file__).parents[2] / "docs" / "mutations.md"


@pytest.mark.slow
def test_the_guards_pass_on_a_copy_without_defects(tmp_path: Path) -> None:
    assert failures(changed_copy(tmp_path, [])) == set()


@pytest.mark.slow
@pytest.mark.parametrize("name", DEFECTS)
def test_a_planted_defect_is_caught(tmp_path: Path, name: str) -> None:
    """By every guard that the table of docs/mutations.md names, and so by one at least."""
    defect = DEFECTS[name]
    assert defect.caught_by
    caught = failures(changed_copy(tmp_path, defect.changes), defect.caught_by)
    assert caught == set(defect.caught_by)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name, defect in DEFECTS.items() if defect.stress])
def test_stress_alone_catches_it(tmp_path: Path, name: str) -> None:
    """Its references share the defect, but the dense equation, the energy balance and what was once measured do not."""
    defect = DEFECTS[name]
    package = package_of(changed_copy(tmp_path / "sources", defect.changes), tmp_path / "package")
    assert told_by_stress(package, "--only", defect.stress).caught


def test_changes_fit_the_sources(tmp_path: Path) -> None:
    """Each text stands there once; this needs no compiler and fails as soon as the sources move on."""
    for number, defect in enumerate(DEFECTS.values()):
        changed_copy(tmp_path / str(number), defect.changes)
    with pytest.raises(ValueError, match=r"water\.c has 0 times"):
        changed_copy(tmp_path / "none", [Change("water.c", "not in there", "")])


def test_the_page_lists_every_defect_with_what_catches_it() -> None:
    row = r"^\| \*\*(.+?)\*\*: (.+?) \| (.+?) \| (.+?) \| (.+?) \|$"
    rows = re.findall(row, PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert [cells[:3] for cells in rows] == [(n, d.what, ", ".join(d.caught_by)) for n, d in DEFECTS.items()]
    assert all(cells[4].startswith("no: ") is False for cells in rows), "stress catches all of them"
    named = dict(re.findall(r"^\| (.+?) \| `(.+?)` \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    assert named == GUARDS


def test_the_table_is_written_anew_and_nothing_else() -> None:
    page = PAGE.read_text(encoding="utf-8")
    told = Told(True, "1 of 2 cases; a|b\nwrong")
    rows = [row_of(name, defect, told, Told(False, "no: nothing")) for name, defect in DEFECTS.items()]
    again = rewritten(page, rows)
    assert all(row in again.splitlines() for row in rows) and rows[0].endswith(
        "| no: nothing | 1 of 2 cases; a/b wrong |"
    )
    kept = [line for line in page.splitlines() if not line.startswith("| **")]
    assert [line for line in again.splitlines() if not line.startswith("| **")] == kept
