"""One look, whatever a user's matplotlib is set to; labels by units; what has a direction says so."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

from cablefmu.plot import draw
from cablefmu.plot_style import COLORS, labelled, new_figure, sequence, style


@pytest.mark.parametrize(
    ("units", "names", "label"),
    [
        ("m", ["x_c"], "x_c [m]"),
        ("m", ["x_c", "x_m1"], "position [m]"),
        ("m", ["x_c", "hull.y_1"], "position [m]\ny down"),
        ("m/s", ["v_m1"], "v_m1 [m/s]\ny down"),
        ("N", ["F_1x", "F_1y"], "force [N]\ny down"),
        ("N", ["u_m1"], "u_m1 [N]\ny down"),
        ("N", ["F_1x", "tension_top"], "force [N]"),
        ("rad", ["theta[1]", "theta[2]"], "angle [rad]"),
        ("K", ["a", "b"], "value [K]"),
        ("", ["solver"], "solver [-]"),
        ("1", ["solver.steps", "solver.rhs"], "value [-]"),
    ],
)
def test_labels(units: str, names: list[str], label: str) -> None:
    assert labelled(units, names) == label


def test_the_users_own_settings_do_not_show() -> None:
    time = np.arange(4.0)
    result = xr.Dataset({"x_c": ("time", time, {"units": "m"}), "z": ("time", time, {"units": "m"})}, {"time": time})
    with mpl.rc_context({"font.size": 30.0, "axes.grid": False, "axes.facecolor": "black", "lines.linewidth": 9.0}):
        (axes,) = draw(result, "series").axes
        assert mpl.rcParams["font.size"] == 30.0, "nor are they changed"
    assert axes.xaxis.label.get_size() == 10.0
    assert axes.get_facecolor() == (1.0, 1.0, 1.0, 1.0)
    assert [(line.get_linewidth(), line.get_color()) for line in axes.lines] == [(1.2, COLORS[0]), (1.2, COLORS[1])]


def test_panels_share_their_axes() -> None:
    with style():
        _, below = new_figure(2, 1)
        _, beside = new_figure(1, 3)
    assert below[0].get_shared_x_axes().joined(below[0], below[1])
    assert beside[0].get_shared_y_axes().joined(beside[0], beside[2])
    assert not beside[0].get_shared_x_axes().joined(beside[0], beside[2])


def test_a_sequence_runs_from_dark_to_bright() -> None:
    brightness = [sum(color[:3]) for color in sequence(9)]
    assert brightness == sorted(brightness)
    assert len(sequence(1)) == 1
