"""How a figure is spread over the cases of a sweep, and what it depends on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..errors import OptionError
from ..files import replacing
from ..plot import check_picture
from ..scene_mistakes import nearest
from .statistics import exceedance, summary_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_sweep", "plot_sweep"]

_MOST_SCATTERS = 6


def plot_sweep(result: xr.Dataset, path: Path, of: str | None = None) -> None:
    """Write the picture of `draw_sweep`; the suffix says of which kind (.png, .svg, .pdf).

    Raises
    ------
    OptionError
        If there is no such figure, no case ended, or the file cannot be written.
    """
    figure = draw_sweep(result, of)
    check_picture(path)
    with replacing(path) as temporary:
        figure.savefig(temporary, format=path.suffix.removeprefix("."), dpi=120)


def draw_sweep(result: xr.Dataset, of: str | None = None) -> Figure:
    """Histogram and exceedance of one figure, and the figure over every number that varied, six at most.

    Parameters
    ----------
    result
        As `sweep` and `open_sweep` give it.
    of
        Name of the figure; the first that ends with tension_max.max, or the first of all.
    """
    from matplotlib.figure import Figure

    names = [summary.name for summary in summary_of(result)]
    if not names:
        raise OptionError("plot: no case ended; there is nothing to draw")
    if of is not None and of not in names:
        raise OptionError(f"of = {of}: there is no such figure; {nearest(of, names)}")
    name = of or next((name for name in names if name.endswith("tension_max.max")), names[0])
    values = result[name].values
    has = ~np.isnan(values)
    varied = [v for v in str(result.attrs["varied"]).split() if result[v].dtype.kind == "f"][:_MOST_SCATTERS]
    rows = 1 + (len(varied) + 1) // 2
    figure = Figure(figsize=(9, 3.2 * rows), layout="constrained")
    axes = figure.subplots(rows, 2, squeeze=False).ravel()
    unit = result[name].attrs.get("units", "")
    label = f"{name} [{unit}]" if unit else name
    _histogram(axes[0], values[has], label)
    _exceedance(axes[1], values[has], label)
    for k, parameter in enumerate(varied, start=2):
        _scatter(axes[k], result, parameter, name, label)
    for k in range(2 + len(varied), len(axes)):
        axes[k].set_axis_off()
    failed = int(np.sum(result["status"].values != "ended"))
    figure.suptitle(f"{result.attrs['title']}: {int(has.sum())} cases" + (f", {failed} failed" if failed else ""))
    return figure


def _histogram(axes: Any, values: Any, label: str) -> None:
    axes.hist(values, bins="sqrt", color="tab:blue")
    axes.set(xlabel=label, ylabel="cases", title="How often")


def _exceedance(axes: Any, values: Any, label: str) -> None:
    ordered, shares = exceedance(values)
    axes.semilogy(ordered, shares, ".", color="tab:blue", markersize=4)
    axes.set(xlabel=label, ylabel="share of the cases beyond", title="Exceedance")
    axes.grid(alpha=0.3, which="both")


def _scatter(axes: Any, result: xr.Dataset, parameter: str, name: str, label: str) -> None:
    """One colour a scene."""
    scenes = result["scene"].values
    for scene in dict.fromkeys(scenes.tolist()):
        chosen = scenes == scene
        axes.plot(result[parameter].values[chosen], result[name].values[chosen], ".", markersize=4, label=scene)
    axes.set(xlabel=parameter, ylabel=label)
    axes.grid(alpha=0.3)
    if len(set(scenes.tolist())) > 1:
        axes.legend(fontsize="small")
