"""Numbers over time, a panel for each unit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import xarray as xr

from .plot_lines import chosen_lines, panels_of
from .plot_style import entitle, labelled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_series"]


def draw_series(result: xr.Dataset, names: Sequence[str] = ()) -> Figure:
    """Draw variables over time; arguments and errors as for `chosen_lines`."""
    groups = chosen_lines(result, names)
    figure, panels = panels_of(groups)
    times = result["time"].values
    for axes, (units, lines) in zip(panels, groups.items(), strict=True):
        for line in lines:
            more = {} if line.color is None else {"color": line.color}
            axes.plot(times, line.values, label=line.name if line.is_named else f"_{line.name}", **more)
        axes.set_ylabel(labelled(units, [line.name for line in lines]))
        if len(lines) > 1:
            axes.legend(loc="best")
    panels[-1].set_xlabel("time [s]")
    entitle(figure, result, "over time")
    return figure
