"""The cable's shape at regular times in one picture, as the dissertation draws it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .along import node_positions
from .cable import Floats
from .errors import OptionError
from .plot_style import entitle, new_figure, sequence

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_frames"]


def draw_frames(result: xr.Dataset, interval: float) -> Figure:
    """Draw the shape every `interval` seconds, y downward.

    Parameters
    ----------
    result
        With the places of the nodes, see `node_positions`.
    interval
        Between two shapes [s].
    """
    times = result["time"].values
    frames = _frames(times, interval)
    x, y = node_positions(result)
    figure, (axes,) = new_figure()
    for color, k in zip(sequence(len(frames)), frames, strict=True):
        axes.plot(x[k], y[k], color=color, linewidth=1.0)
        axes.plot(x[k, :1], y[k, :1], "s", color=color, markersize=5)
        axes.plot(x[k, -1:], y[k, -1:], "o", color=color, markersize=4)
    axes.set(xlabel="x [m], to the right", ylabel="y [m], down")
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_yaxis()
    span = f"from t = {times[0]:g} s (dark) to {times[-1]:g} s (bright)"
    entitle(figure, result, f"every {interval:.3g} s {span}")
    return figure


def _frames(times: Floats, interval: float) -> list[int]:
    """Indices of the output times nearest to 0, interval, 2 interval, ..., each once."""
    if not 0.0 < interval < np.inf:
        raise OptionError(f"interval = {interval}: a number above 0 [s] is expected")
    if len(times) < 2 or interval <= np.diff(times).min():
        return list(range(len(times)))
    wanted = np.arange(times[0], times[-1] + 0.5 * interval, interval)
    return sorted({int(np.argmin(np.abs(times - t))) for t in wanted})
