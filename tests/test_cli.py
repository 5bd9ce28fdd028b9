"""The command line: output formats, files, exit status 0, 1 and 2, and no traceback for either."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablefmu.cli import main
from cablefmu.provenance import version_text
from cablefmu.scene import load_scene, shipped_scenes
from tests.fmu_helpers import SCENES
from tests.test_bad_scenes import BAD, CSV, GOOD


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Every command runs in a folder of its own, which holds load.toml."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "load.toml").write_text(SCENES["load"])
    return tmp_path


class Command:
    """`cablefmu ...` in this process: its exit status and what it printed."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys
        self.status, self.out, self.err = 0, "", ""

    def __call__(self, *arguments: str) -> Command:
        try:
            main(arguments)
            self.status = 0
        except SystemExit as end:
            self.status = int(end.code or 0)
        self.out, self.err = self._capsys.readouterr()
        return self


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def test_an_interrupt_ends_it_with_130_and_a_word(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("cablefmu.cli.shipped_scenes", interrupted)
    command("scenes")
    assert (command.status, command.out, command.err) == (130, "", "cablefmu: interrupted\n")


# --- scenes, build, version ---


def test_scenes_are_listed_plainly(command: Command) -> None:
    listed = command("scenes").out.splitlines()
    assert listed == [f"{name}  {load_scene(name).description}" for name in shipped_scenes()]
    assert (command.status, command.err) == (0, "")


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_scene_is_printed_as_it_is(name: str, command: Command) -> None:
    shipped = resources.files("cablefmu") / "scenes" / f"{name}.toml"
    assert command("scenes", name).out == shipped.read_text(encoding="utf-8")


def test_the_version_is_told(command: Command) -> None:
    assert command("--version").out == version_text() + "\n"


@pytest.mark.parametrize(
    ("options", "file"),
    [
        ([], "build/load.fmu"),
        (["--fmi", "3"], "build/load-fmi3.fmu"),
        (["-o", "my/x.fmu"], "my/x.fmu"),
        (["--twin"], "build/load-twin.fmu"),
        (["--arrays"], "build/load-fmi3-arrays.fmu"),
        (["--arrays", "--fmi", "3"], "build/load-fmi3-arrays.fmu"),
    ],
)
def test_build_prints_where_it_built(options: list[str], file: str, command: Command) -> None:
    assert command("build", "load.toml", *options).out == f"{file}\n"
    assert Path(file).is_file()


# --- run ---


def test_a_run_leaves_fmu_results_and_a_table(command: Command) -> None:
    assert command("run", "load.toml").status == 0
    assert sorted(p.name for p in Path("build").iterdir()) == ["load.csv", "load.csv.json", "load.fmu"]
    assert "largest tension" in command.out
    assert command.out.endswith("results: build/load.csv\n")
    rows = np.genfromtxt("build/load.csv", delimiter=",", names=True)
    assert (rows["time"][0], rows["time"][-1], len(rows)) == (0.0, 2.0, 21)


def test_options_reach_the_run(command: Command) -> None:
    options = ["--fmi", "3", "--interface", "me", "--stop-time", "0.4", "--step", "0.2", "--tolerance", "1e-8"]
    command("run", "load.toml", *options, "--set", "m_c=70", "u_m1=5", "--record", "theta", "u_m1", "-o", "x.nc")
    assert (command.status, command.err) == (0, "")
    with xr.open_dataset("x.nc", engine="scipy", decode_times=False) as result:
        assert result["time"].values.tolist() == [0.0, 0.2, 0.4]
        assert result["theta"].shape == (3, 5)
        assert np.all(result["u_m1"] == 5.0)
        told = {key: result.attrs[key] for key in ("fmi", "interface", "tolerance", "set")}
    assert told == {"fmi": 3, "interface": "me", "tolerance": 1e-8, "set": "m_c=70.0 u_m1=5.0"}


@pytest.mark.parametrize("values", [["modes,stiffness", "theta[2]"], ["modes", "stiffness", "theta[2]"]])
def test_modes_and_stiffness_are_recorded_about_the_start(values: list[str], command: Command) -> None:
    command("run", "load.toml", "--stop-time", "0.4", "--set", "F_cx=200", "--record", *values, "-o", "x.csv")
    assert (command.status, command.err) == (0, "")
    assert "natural frequencies" in command.out
    assert command.out.endswith("results: x.csv, x.modes.csv, x.stiffness.csv\n")
    assert Path("x.modes.csv").read_text().startswith("mode,frequency,y_m1,theta[1],")
    assert len(Path("x.stiffness.csv").read_text().splitlines()) == 5
    assert Path("x.csv").read_text().splitlines()[0].endswith("theta[2]")


def test_a_straight_cable_has_no_end_stiffness_and_says_so(command: Command) -> None:
    assert command("run", "load.toml", "--record", "stiffness", "--set", "F_cx=0").status == 1
    assert "the cable is straight between its ends, and its links do not stretch" in command.err
    assert "Traceback" not in command.err


def test_a_solver_is_set_by_name(command: Command) -> None:
    command("run", "load.toml", "--stop-time", "0.4", "--set", "solver=implicit", "m_c=70", "-o", "x.csv")
    assert (command.status, command.err) == (0, "")
    assert json.loads(Path("x.csv.json").read_text())["set"] == "solver=implicit m_c=70.0"
    rows = np.genfromtxt("x.csv", delimiter=",", names=True, deletechars="")
    assert rows["solver.stiff"].tolist() == [0.0, 1.0, 1.0, 1.0, 1.0]


def test_an_fmu_runs_as_its_scene_does(command: Command) -> None:
    command("build", "load.toml", "-o", "moved.fmu")
    Path("load.toml").rename("other.toml")
    command("run", "moved.fmu", "-o", "a.csv")
    Path("other.toml").rename("load.toml")
    command("run", "load.toml", "-o", "b.csv")
    assert Path("a.csv").read_bytes() == Path("b.csv").read_bytes()


def test_an_edited_scene_is_built_anew(command: Command) -> None:
    command("run", "load.toml", "-o", "a.csv")
    Path("load.toml").write_text(SCENES["load"].replace("mass = 60\n", "mass = 90\n"))
    command("run", "load.toml", "-o", "b.csv")
    assert Path("a.csv").read_bytes() != Path("b.csv").read_bytes()


@pytest.mark.parametrize("record", [[], ["--record", "omega"], ["--record", "theta"]])
def test_a_picture_does_not_change_the_results(record: list[str], command: Command) -> None:
    command("run", "load.toml", "-o", "a.csv", *record)
    command("run", "load.toml", "-o", "b.csv", "--plot", "x.png", *record)
    assert command.out.endswith("results: b.csv, picture: x.png\n")
    assert Path("x.png").read_bytes().startswith(b"\x89PNG")
    assert Path("a.csv").read_bytes() == Path("b.csv").read_bytes()


def test_a_run_that_fails_ends_with_1_time_and_reason(command: Command) -> None:
    command("run", "load.toml", "--set", "F_cx=1e300")
    assert command.status == 1
    assert "the run ended at t = 0 s; the results up to then are kept." in command.err
    assert "the motion is too violent" in command.err
    assert len(Path("build/load.csv").read_text().splitlines()) == 2
    assert "too violent" in json.loads(Path("build/load.csv.json").read_text())["ended_early"]


# --- saved states ---


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_run_goes_on_from_where_it_was_saved(fmi: str, command: Command) -> None:
    options = ["run", "load.toml", "--record", "theta"]
    command(*options, "--fmi", fmi, "--set", "m_c=70", "-o", "whole.csv")
    command(*options, "--fmi", fmi, "--set", "m_c=70", "--stop-time", "0.7", "--save-state", "x.state", "-o", "a.csv")
    assert command.out.endswith("results: a.csv, state: x.state\n")
    command(*options, "--from-state", "x.state", "-o", "b.csv")
    assert (command.status, command.err) == (0, "")
    whole, first, second = (Path(name).read_text().splitlines() for name in ("whole.csv", "a.csv", "b.csv"))
    assert first == whole[: len(first)]
    assert second == [whole[0], *whole[len(first) - 1 :]]
    told = json.loads(Path("b.csv.json").read_text())
    assert (told["fmi"], told["set"]) == (int(fmi), "m_c=70.0"), "as in the saved run"


def test_a_state_replaces_its_own_file_and_nothing_else(command: Command) -> None:
    command("run", "load.toml", "--stop-time", "0.4", "--save-state", "x.state")
    old, names = Path("x.state").read_bytes(), sorted(p.name for p in Path().iterdir())
    command("run", "load.toml", "--stop-time", "0.8", "--from-state", "x.state", "--save-state", "x.state")
    assert command.status == 0
    assert Path("x.state").read_bytes() != old
    assert sorted(p.name for p in Path().iterdir()) == names
    kept = Path("x.state").read_bytes()
    command("run", "load.toml", "--from-state", "x.state", "--save-state", "x.state", "--set", "F_cx=1e300")
    assert command.status == 1
    assert "state:" not in command.out
    assert Path("x.state").read_bytes() == kept, "a run that failed has no state to go on from"


def test_one_fmu_runs_with_any_number_of_links(command: Command) -> None:
    fmu = command("build", "load.toml", "--arrays").out.strip()
    assert command("run", fmu, "--set", "n=9", "--record", "theta", "-o", "arrays.csv").status == 0
    scene = Path("load.toml").read_text().replace("links = 5", "links = 9")
    Path("nine.toml").write_text(scene)
    assert command("run", "nine.toml", "--fmi", "3", "--record", "theta", "-o", "scalars.csv").status == 0
    assert Path("arrays.csv").read_bytes() == Path("scalars.csv").read_bytes()
    saved = ["--save-state", "x.state", "--stop-time", "0.7", "-o", "start.csv"]
    assert command("run", fmu, "--set", "n=9", "--record", "theta", *saved).status == 0
    assert command("run", fmu, "--from-state", "x.state", "--record", "theta", "-o", "rest.csv").status == 0
    whole, start, rest = (Path(f"{name}.csv").read_text().splitlines() for name in ("arrays", "start", "rest"))
    assert (start, rest[1:]) == (whole[: len(start)], whole[len(start) - 1 :])
    assert command("run", fmu, "--set", "n=10001").status == 2
    assert "set n=10001.0: a whole number of links from 1 to 10000 is expected" in command.err


# --- mistakes ---

WRONG = {
    "commands and options": [
        (["frob"], 'Unknown command "frob"'),
        (["run"], 'parameter SCENE requires an argument'),
        (["run", "load.toml", "--colour", "red"], "Unknown option: --colour"),
        (["run", "load.toml", "--fmi", "4"], 'Invalid value "4" for --fmi. Choose from: 2, 3'),
        (["run", "load.toml", "--interface", "xx"], 'Invalid value "xx" for --interface'),
    ],
    "twins": [
        (["build", "load.toml", "--twin", "--fmi", "3"], "fmi = 3: a twin is an FMU of version 2"),
    ],
    "arrays": [
        (["build", "load.toml", "--arrays", "--fmi", "2"], "fmi = 2: FMI 2 has no arrays; version 3 is expected"),
        (["build", "load.toml", "--arrays", "--twin"], "arrays: a twin is an FMU of version 2, which has none"),
        (["build", "load.toml", "--arrays", "--twin", "--fmi", "3"], "fmi = 3: a twin is an FMU of version 2"),
        (["run", "load.toml", "--set", "n=7"], "set n: there is no such variable"),
    ],
    "scenes": [
        (["run", "free-12-watr"], 'no scene "free-12-watr" ships; the nearest is "free-12-water"'),
        (["scenes", "nothing"], 'no scene "nothing" ships'),
        (["build", "none.toml"], "none.toml: there is no such file"),
        (["build", "."], 'no scene "." ships'),
    ],
    "FMUs": [
        (["run", "none.fmu"], "none.fmu: there is no such file"),
        (["run", "foreign.fmu"], "foreign.fmu: is not an FMU"),
    ],
    "numbers": [
        (["run", "load.toml", "--stop-time", "soon"], 'unable to convert "soon" into float'),
        (["run", "load.toml", "--stop-time=-1"], "stop time = -1.0: a number above 0 [s] is expected"),
        (["run", "load.toml", "--step", "0"], "step = 0.0: a number above 0 [s] is expected"),
        (["run", "load.toml", "--tolerance", "nan"], "tolerance = nan: a number above 0 is expected"),
        (["run", "load.toml", "--step", "1e-9"], "more than 10,000,000 output times"),
    ],
    "assignments": [
        (["run", "load.toml", "--set", "m_c"], "set m_c: NAME=VALUE with a number in SI units is expected"),
        (["run", "load.toml", "--set", "m_c=heavy"], "set m_c=heavy: NAME=VALUE"),
        (["run", "load.toml", "--set", "m_x=1"], "set m_x: there is no such variable; did you mean m_c?"),
        (["run", "load.toml", "--set", "m_c=1", "m_c=2"], "m_c was set before in the same command"),
        (["run", "load.toml", "--set", "m_c=-5"], "set m_c=-5.0: a number above 0 [kg] is expected"),
        (["run", "load.toml", "--set", "solver=fast"], "set solver=fast: one of automatic, explicit, implicit is"),
        (["run", "load.toml", "--set", "solver=3"], "set solver=3: one of automatic, explicit, implicit is expected"),
        (["run", "load.toml", "--set", "solver="], "set solver=: one of automatic, explicit, implicit is expected"),
        (["run", "load.toml", "--set", "solver"], "set solver: NAME=VALUE"),
        (["run", "load.toml", "--set", "m_c=implicit"], "set m_c=implicit: NAME=VALUE with a number"),
        (["run", "load.toml", "--set", "solver=implicit", "solver=explicit"], "solver was set before in the same"),
    ],
    "lists": [
        (["run", "load.toml", "--set"], "set: at least one value is expected behind it"),
        (["run", "load.toml", "--record"], "record: at least one value is expected behind it"),
        (["run", "load.toml", "--record", "thet"], "record thet: there is no such variable; did you mean theta?"),
    ],
    "states": [
        (["run", "load.toml", "--from-state", "none.state"], "none.state: cannot be read (No such file or directory)"),
        (["run", "load.toml", "--from-state", "foreign.fmu"], "foreign.fmu: is not a saved state; a file from"),
        (["run", "load.toml", "--save-state", "."], ".: is a folder, a file name is expected"),
        (["run", "load.toml", "--interface", "me", "--save-state", "x.csv"],
         "save state = x.csv: in Model Exchange CVode integrates, and what it remembers cannot be saved; Co-"),
    ],
    "files": [
        (["run", "load.toml", "-o", "x.txt"], "output = x.txt: a name that ends with .csv or .nc is expected"),
        (["run", "load.toml", "-o", "load.toml/x.csv"], "load.toml/x.csv: cannot be written"),
        (["run", "load.toml", "--plot", "x.doc"], "plot = x.doc: a name that ends with one of"),
        (["build", "load.toml", "-o", "."], ".: is a folder, a file name is expected"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "says"), [case for cases in WRONG.values() for case in cases])
def test_a_mistake_ends_with_2_and_a_sentence(arguments: list[str], says: str, command: Command) -> None:
    Path("foreign.fmu").write_text("not a zip")
    Path("x.csv").write_text("old")
    assert command(*arguments).status == 2
    assert command.err.startswith("cablefmu: ")
    assert says in command.err
    assert "Traceback" not in command.err
    assert Path("x.csv").read_text() == "old"


@pytest.mark.parametrize(("good", "bad", "says"), BAD)
def test_a_bad_scene_ends_with_2_and_its_mistakes(good: str, bad: str, says: tuple[str, ...], command: Command) -> None:
    for name, content in CSV.items():
        Path(name).write_bytes(content)
    Path("x.toml").write_text(GOOD.replace(good, bad), encoding="utf-8")
    assert command("run", "x.toml").status == 2
    assert all(part in command.err for part in says)
    assert "Traceback" not in command.err
    assert not Path("build").exists()


# --- as a process ---


def process(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "cablefmu", *arguments], capture_output=True, text=True, timeout=60)


def test_the_module_is_the_command() -> None:
    done = process("run", "load.toml", "--stop-time", "0.2")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("results: build/load.csv\n")
    wrong = process("run", "load.toml", "--set", "m_c=-1")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr == "cablefmu: set m_c=-1.0: a number above 0 [kg] is expected\n"
    failed = process("run", "load.toml", "--set", "F_cx=1e300")
    assert failed.returncode == 1
    assert "Traceback" not in failed.stderr


def test_a_reader_may_hang_up() -> None:
    done = subprocess.run(f"{sys.executable} -m cablefmu scenes | head -1", shell=True, capture_output=True, text=True)
    assert done.stdout.count("\n") == 1
    assert done.stderr == ""
