"""What the picture shows: the cable's shapes, y downward, axes with units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

from cablefmu.errors import OptionError
from cablefmu.plot import check_picture, draw_frames, node_positions, picture_needs, plot_frames
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=1.0, record=["theta"])


def test_nodes_run_from_the_floater_to_the_terminal(result: xr.Dataset) -> None:
    """The FMU's own x_c, y_c are the sum over the links."""
    x, y = node_positions(result)
    assert x.shape == y.shape == (11, 6)
    np.testing.assert_array_equal(x[:, 0], 0.0)
    np.testing.assert_array_equal(y[:, 0], result["y_m1"])
    np.testing.assert_allclose(x[:, -1], result["x_c"], rtol=1e-13)
    np.testing.assert_allclose(y[:, -1], result["y_c"], rtol=1e-13)
    np.testing.assert_allclose(np.hypot(np.diff(x), np.diff(y)), 4.0, rtol=1e-13)


def test_every_frame_is_a_cable_with_its_ends(result: xr.Dataset) -> None:
    (axes,) = draw_frames(result, 0.25).axes
    cables, floaters, terminals = axes.lines[::3], axes.lines[1::3], axes.lines[2::3]
    x, y = node_positions(result)
    shown = [0, 2, 5, 7, 10]  # output times nearest to 0, 0.25, 0.5, 0.75, 1
    assert len(cables) == len(floaters) == len(terminals) == len(shown)
    for k, cable, floater, terminal in zip(shown, cables, floaters, terminals, strict=True):
        np.testing.assert_array_equal(cable.get_xydata(), np.column_stack([x[k], y[k]]))
        assert floater.get_xydata().tolist() == [[0.0, y[k, 0]]]
        assert terminal.get_xydata().tolist() == [[x[k, -1], y[k, -1]]]


def test_axes_say_what_they_are(result: xr.Dataset) -> None:
    (axes,) = draw_frames(result, 0.5).axes
    assert axes.get_xlabel() == "x [m], to the right"
    assert axes.get_ylabel() == "y [m], down"
    assert axes.yaxis_inverted()
    assert not axes.xaxis_inverted()
    assert axes.get_aspect() == 1.0
    assert axes.get_title() == "load: every 0.5 s from t = 0 s (dark) to 1 s (bright)"


def test_later_shapes_are_brighter(result: xr.Dataset) -> None:
    (axes,) = draw_frames(result, 0.1).axes
    brightness = [np.sum(np.asarray(line.get_color())[:3]) for line in axes.lines[::3]]
    assert len(brightness) == 11
    assert brightness[0] < brightness[5] < brightness[-1]


def test_the_picture_is_one(result: xr.Dataset, tmp_path: Path) -> None:
    plot_frames(result, tmp_path / "x.png", 0.5)
    pixels = imread(tmp_path / "x.png")
    assert pixels.shape == (720, 960, 4)
    assert 0.001 < np.mean(pixels[..., :3].min(axis=-1) < 0.5) < 0.5, "lines on white"


def test_places_and_kinds_that_cannot_be(result: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"x.bmpp: a name that ends with one of .*\.pdf, .*\.png"):
        check_picture(tmp_path / "x.bmpp")
    with pytest.raises(OptionError, match="a name that ends with one of"):
        plot_frames(result, tmp_path / "x", 0.5)
    (tmp_path / "dir.png").mkdir()
    with pytest.raises(OptionError, match=r"dir.png: is a folder"):
        check_picture(tmp_path / "dir.png")


def test_without_matplotlib_it_says_what_to_install(result: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(OptionError, match=r"pip install 'cablefmu\[plot\]'"):
        draw_frames(result, 0.5)


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
