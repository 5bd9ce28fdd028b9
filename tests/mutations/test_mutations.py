"""Tests that would let a wrong kernel pass are no tests: defects planted in copies of the C sources are caught."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.mutations.defects import DEFECTS, GUARDS
from tests.mutations.run import failures
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


def test_changes_fit_the_sources(tmp_path: Path) -> None:
    """Each text stands there once; this needs no compiler and fails as soon as the sources move on."""
    for number, defect in enumerate(DEFECTS.values()):
        changed_copy(tmp_path / str(number), defect.changes)
    with pytest.raises(ValueError, match=r"water\.c has 0 times"):
        changed_copy(tmp_path / "none", [Change("water.c", "not in there", "")])


def test_the_page_lists_every_defect_with_what_catches_it() -> None:
    rows = re.findall(r"^\| \*\*(.+?)\*\*: (.+?) \| (.+?) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert rows == [(name, defect.what, ", ".join(defect.caught_by)) for name, defect in DEFECTS.items()]
    named = dict(re.findall(r"^\| (.+?) \| `(.+?)` \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    assert named == GUARDS
