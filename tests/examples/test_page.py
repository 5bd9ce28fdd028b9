"""docs/examples.md: every example runs by the commands that the page prints, and shows what the page says of it."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.benchmarks.coupled_hour import measure
from tests.test_cli import Command

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "examples.md").read_text("utf-8")
COMMANDS = dict(re.findall(r"<!-- example: ([\w-]+) -->\n```sh\n(.*?)```", PAGE, re.DOTALL))


@pytest.fixture(autouse=True)
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page's commands are given where the repository is; here where a copy of its examples is."""
    shutil.copytree(ROOT / "docs" / "examples", tmp_path / "docs" / "examples")
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def run(command: Command, name: str, *more: str) -> dict[str, NDArray[np.float64]]:
    """Every command of an example, those of cablefmu with more options; its results by column."""
    for line in COMMANDS[name].splitlines():
        program, *arguments = shlex.split(line)
        if program == "cablefmu":
            assert command(*arguments, *more).status == 0
        else:
            assert program == "pythonfmu"
            # It imports what it packs: in a process of its own that leaves no trace in this one.
            subprocess.run([sys.executable, "-B", "-m", "pythonfmu", *arguments], check=True)
    (results,) = Path("build").glob("*.csv")
    pictures = [word for line in COMMANDS[name].splitlines() for word in shlex.split(line) if word.endswith(".png")]
    assert all(Path(picture).read_bytes().startswith(b"\x89PNG") for picture in pictures) and pictures
    table = np.genfromtxt(results, delimiter=",", names=True, deletechars="")
    return {column: table[column] for column in table.dtype.names or ()}


def test_the_page_has_its_examples() -> None:
    assert list(COMMANDS) == ["heave-in-waves", "buoy-in-waves", "two-vessels", "lift", "controller"]
    for picture in re.findall(r"\]\((examples/.*?\.png)\)", PAGE):
        assert (ROOT / "docs" / picture).stat().st_size < 200_000


def test_a_wave_does_what_the_scene_prescribes(command: Command) -> None:
    """25 kN and 4 s, once the ramp of 8 s is over and the filters have forgotten it."""
    result = run(command, "heave-in-waves")
    late = result["time"] > 15.0
    force, heave, pull = (result[name][late] for name in ("hull.F_wave_y", "cable.y_m1", "cable.tension_top"))
    assert np.max(force) == pytest.approx(25.1e3, abs=200) and np.min(force) == pytest.approx(-25.1e3, abs=200)
    crossings = np.flatnonzero((force[:-1] < 0.0) & (force[1:] >= 0.0))
    assert np.diff(result["time"][late][crossings]) == pytest.approx(4.0, abs=0.11)  # as rows are 0.1 s apart
    assert np.ptp(heave) == pytest.approx(6.2, abs=0.1)
    assert np.min(pull) == pytest.approx(2.0e3, abs=100) and np.max(pull) == pytest.approx(7.3e3, abs=100)


def test_the_buoy_follows_the_waves(command: Command) -> None:
    """The page's numbers are of 120 s; 40 s show that the buoy goes up where the sea does, and the load with it."""
    result = run(command, "buoy-in-waves", "--stop-time", "40")
    late = result["time"] > 20.0
    elevation, heave, load = (result[name][late] for name in ("sea.elevation[3]", "buoy.y", "cable.y_c"))
    assert np.corrcoef(elevation, -heave)[0, 1] > 0.9
    assert np.max(np.abs(load - 180.0 - heave)) < 0.1
    assert 5.9e3 < np.min(result["cable.F_1y"]) < 7.0e3 and 9.0e3 < np.max(result["cable.F_1y"]) < 10.0e3


def test_tug_and_barge_end_at_the_speed_that_thrust_and_drag_allow(command: Command) -> None:
    """8 kN of thrust against 3 kN s/m of each; they tend to it with a time of 80 t / (6 kN s/m) = 13 s."""
    result = run(command, "two-vessels")
    speed, pull = result["barge.vx"], result["cable.tension_top"]
    assert speed[-1] == pytest.approx(-8.0 / 6.0, abs=0.05)
    assert result["tug.vx"][-1] == pytest.approx(speed[-1], abs=0.05)
    assert np.max(pull) == pytest.approx(7.7e3, abs=50) and result["time"][np.argmax(pull)] == pytest.approx(
        26, abs=0.5
    )
    # towing the barge at that speed takes its drag, 4 kN
    assert result["cable.F_2x"][-1] == pytest.approx(-4.0e3, abs=100)


def test_the_cable_takes_the_load_when_the_lift_ends(command: Command) -> None:
    """The pull at the ship jumps at once, as links do not stretch; the rest follows as the cable straightens."""
    result = run(command, "lift")
    time, pull = result["time"], result["F_1y"]
    assert pull[time < 15.15][-1] == pytest.approx(5.6e3, abs=50)
    assert pull[time > 15.15][0] == pytest.approx(6.4e3, abs=50)
    assert np.max(pull[(time > 15.15) & (time < 16.25)]) == pytest.approx(8.1e3, abs=50)
    assert np.max(result["x_c"]) == pytest.approx(29, abs=0.5)


def test_the_load_settles_at_the_set_point(command: Command) -> None:
    result = run(command, "controller")
    settled = result["time"] >= 100.0
    assert np.sum(settled) == 1001
    assert np.max(np.abs(result["cable.x_c"][settled] - 15.0)) < 0.05
    assert np.max(result["controller.F"]) == 1000.0
    assert result["controller.F"][-1] == pytest.approx(346, abs=1)


def test_the_controller_has_thirty_lines_or_so() -> None:
    lines = (ROOT / "docs" / "examples" / "controller.py").read_text("utf-8").splitlines()
    code = [line for line in lines if line.strip()]
    assert len(code) <= 32


def test_the_cable_alone_moves_under_the_recorded_motion_as_in_the_coupled_run() -> None:
    """Extrapolated place, velocity and acceleration in the one, a spline through the samples in the other: 3e-4 m."""
    hour = measure(20.0)
    assert len(hour.alone["time"]) == len(hour.coupled["time"]) == 201
    assert np.ptp(hour.alone["y_c"].values) > 0.3
    assert hour.apart < 2e-3
    assert all(speed > 1.0 for speed in hour.speeds)
