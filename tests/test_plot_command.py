"""`cablefmu plot` and `cablefmu run --plot`: pictures of what was kept and of what was asked for."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.image import imread

from cablefmu.plot_command import as_asked
from cablefmu.reading import open_result
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene
from tests.test_cli import Command, command, here

__all__ = ["command", "here"]


def drawn(path: str) -> bool:
    return bool((imread(path)[..., :3].min(axis=-1) < 0.5).mean() > 0.001)


def test_a_run_is_kept_and_drawn_later(command: Command) -> None:
    """Frames, pulls and an angle of one file; where the picture is, is said."""
    assert command("run", "load.toml", "--record", "nodes, tensions", "theta", "-o", "x.nc").status == 0
    for arguments, picture in (
        (["x.nc"], "x.frames.png"),
        (["x.nc", "--kind", "tension"], "x.tension.png"),
        (["x.nc", "--kind", "envelope", "-o", "e.svg"], "e.svg"),
        (["x.nc", "--interval", "1", "-o", "f.png"], "f.png"),
        (["x.nc", "--kind", "series", "--names", "x_c, y_c", "theta[3]"], "x.series.png"),
        (["x.nc", "--kind", "spectrum", "--names", "tension_top"], "x.spectrum.png"),
    ):
        command("plot", *arguments)
        assert (command.status, command.out, command.err) == (0, f"{picture}\n", "")
        assert drawn(picture) if picture.endswith(".png") else Path(picture).stat().st_size > 1000


@pytest.mark.parametrize(("kind", "held"), [("tension", []), ("envelope", ["nodes"]), ("series", ["tensions"])])
def test_a_run_draws_another_kind_and_keeps_what_was_asked_for(kind: str, held: list[str], command: Command) -> None:
    record = ["--record", *held] if held else []
    command("run", "load.toml", *record, "-o", "plain.csv")
    command("run", "load.toml", *record, "--plot", "x.png", "--plot-kind", kind, "-o", "x.csv")
    assert (command.status, command.err) == (0, "")
    assert drawn("x.png")
    assert Path("x.csv").read_bytes() == Path("plain.csv").read_bytes()
    assert open_result("x.csv").sizes == open_result("plain.csv").sizes


def test_what_a_scene_asks_for_is_kept(command: Command) -> None:
    text = Path("load.toml").read_text().replace("[run]\n", '[run]\nrecord = ["nodes", "omega"]\n')
    Path("asking.toml").write_text(text)
    command("run", "asking.toml", "--plot", "x.png", "--plot-kind", "tension", "-o", "x.csv")
    assert command.status == 0
    result = open_result("x.csv")
    assert {"node_x", "node_y", "omega"} <= set(result) and "tension" not in result
    head = Path("x.csv").read_text().partition("\n")[0].split(",")
    assert [name for name in head if name.startswith("node_x")] == [f"node_x[{i}]" for i in range(6)]


def test_a_run_that_failed_is_drawn_as_far_as_it_came(command: Command) -> None:
    command("run", "load.toml", "--set", "F_cx=1e300", "--plot", "x.png", "-o", "x.csv")
    assert command.status == 1
    assert "picture: x.png" in command.out
    assert drawn("x.png")
    assert "ended_early" in open_result("x.csv").attrs
    assert command("plot", "x.csv", "--kind", "series").status == 0


def test_only_what_was_asked_for_is_left() -> None:
    run = simulate(small_scene("load"), stop_time=0.2, record=["nodes", "tensions", "theta"])
    left = as_asked(run, ["theta"])
    assert set(left.dims) == {"time", "link"} and "link_length" in left.coords
    assert set(as_asked(run.drop_vars("theta"), []).dims) == {"time"}
    assert as_asked(run, ["nodes", "tensions", "theta"]).identical(run)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["plot", "x.csv"], "x.csv: there is no such file"),
        (["plot", "."], ".: a name that ends with .csv or .nc is expected"),
        (["plot", "load.toml"], "load.toml: a name that ends with .csv or .nc is expected"),
        (["plot", "x.csv", "-o", "x.gift"], "plot = x.gift: a name that ends with one of"),
        (["plot", "x.csv", "--kind", "movie"], "movie"),
        (["plot", "x.csv", "--names"], "at least one"),
        (["plot", "kept.csv"], "frames needs nodes, which this result does not hold; a run with --record nodes does"),
        (
            ["plot", "kept.csv", "--kind", "series", "--names", "x"],
            "names x: the result has no such variable over time",
        ),
        (["plot", "kept.csv", "--names", "x_c"], "names: a picture of frames has none; series and spectrum have"),
        (
            ["run", "load.toml", "--plot-kind", "series"],
            "plot-kind = series: goes with --plot FILE.png, which is missing",
        ),
    ],
)
def test_a_mistake_ends_with_2_and_a_sentence(arguments: list[str], says: str, command: Command) -> None:
    command("run", "load.toml", "-o", "kept.csv")
    command(*arguments)
    assert command.status == 2
    assert says in command.err and "Traceback" not in command.err
