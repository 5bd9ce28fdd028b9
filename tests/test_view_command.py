"""`cablefmu view` as it is typed."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from cablefmu.cli import main
from cablefmu.results import write_results
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene
from tests.view.made import made_result


def run(*arguments: str | Path) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["view", *map(str, arguments)])
    return int(ended.value.code or 0)


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with two results."""
    write_results(made_result(times=5), tmp_path / "calm.nc")
    write_results(made_result(times=5, lag=1.0), tmp_path / "rough.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_result_becomes_a_page_in_build(kept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("calm.nc") == 0
    page = kept / "build" / "calm.view.html"
    assert "<h1>calm</h1>" in page.read_text(encoding="utf-8")
    assert capsys.readouterr().out == f"build/calm.view.html, {page.stat().st_size / 1e6:.2f} MB\n"


def test_two_results_become_one_page(kept: Path) -> None:
    assert run("calm.nc", "rough.csv") == 0
    assert "<h1>calm and rough</h1>" in (kept / "build" / "calm-rough.view.html").read_text(encoding="utf-8")
    write_results(made_result(times=5), kept / "other" / "calm.nc")
    assert run("calm.nc", "other/calm.nc", "-o", "both.html") == 0
    assert "<h1>calm.nc and other/calm.nc</h1>" in (kept / "both.html").read_text(encoding="utf-8")
    assert run("calm.nc", "calm.nc", "-o", "same.html") == 0
    assert "<h1>calm.nc (1) and calm.nc (2)</h1>" in (kept / "same.html").read_text(encoding="utf-8")


def test_a_result_becomes_a_movie(kept: Path) -> None:
    assert run("calm.nc", "-o", "x.gif", "--speed", "2") == 0
    assert (kept / "x.gif").read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_what_a_run_wrote_is_shown(kept: Path, suffix: str) -> None:
    result: xr.Dataset = simulate(small_scene("load"), stop_time=0.5, record=["nodes", "tensions"])
    write_results(result, kept / f"mine{suffix}")
    assert run(f"mine{suffix}") == 0
    page = (kept / "build" / "mine.view.html").read_text(encoding="utf-8")
    assert 'id="value-tension_max-0"' in page and 'id="colours" checked' in page


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["mine.toml"], "mine.toml: a name that ends with .csv or .nc"),
        (["calm.nc", "-o", "x.png"], "output = x.png: a name that ends with .html, .gif or .mp4 is expected"),
        (["none.nc"], "none.nc: "),
        (["none.csv"], "none.csv: "),
        (["text.csv"], "text.csv: "),
        (["text.nc"], "text.nc: "),
        (["calm.nc", "-o", "x.gif", "--speed", "-1"], "speed = -1.0: a positive number is expected"),
    ],
)
def test_mistakes_are_told_in_a_sentence(
    kept: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    for name in ("text.csv", "text.nc"):
        (kept / name).write_text("no result\n", encoding="utf-8")
    assert run(*arguments) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"cablefmu: {message}") and "Traceback" not in said


def test_a_result_without_places_says_how_to_record_them(kept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_results(simulate(small_scene("load"), stop_time=0.2), kept / "bare.nc")
    assert run("bare.nc") == 2
    assert "--record nodes tensions" in capsys.readouterr().err
