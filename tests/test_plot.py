"""Pictures by their kind: what each needs, what is refused, what a run that ended early says, and files."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

import cablefmu
from cablefmu.errors import OptionError, RunError
from cablefmu.plot import KINDS, Kind, check_picture, draw, node_positions, picture_needs, write_plot
from cablefmu.reading import open_result
from cablefmu.results import write_results
from cablefmu.scene import Scene
from cablefmu.simulate import simulate
from tests.fmu_helpers import SCENES, small_scene
from tests.test_simulate import SPUN

BOTH = ("nodes", "tensions")


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=2.0, record=[*BOTH, "theta"])


@pytest.fixture(scope="module")
def partial(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """Of a whirling cable that wound up too far, kept and read back."""
    loose = SCENES["air"].replace("young_modulus = 8e10", "joint_stiffness = 0").replace("damping = 2.8", "damping = 0")
    with pytest.raises(RunError) as ended:
        simulate(Scene.from_text(loose, name="whirling"), parameters=SPUN, stop_time=3.0, step=0.01, record=BOTH)
    assert isinstance(ended.value.partial, xr.Dataset)
    path = tmp_path_factory.mktemp("partial") / "x.nc"
    write_results(ended.value.partial, path)
    return open_result(path)


# --- what the cable's shape is found from ---


def test_nodes_run_from_the_floater_to_the_terminal(result: xr.Dataset) -> None:
    """The FMU's own x_c, y_c are the sum over the links."""
    x, y = node_positions(result.drop_vars(["node_x", "node_y"]))
    assert x.shape == y.shape == (21, 6)
    np.testing.assert_array_equal(x[:, 0], 0.0)
    np.testing.assert_array_equal(y[:, 0], result["y_m1"])
    np.testing.assert_allclose(x[:, -1], result["x_c"], rtol=1e-13)
    np.testing.assert_allclose(y[:, -1], result["y_c"], rtol=1e-13)
    np.testing.assert_allclose(np.hypot(np.diff(x), np.diff(y)), 4.0, rtol=1e-13)


@pytest.mark.parametrize(
    ("kind", "top"), [("surge", ("x_m1", "y_m1")), ("moved", ("x_1", "y_1")), ("between", ("x_1", "y_1"))]
)
def test_nodes_begin_where_the_top_is(kind: str, top: tuple[str, str]) -> None:
    scene = small_scene(kind)
    run = simulate(scene, stop_time=1.0, record=picture_needs(scene.cable))
    x, y = node_positions(run)
    np.testing.assert_array_equal(x[:, 0], run[top[0]])
    np.testing.assert_array_equal(y[:, 0], run[top[1]])
    assert np.ptp(y[:, 0]) > 0.05
    np.testing.assert_allclose(x[:, -1], run["x_c"], rtol=1e-13)
    np.testing.assert_allclose(y[:, -1], run["y_c"], rtol=1e-13)


# --- kinds ---


def test_the_command_line_takes_every_kind() -> None:
    assert get_args(Kind) == tuple(KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_drawn_of_what_it_needs(kind: str) -> None:
    """And tells that it is of a whole run: nothing ended early."""
    run = simulate(small_scene("surge"), stop_time=2.0, record=KINDS[kind])
    figure = cablefmu.draw(run, kind)
    assert figure.get_suptitle().startswith("surge: ")
    assert "ended" not in figure.get_suptitle()
    assert all(axes.get_xlabel() or axes.get_shared_x_axes() for axes in figure.axes)


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_ended_early_is_drawn_and_says_where(kind: str, partial: xr.Dataset) -> None:
    title = draw(partial, kind).get_suptitle().splitlines()
    end = partial["time"].values[-1]
    assert 0.2 < end < 1.0
    assert title[0].startswith("whirling: ")
    assert f"ended at t = {end:g} s: " in title[1]
    assert "wound up beyond 1.6e6 rad" in " ".join(title[1:])


@pytest.mark.parametrize("kind", ["frames", "series", "tension", "envelope"])
def test_a_run_that_ended_at_its_start_is_drawn(kind: str) -> None:
    with pytest.raises(RunError) as ended:
        simulate(small_scene("load"), parameters={"F_cx": 1e300}, record=BOTH)
    assert isinstance(ended.value.partial, xr.Dataset)
    assert "ended at t = 0 s" in draw(ended.value.partial, kind).get_suptitle()


@pytest.mark.parametrize(
    ("kind", "drop", "says"),
    [
        ("frames", ["node_x", "theta"], "frames needs nodes, .* a run with --record nodes does"),
        ("envelope", ["node_y", "theta"], "envelope needs nodes, .* a run with --record nodes tensions does"),
        ("tension", ["tension"], "tension needs tensions, .* a run with --record tensions does"),
    ],
)
def test_what_a_result_does_not_hold_is_asked_for(kind: str, drop: list[str], says: str, result: xr.Dataset) -> None:
    with pytest.raises(OptionError, match=says):
        draw(result.drop_vars(drop), kind)


def test_results_of_couplings_are_not_asked_for_what_no_option_records(result: xr.Dataset) -> None:
    coupled = result.drop_vars("tension").assign_attrs(coupling="[coupling]")
    with pytest.raises(OptionError, match=r"tension needs tensions, .* couplings have pictures of kind series and"):
        draw(coupled, "tension")


def test_options_that_do_not_belong(result: xr.Dataset) -> None:
    with pytest.raises(OptionError, match="kind = 'movie': one of frames, series, tension, envelope, spectrum is"):
        draw(result, "movie")
    with pytest.raises(OptionError, match="a picture of tension has none; series and spectrum have"):
        draw(result, "tension", names=["x_c"])
    with pytest.raises(OptionError, match=r"interval = 0\.5: only a picture of frames has one"):
        draw(result, "series", interval=0.5)
    with pytest.raises(OptionError, match="holds no output time"):
        draw(result.isel(time=slice(0)), "series")
    with pytest.raises(OptionError, match="holds no output time"):
        draw(xr.Dataset(), "series")


def test_a_single_name_is_one(result: xr.Dataset) -> None:
    """A text is a sequence of texts as well, of its letters."""
    assert [line.get_label() for line in draw(result, "series", names="x_c").axes[0].lines] == ["x_c"]


def test_the_interval_is_the_scenes_unless_it_is_given(result: xr.Dataset) -> None:
    """A thirtieth of the scene's stop time where it says nothing."""
    assert result.attrs["frame_interval"] == pytest.approx(2.0 / 30.0)
    assert len(draw(result).axes[0].lines) == 3 * 21, "every output time: they are 0.1 s apart"
    assert len(draw(result, interval=1.0).axes[0].lines) == 3 * 3
    del (other := result.copy()).attrs["frame_interval"]
    assert len(draw(other).axes[0].lines) == 3 * 21


# --- files ---


def test_the_picture_is_one(result: xr.Dataset, tmp_path: Path) -> None:
    write_plot(result, tmp_path / "x.png", interval=0.5)
    pixels = imread(tmp_path / "x.png")
    assert pixels.shape == (720, 960, 4)
    assert 0.001 < np.mean(pixels[..., :3].min(axis=-1) < 0.5) < 0.5, "lines on white"


def test_vectors_as_well(result: xr.Dataset, tmp_path: Path) -> None:
    write_plot(result, tmp_path / "x.svg", "series")
    assert "<svg" in (tmp_path / "x.svg").read_text()


def test_places_and_kinds_that_cannot_be(result: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"x.bmpp: a name that ends with one of .*\.pdf, .*\.png"):
        check_picture(tmp_path / "x.bmpp")
    with pytest.raises(OptionError, match="a name that ends with one of"):
        write_plot(result, tmp_path / "x")
    (tmp_path / "dir.png").mkdir()
    with pytest.raises(OptionError, match=r"dir.png: is a folder"):
        check_picture(tmp_path / "dir.png")


def test_without_matplotlib_it_says_what_to_install(result: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(OptionError, match=r"pip install 'cablefmu\[plot\]'"):
        draw(result)
