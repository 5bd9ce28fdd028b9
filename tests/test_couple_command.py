"""`cablefmu couple` and `couplings`: files, exit status 0, 1 and 2, and what is printed."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablefmu.coupling.description import load_coupling, shipped_couplings
from tests.test_cli import Command

SHORT = """
[coupling]
stop_time = 1
step = 0.1
algorithm = "gauss-seidel"
[[model]]
name = "cable"
scene = "free-12-water"
[[model]]
name = "plate"
partner = "spring"
parameters = { stiffness = 1500 }
inputs = { y_b = 0.1, v_a = 0, v_b = 0 }
[[connection]]
from = "cable.y_m1"
to = "plate.y_a"
[[connection]]
from = "plate.F_a"
to = "cable.u_m1"
"""
FAILING = (
    SHORT
    + """
[[model]]
name = "tug"
vessel = { kind = "csv", file = "motion.csv" }
"""
)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Every command runs in a folder of its own, with short.toml, and failing.toml, whose vessel's samples end."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(SHORT)
    (tmp_path / "failing.toml").write_text(FAILING)
    (tmp_path / "motion.csv").write_text("time,x,y\n" + "".join(f"{0.1 * k},0,{k % 2}\n" for k in range(6)))
    return tmp_path


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def test_what_ships_is_listed_and_printed(command: Command) -> None:
    listed = command("couplings").out.splitlines()
    assert [line.partition("  ")[0] for line in listed] == shipped_couplings()
    for name in shipped_couplings():
        assert command("couplings", name).out == load_coupling(name).text


def test_results_have_all_outputs_and_say_what_they_are(command: Command) -> None:
    assert command("couple", "short.toml").status == 0
    assert "gauss-seidel" in command.out and "results: build/short.csv" in command.out
    head, *rows = Path("build/short.csv").read_text().splitlines()
    assert head.split(",")[0] == "time" and {"cable.x_c", "plate.F_a"} <= set(head.split(","))
    assert len(rows) == 11 and rows[-1].startswith("1.0,")
    said = json.loads(Path("build/short.csv.json").read_text())
    assert said["coupling"] == SHORT and said["algorithm"] == "gauss-seidel"
    assert said["variables"]["plate.F_a"]["units"] == "N"


def test_netcdf_has_the_same_numbers(command: Command) -> None:
    command("couple", "short.toml", "-o", "a.nc")
    command("couple", "short.toml", "-o", "a.csv")
    with xr.open_dataset("a.nc", engine="scipy") as result:
        column = result["cable.x_c"].values
    table = np.genfromtxt("a.csv", delimiter=",", names=True, deletechars="")
    assert column.tolist() == table["cable.x_c"].tolist()


@pytest.mark.parametrize("name", shipped_couplings())
def test_what_ships_runs(name: str, command: Command) -> None:
    assert command("couple", name, "--stop-time", "2").status == 0
    assert "run time" in command.out
    assert command.out.count("power.") == len(load_coupling(name).spec.power)


def test_another_stop_time_and_a_picture(command: Command) -> None:
    assert command("couple", "short.toml", "--stop-time", "0.45", "--plot", "short.svg").status == 0
    assert "results: build/short.csv, picture: short.svg" in command.out
    times = [float(row.split(",")[0]) for row in Path("build/short.csv").read_text().splitlines()[1:]]
    assert times == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.45])
    assert Path("short.svg").read_text().startswith("<?xml")


@pytest.mark.parametrize("engine", ["libcosim", "fmpy-ssp"])
def test_other_engines_run_it(engine: str, command: Command) -> None:
    Path("jacobi.toml").write_text(SHORT.replace("gauss-seidel", "jacobi"))
    assert command("couple", "jacobi.toml", "--engine", engine).status == 0
    assert f"by {engine}" in command.out
    assert json.loads(Path("build/jacobi.csv.json").read_text())["engine"] == engine


def test_exports_run_nothing(command: Command) -> None:
    assert command("couple", "short.toml", "--ssp", "x.ssp", "--osp", "osp").status == 0
    assert command.out.splitlines() == ["x.ssp", str(Path("osp") / "OspSystemStructure.xml")]
    assert not Path("build/short.csv").exists()
    with zipfile.ZipFile(Path("osp") / "cable.fmu") as archive:  # for all machines
        assert {"win64", "linux64", "darwin64"} <= {name.split("/")[1] for name in archive.namelist() if "/" in name}


@pytest.mark.parametrize("more", ["", "adaptive = { tolerance = 0.1, smallest = 0.1, largest = 0.1 }"])
def test_a_failed_run_keeps_what_there_was(more: str, command: Command) -> None:
    """Also where the master holds states of the FMU that died."""
    Path("failing.toml").write_text(FAILING.replace("step = 0.1", f"step = 0.1\n{more}"))
    assert command("couple", "failing.toml").status == 1
    assert "the run ended at t = 0.5 s; the results up to then are kept." in command.err
    assert "model tug failed in its step from t = 0.5 s: " in command.err
    assert len(Path("build/failing.csv").read_text().splitlines()) == 7
    assert "ended_early" in json.loads(Path("build/failing.csv.json").read_text())
    assert command("couple", "short.toml").status == 0  # an FMU that died takes nobody along


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["none.toml"], "none.toml: there is no such file"),
        (["wave-and-plat"], 'no coupling "wave-and-plat" ships; the nearest is "wave-and-plate"'),
        (["short.toml", "-o", "x.txt"], "output = x.txt: a name that ends with .csv or .nc is expected"),
        (["short.toml", "--ssp", "x.zip"], "ssp = x.zip: a name that ends with .ssp is expected"),
        (["short.toml", "--ssp", "x.ssp", "-o", "x.csv"], "ssp, osp: nothing is run; leave --output, --engine,"),
        (["short.toml", "--stop-time", "0"], "stop time = 0: a number above 0 [s] is expected"),
        (["short.toml", "--plot", "x.doc"], "plot = x.doc: a name that ends with one of"),
        (["short.toml", "--engine", "libcosim"], 'engine = libcosim: algorithm = "gauss-seidel" is not in it'),
        (["short.toml", "--engine", "other"], "other"),
    ],
)
def test_mistakes_end_with_status_2(arguments: list[str], said: str, command: Command) -> None:
    assert command("couple", *arguments).status == 2
    assert said in command.err and "Traceback" not in command.err
