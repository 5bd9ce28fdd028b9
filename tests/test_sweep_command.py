"""`cablefmu sweep`: options and files, what is left, going on, refusals; tests/sweeping has the cluster."""

from __future__ import annotations

import csv
import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from cablefmu.cli import main
from cablefmu.simulate import simulate
from cablefmu.sweeping import open_sweep, sweep
from tests.fmu_helpers import SCENES


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own, with two scenes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "load.toml").write_text(SCENES["load"])
    (tmp_path / "pin.toml").write_text(SCENES["pin"])
    return tmp_path


def command(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """Status, output, errors; everything in this process."""
    status = 0
    try:
        main(["sweep", *arguments])
    except SystemExit as end:
        status = int(end.code or 0)
    out, err = capsys.readouterr()
    return status, out, err


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def without_times(path: Path) -> list[str]:
    """Lines of a table but for the run time, its last column."""
    return [line.rpartition(",")[0] for line in path.read_text().splitlines()]


GRID = ("load.toml", "--grid", "M_1=600,900", "Cd=1,2", "--stop-time", "1", "--workers", "0")


def test_a_row_is_what_the_run_alone_gives(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    status, out, err = command(capsys, *GRID)
    assert (status, err) == (0, "")
    assert "load: 4 cases" in out
    table = rows(here / "build" / "load.sweep" / "cases.csv")
    assert [(row["M_1"], row["Cd"]) for row in table] == [
        ("600.0", "1.0"), ("600.0", "2.0"), ("900.0", "1.0"), ("900.0", "2.0")
    ]  # fmt: skip
    alone = simulate("load.toml", stop_time=1.0, parameters={"M_1": 900.0, "Cd": 1.0})
    for name in ("x_c", "tension_max", "energy"):
        values = alone[name].values
        assert float(table[2][f"{name}.max"]) == values.max()
        assert float(table[2][f"{name}.min"]) == values.min()
        assert float(table[2][f"{name}.final"]) == values[-1]
    about = json.loads((here / "build" / "load.sweep" / "cases.csv.json").read_text())["variables"]
    assert about["tension_max.equivalent"]["units"] == "N"
    assert about["y_c.max"] == {"units": "m", "long_name": "y_c: Largest over the output times"}
    result = open_sweep("build/load.sweep")
    assert result["x_c.max"].values.tolist() == [float(row["x_c.max"]) for row in table]
    assert rows(here / "build" / "load.sweep" / "summary.csv")[0]["cases"] == "4"


def test_it_goes_on_where_it_was_interrupted(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    """Without one file, or with one torn in the middle, its cases alone are run again, and the table is the same."""
    command(capsys, *GRID)
    folder = here / "build" / "load.sweep"
    before = without_times(folder / "cases.csv")
    for spoil in (Path.unlink, lambda path: path.write_bytes(path.read_bytes()[:100])):
        *others, last = sorted((folder / "parts").iterdir())
        kept = {path: path.read_bytes() for path in others}
        spoil(last)
        (folder / "cases.csv").unlink()
        status, _, err = command(capsys, *GRID)
        assert (status, err) == (0, f"load: {int(last.stem) - 1} of 4 cases are finished already\n")
        assert without_times(folder / "cases.csv") == before
        assert {path: path.read_bytes() for path in others} == kept
    assert command(capsys, *GRID)[2] == "load: 4 of 4 cases are finished already\n"
    assert command(capsys, *GRID, "--restart")[2] == ""


def test_a_case_that_fails_does_not_end_the_others(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    (here / "cases.csv").write_text("F_cx,M_1\n0,\n1e300,\n,900\n")
    status, out, err = command(capsys, "load.toml", "--list", "cases.csv", "--stop-time", "1", "--workers", "0")
    assert status == 1
    assert "1 of 3 cases failed, the first because: doStep ended at t = 0 s: " in err
    assert "load: 3 cases" in out
    ended, failed, other = rows(here / "build" / "load.sweep" / "cases.csv")
    assert (ended["status"], failed["status"], other["status"]) == ("ended", "failed", "ended")
    assert (ended["ended_at"], failed["ended_at"]) == ("1.0", "0.0")
    assert failed["reason"].endswith("the motion is too violent or the tolerance too tight")
    assert failed["x_c.max"] == failed["tension_top.equivalent"] == ""
    assert np.isnan(open_sweep("build/load.sweep")["x_c.max"].values).tolist() == [False, True, False]
    again = command(capsys, "load.toml", "--list", "cases.csv", "--stop-time", "1", "--workers", "0")
    assert again[0] == 1
    assert again[2].startswith("load: 3 of 3 cases are finished already")


def test_a_file_with_several_scenes_and_options_in_its_place(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    (here / "of").mkdir()
    (here / "of" / "both.toml").write_text(
        'scenes = ["../load.toml", "../pin.toml"]\n[run]\nstop_time = 9\n[set]\nCd = 1.5\n'
        '[grid]\nM_1 = [600]\n[statistics]\nslope = 5\noutputs = ["x_c", "y_m1"]\nfatigue = ["tension_top"]\n'
    )
    status, _, err = command(
        capsys, "of/both.toml", "--grid", "k_m1=1000,1200", "--stop-time", "0.5", "--workers", "0", "--keep-series",
        "--plot", "p.png", "--of", "x_c.final",
    )  # fmt: skip
    assert (status, err) == (0, "")
    assert (here / "p.png").read_bytes().startswith(b"\x89PNG")
    table = rows(here / "build" / "both.sweep" / "cases.csv")
    assert [row["scene"] for row in table] == ["../load.toml"] * 2 + ["../pin.toml"] * 2
    assert [row["k_m1"] for row in table] == ["1000.0", "1200.0"] * 2
    assert "M_1" not in table[0]
    assert {name for name in table[0] if "." in name} == {
        *(f"{name}.{what}" for name in ("x_c", "y_m1", "tension_top") for what in ("min", "max", "final")),
        "tension_top.equivalent",
    }  # fmt: skip
    alone = simulate("pin.toml", stop_time=0.5, parameters={"Cd": 1.5, "k_m1": 1200.0})
    assert float(table[3]["y_m1.min"]) == alone["y_m1"].values.min()
    import pyarrow.parquet as pq

    series = pq.read_table(here / "build" / "both.sweep" / "series")
    case = series["case"].to_numpy()
    assert set(case) == {1, 2, 3, 4}
    assert series["y_m1"].to_numpy()[case == 4].tolist() == alone["y_m1"].values.tolist()


def test_from_python(here: Path) -> None:
    seen: list[tuple[int, int, int]] = []
    result = sweep(
        {"scenes": ["load.toml"], "run": {"stop_time": 0.5}, "sample": {"count": 3, "ranges": {"M_1": [600, 900]}}},
        workers=0, output="out", progress=lambda *counts: seen.append(counts),
    )  # fmt: skip
    assert seen[:2] == [(0, 0, 3), (1, 0, 3)]
    assert seen[-1] == (3, 0, 3)
    assert result.sizes == {"case": 3}
    assert result["M_1"].values.min() >= 600.0
    assert result["x_c.max"].attrs == {"units": "m", "long_name": "x_c: Largest over the output times"}


@pytest.mark.parametrize(("arguments", "message"), [
    (["load.toml"], "sweep: nothing varies: grid, list or sample is expected, or several scenes"),
    ([], "a sweep file is expected, or scenes with --grid, --list or --sample"),
    (["load.toml", "--grid", "M_2=1,2"], "sweep: load.toml: set M_2: there is no such variable; did you mean M_1?"),
    (["load.toml", "--grid", "M_1=1,-2"], "sweep: load.toml: set M_1=-2.0: a number above 0 [kg] is expected"),
    (["load.toml", "--grid", "M_1="], "grid M_1=: NAME=VALUE,VALUE,... is expected"),
    (["load.toml", "--grid"], "grid: at least one value is expected behind it"),
    (["load.toml", "--sample", "M_1=1"], "sample M_1=1: NAME=LOW:HIGH is expected"),
    (["load.toml", "--sample", "M_1=-1:2", "--count", "2"], "set M_1=-"),
    (["load.toml", "--sample", "M_1=1:2"], "sweep: sample.count: this key is missing"),
    (["load.toml", "--grid", "M_1=1,2", "--set", "M_1"], "M_1: NAME=VALUE is expected"),
    (["load.toml", "--grid", "M_1=1,2", "--workers", "-1"], "workers = -1: 0 (this process) to 1024 are expected"),
    (["load.toml", "--grid", "M_1=1,2", "--workers", "1", "--scheduler", "tcp://a:1"], "one of them is expected"),
    (["load.toml", "--grid", "M_1=1,2", "--wait", "-1"], "wait = -1.0: a number of seconds"),
    (["load.toml", "--grid", "M_1=1,2", "--of", "x"], "of = x: it names what --plot FILE.png draws"),
    (["load.toml", "--grid", "M_1=1,2", "--stop-time", "-1"], "run.stop_time = -1.0: a time must be greater than 0"),
    (["load.toml", "--grid", "M_1=1,2", "-o", "load.toml"], "load.toml"),
    (["none.toml", "--grid", "M_1=1,2"], "none.toml: there is no such file"),
    (["vessel-and-hawser", "load.toml"], "a sweep of a coupling is of one alone"),
    (["s.toml", "load.toml"], "s.toml: a sweep file says itself what is run"),
    (["s.toml"], "s.toml: statistics.outputs: there is no output z_c"),
])  # fmt: skip
def test_mistakes_are_told_in_a_sentence(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str], here: Path
) -> None:
    (here / "s.toml").write_text('scenes = ["load.toml"]\n[grid]\nM_1 = [1]\n[statistics]\noutputs = ["z_c"]\n')
    status, out, err = command(capsys, *arguments)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert len(err.splitlines()) == 1
    assert not (here / "build").exists()


def test_another_sweep_s_folder_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    command(capsys, *GRID)
    for other, key in (
        (["load.toml", "--grid", "M_1=600,901", "Cd=1,2", "--stop-time", "1"], "list of cases"),
        (["load.toml", "--grid", "M_1=600,900", "--stop-time", "1"], "number of cases is 4 where 2"),
        (
            ["load.toml", "--grid", "M_1=600,900", "Cd=1,2", "--stop-time", "2"],
            "stop time of load.toml is 1.0 where 2.0",
        ),
        ([*GRID[:-2], "--slope", "4"], "[statistics]"),
        ([*GRID[:-2], "--fmi", "3"], "content of load.toml"),
    ):
        status, _, err = command(capsys, *other, "--workers", "0")
        assert status == 2
        assert f"build/load.sweep: holds another sweep, whose {key}" in err
        assert "--output names another folder, --restart begins anew" in err


@pytest.mark.parametrize("missing", ["distributed", "pyarrow", "rainflow"])
def test_what_is_not_installed_is_named(
    missing: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    present = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == missing else present(name))
    status, _, err = command(capsys, *GRID)
    assert (status, err) == (2, f"cablefmu: a sweep needs {missing}: pip install 'cablefmu[sweep]'\n")
