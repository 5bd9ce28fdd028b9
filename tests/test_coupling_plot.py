"""What the picture of a coupled run shows: what moves, by unit, with its name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

from cablefmu.coupling_plot import draw_coupling, plot_coupling
from cablefmu.errors import OptionError

TIMES = np.linspace(0.0, 2.0, 5)


@pytest.fixture
def result() -> xr.Dataset:
    columns = {
        "sea.z[1]": ("m", 3.0 * TIMES), "sea.z[2]": ("m", TIMES),
        "ship.x": ("m", 80.0 + TIMES), "ship.y": ("m", 0.0 * TIMES + 10.0), "cable.v": ("m/s", TIMES),
        "cable.F": ("N", 2000.0 - 500.0 * TIMES), "power.surge": ("W", 1500.0 * TIMES**2),
        "power.surge.residual": ("W", 0.1 * TIMES), "box.z": ("", TIMES), "cable.solver.steps": ("", 9.0 * TIMES),
    }  # fmt: skip
    data = {name: ("time", values, {"units": unit}) for name, (unit, values) in columns.items()}
    return xr.Dataset(data, coords={"time": TIMES}, attrs={"title": "tow"})


def test_what_moves_is_shown_by_unit(result: xr.Dataset) -> None:
    """Not what stays where it is, velocities and residuals; positions count from where they began."""
    diagrams = draw_coupling(result).axes
    shown = {line.get_label(): line.get_xydata() for axes in diagrams for line in axes.get_lines()}
    expected = {
        "ship.x": TIMES,
        "sea.z[1]": 3.0 * TIMES,
        "cable.F": 2.0 - 0.5 * TIMES,
        "power.surge": 1.5 * TIMES**2,
        "box.z": TIMES,
    }
    assert shown.keys() == expected.keys()
    for name, values in expected.items():
        np.testing.assert_allclose(shown[name], np.column_stack([TIMES, values]), rtol=0, atol=1e-12)
    assert [axes.get_ylabel() for axes in diagrams] == [
        "from where it began [m]", "force [kN]", "power [kW]", "in units of its own"
    ]  # fmt: skip
    assert diagrams[-1].get_xlabel() == "time [s]"
    assert diagrams[0].get_figure().get_suptitle() == "tow: a coupled run"


def test_a_diagram_of_nothing_is_left_out(result: xr.Dataset) -> None:
    kept = result.drop_vars(["cable.F", "power.surge", "power.surge.residual", "box.z", "sea.z[1]"])
    (axes,) = draw_coupling(kept).axes
    assert [line.get_label() for line in axes.get_lines()] == ["ship.x"]
    assert axes.get_xlabel() == "time [s]"
    (empty,) = draw_coupling(kept.drop_vars("ship.x")).axes
    assert not empty.get_lines()


def test_the_picture_is_written(result: xr.Dataset, tmp_path: Path) -> None:
    plot_coupling(result, tmp_path / "a.png")
    assert imread(tmp_path / "a.png").shape[:2] > (400, 400)
    with pytest.raises(OptionError, match="a name that ends with one of"):
        plot_coupling(result, tmp_path / "a.doc")
