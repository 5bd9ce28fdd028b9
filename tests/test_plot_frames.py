"""What the picture of frames shows: the cable's shapes, y downward, axes with units."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from cablefmu.along import node_positions
from cablefmu.errors import OptionError
from cablefmu.plot_frames import draw_frames
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=1.0, record=["nodes"])


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
    figure = draw_frames(result, 0.5)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "x [m], to the right"
    assert axes.get_ylabel() == "y [m], down"
    assert axes.yaxis_inverted()
    assert not axes.xaxis_inverted()
    assert axes.get_aspect() == 1.0
    assert figure.get_suptitle() == "load: every 0.5 s from t = 0 s (dark) to 1 s (bright)"


def test_later_shapes_are_brighter(result: xr.Dataset) -> None:
    (axes,) = draw_frames(result, 0.1).axes
    brightness = [np.sum(np.asarray(line.get_color())[:3]) for line in axes.lines[::3]]
    assert len(brightness) == 11
    assert brightness[0] < brightness[5] < brightness[-1]


@pytest.mark.parametrize(("interval", "count"), [(1e-9, 11), (1e9, 1), (0.6, 3)])
def test_intervals_of_any_length(interval: float, count: int, result: xr.Dataset) -> None:
    """Every output time at most, and the first at least."""
    (axes,) = draw_frames(result, interval).axes
    assert len(axes.lines) == 3 * count


@pytest.mark.parametrize("interval", [0.0, -1.0, float("inf"), float("nan")])
def test_intervals_that_are_none(interval: float, result: xr.Dataset) -> None:
    with pytest.raises(OptionError, match=r"interval = .*: a number above 0 \[s\] is expected"):
        draw_frames(result, interval)
