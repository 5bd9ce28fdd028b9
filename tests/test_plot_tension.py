"""What the map of the pull shows: every link's number where it belongs, colours with a unit, the top above."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from cablefmu.plot_tension import draw_tension
from cablefmu.scene import Scene
from cablefmu.simulate import simulate
from tests.fmu_helpers import SCENES


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    uneven = SCENES["load"].replace("length = 20", "link_length = [2, 3, 4, 5, 6]")
    return simulate(Scene.from_text(uneven, name="uneven"), stop_time=1.0, record=["tensions"])


def test_every_pull_is_where_it_belongs(result: xr.Dataset) -> None:
    figure = draw_tension(result)
    axes, bar = figure.axes
    (mesh,) = axes.collections
    np.testing.assert_array_equal(np.reshape(mesh.get_array(), (5, 11)), result["tension"].values.T)
    corners = mesh.get_coordinates()
    np.testing.assert_allclose(corners[:, 0, 1], [0.0, 2.0, 5.0, 9.0, 14.0, 20.0])
    np.testing.assert_allclose(corners[0, :, 0], [0.0, *np.arange(0.05, 1.0, 0.1), 1.0])
    assert mesh.norm.vmin == result["tension"].min() and mesh.norm.vmax == result["tension"].max()
    assert bar.get_ylabel() == "pull in the link [N]"


def test_axes_say_what_they_are(result: xr.Dataset) -> None:
    figure = draw_tension(result)
    axes = figure.axes[0]
    assert axes.get_xlabel() == "time [s]"
    assert axes.get_ylabel() == "along the cable from its top [m]"
    assert axes.get_ylim() == (20.0, 0.0), "the top is above"
    assert figure.get_suptitle() == "uneven: pull along the cable; the larger of both ends of every link"


def test_a_single_output_time_is_a_column(result: xr.Dataset) -> None:
    (mesh,) = draw_tension(result.isel(time=slice(1))).axes[0].collections
    assert np.size(mesh.get_array()) == 5
    assert np.ptp(mesh.get_coordinates()[0, :, 0]) == 1.0
