"""The name of the file says what becomes of results, from Python as well."""

from __future__ import annotations

from pathlib import Path

import pytest

import cablefmu
from cablefmu.errors import OptionError
from cablefmu.view.write import SUFFIXES, check_view
from tests.view.made import made_result


def test_results_become_what_the_name_says(tmp_path: Path) -> None:
    results = {"calm": made_result(times=3), "rough": made_result(times=3, lag=1.0)}
    page = cablefmu.write_view(results, tmp_path / "x.html")
    assert page == tmp_path / "x.html" and "<h1>calm and rough</h1>" in page.read_text(encoding="utf-8")
    movie = cablefmu.write_view({"calm": results["calm"]}, str(tmp_path / "x.gif"), speed=2.0)
    assert movie.read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_none_and_three_are_refused(tmp_path: Path, suffix: str) -> None:
    for results in ({}, dict.fromkeys("abc", made_result(times=2))):
        with pytest.raises(OptionError, match=f"not {len(results)}"):
            cablefmu.write_view(results, tmp_path / f"x{suffix}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["x", "x.png", "x.htm"])
def test_other_names_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(OptionError, match=r"a name that ends with \.html, \.gif or \.mp4 is expected"):
        check_view(tmp_path / name)
