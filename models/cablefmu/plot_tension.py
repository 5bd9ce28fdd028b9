"""The pull in every link over time, as a map."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .plot_style import MAP, along_cable, entitle, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_tension"]


def draw_tension(result: xr.Dataset) -> Figure:
    """Draw `tension` over time and along the cable.

    Parameters
    ----------
    result
        With `tension` over (time, link).
    """
    times, length = result["time"].values, result["link_length"].values
    middles = 0.5 * (times[1:] + times[:-1])
    across = np.concatenate([times[:1], middles, times[-1:]])
    if len(times) == 1:
        across = times[0] + np.array([-0.5, 0.5])  # a run that ended at its start still has a column
    down = np.concatenate([[0.0], np.cumsum(length)])
    figure, (axes,) = new_figure(size=(8.0, 5.0))
    axes.grid(visible=False)
    mesh = axes.pcolormesh(across, down, result["tension"].values.T, cmap=MAP, rasterized=True)
    figure.colorbar(mesh, ax=axes, label="pull in the link [N]")
    axes.set_xlabel("time [s]")
    along_cable(axes, length)
    entitle(figure, result, "pull along the cable; the larger of both ends of every link")
    return figure
