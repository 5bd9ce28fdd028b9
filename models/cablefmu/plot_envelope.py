"""How far every point of the cable gets, and between which pulls: extremes over the whole run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .along import node_positions
from .cable import Floats
from .plot_style import COLORS, along_cable, entitle, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_envelope"]


def draw_envelope(result: xr.Dataset) -> Figure:
    """Draw least and largest x and y of every node and, where it was recorded, pull of every link.

    Parameters
    ----------
    result
        With the places of the nodes, see `node_positions`.
    """
    length = result["link_length"].values if "link_length" in result else _lengths(result)
    nodes = np.concatenate([[0.0], np.cumsum(length)])
    x, y = node_positions(result)
    drawn = [("x [m], to the right", nodes, x), ("y [m], down", nodes, y)]
    if "tension" in result:
        drawn.append(("pull in the link [N]", nodes[1:] - 0.5 * length, result["tension"].values))
    figure, panels = new_figure(1, len(drawn), size=(3.2 * len(drawn), 6.0))
    for axes, (label, place, values), color in zip(panels, drawn, COLORS, strict=False):
        _between(axes, place, values, color)
        axes.set_xlabel(label)
    along_cable(panels[0], length)
    panels[0].legend(loc="best")
    times = result["time"].values
    entitle(figure, result, f"extremes along the cable, t = {times[0]:g} s to {times[-1]:g} s")
    return figure


def _lengths(result: xr.Dataset) -> Floats:
    """Of the links, from where their ends are at the start."""
    x, y = node_positions(result)
    return np.asarray(np.hypot(np.diff(x[0]), np.diff(y[0])))


def _between(axes: Axes, place: Floats, values: Floats, color: str) -> None:
    least, largest = values.min(axis=0), values.max(axis=0)
    axes.fill_betweenx(place, least, largest, color=color, alpha=0.2, linewidth=0.0)
    axes.plot(least, place, color=color, label="least and largest")
    axes.plot(largest, place, color=color, label="_largest")
    axes.plot(values.mean(axis=0), place, "--", color=color, label="mean of the output times")
    axes.plot(values[0], place, ":", color="black", label="start")
