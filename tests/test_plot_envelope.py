"""What the picture of extremes shows: least and largest of every node and link, along the cable."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from cablefmu.plot_envelope import draw_envelope
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=1.0, record=["nodes", "tensions"])


def test_extremes_mean_and_start_of_every_point(result: xr.Dataset) -> None:
    figure = draw_envelope(result)
    nodes, middles = np.arange(0.0, 21.0, 4.0), np.arange(2.0, 20.0, 4.0)
    for axes, name, place in zip(figure.axes, ("node_x", "node_y", "tension"), (nodes, nodes, middles), strict=True):
        values = result[name].values
        least, largest, mean, start = axes.lines
        for line, expected in (
            (least, values.min(axis=0)), (largest, values.max(axis=0)), (mean, values.mean(axis=0)), (start, values[0]),
        ):  # fmt: skip
            np.testing.assert_array_equal(line.get_xdata(), expected)
            np.testing.assert_allclose(line.get_ydata(), place, rtol=1e-12)
        (between,) = axes.collections
        corners = between.get_paths()[0].vertices
        assert (corners[:, 0].min(), corners[:, 0].max()) == (values.min(), values.max())


def test_axes_say_what_they_are(result: xr.Dataset) -> None:
    figure = draw_envelope(result)
    labels = [axes.get_xlabel() for axes in figure.axes]
    assert labels == ["x [m], to the right", "y [m], down", "pull in the link [N]"]
    assert figure.axes[0].get_ylabel() == "along the cable from its top [m]"
    assert all(axes.get_ylim() == pytest.approx((20.0, 0.0)) for axes in figure.axes), (
        "the top is above, in all of them"
    )
    legend = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert legend == ["least and largest", "mean of the output times", "start"]
    assert figure.get_suptitle() == "load: extremes along the cable, t = 0 s to 1 s"


def test_without_pulls_there_are_two_panels(result: xr.Dataset) -> None:
    """The lengths of the links then follow from where their ends are."""
    nodes = result[["node_x", "node_y"]].assign_attrs(result.attrs)
    figure = draw_envelope(nodes)
    assert len(figure.axes) == 2
    np.testing.assert_allclose(figure.axes[0].lines[0].get_ydata(), np.arange(0.0, 21.0, 4.0), rtol=1e-12)
