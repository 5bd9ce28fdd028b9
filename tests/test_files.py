"""A file is replaced by a complete one or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from cablefmu.errors import OptionError
from cablefmu.files import check_writable, replacing


def test_the_old_file_stays_until_the_new_one_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "results.csv"
    path.write_text("old")
    with replacing(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "results.csv"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError), replacing(path) as temporary:
        temporary.write_text("half of it, then \udcff", encoding="utf-8")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_is_said_in_words(tmp_path: Path) -> None:
    path = tmp_path / "results.csv"
    with (
        pytest.raises(OptionError, match=r"results.csv: cannot be written \(No space left on device\)"),
        replacing(path),
    ):
        Path("/dev/full").write_text("x")
    assert list(tmp_path.iterdir()) == []


def test_missing_folders_are_made(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "x.csv"
    with replacing(path) as temporary:
        temporary.write_text("x")
    assert path.read_text() == "x"


def test_a_new_file_has_the_usual_rights(tmp_path: Path) -> None:
    usual = tmp_path / "usual"
    usual.touch()
    with replacing(tmp_path / "x") as temporary:
        temporary.touch()
    assert (tmp_path / "x").stat().st_mode == usual.stat().st_mode


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for path, says in (
        (tmp_path, "is a folder, a file name is expected"),
        (tmp_path / "file" / "x.csv", "cannot be written"),
        (tmp_path / ("x" * 300 + "/y"), "cannot be written"),
    ):
        with pytest.raises(OptionError, match=says):
            check_writable(path)
        with pytest.raises(OptionError, match=says), replacing(path):
            pass
    with pytest.raises(OptionError, match="File name too long"), replacing(tmp_path / ("x" * 300)):
        pass
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
