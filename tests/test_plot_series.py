"""What the picture of numbers over time shows."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from cablefmu.plot_series import draw_series
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=1.0, record=["theta"])


def test_a_panel_for_each_unit_with_a_legend(result: xr.Dataset) -> None:
    figure = draw_series(result)
    assert figure.get_suptitle() == "load: over time"
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["position [m]\ny down", "velocity [m/s]\ny down", "force [N]", "energy [J]"]
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "", "", "time [s]"]
    for axes in figure.axes:
        for line in axes.lines:
            np.testing.assert_array_equal(line.get_xdata(), result["time"])
            name = axes.get_ylabel().partition(" ")[0] if len(axes.lines) == 1 else str(line.get_label())
            np.testing.assert_array_equal(line.get_ydata(), result[name])
    legend = figure.axes[2].get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["tension_top", "tension_end", "tension_max"]
    assert figure.axes[3].get_legend() is None, "its label says which one it is"
    assert len({line.get_color() for line in figure.axes[2].lines}) == 3


def test_named_ones_alone(result: xr.Dataset) -> None:
    (axes,) = draw_series(result, ["y_c"]).axes
    assert (axes.get_ylabel(), axes.get_xlabel()) == ("y_c [m]\ny down", "time [s]")
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), result["y_c"])


def test_an_array_is_a_line_for_each_link(result: xr.Dataset) -> None:
    (axes,) = draw_series(result, ["theta"]).axes
    assert axes.get_ylabel() == "angle [rad]"
    assert len(axes.lines) == 5
    np.testing.assert_array_equal([line.get_ydata() for line in axes.lines], result["theta"].T)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["theta[1]", "theta[5]"]
