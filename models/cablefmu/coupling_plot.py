"""The picture of a coupled run: positions, forces and the power between models over time."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .cable import Floats
from .files import replacing
from .plot import check_picture
from .plot_style import COLORS, entitle, new_figure, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_coupling", "plot_coupling"]


@dataclass(frozen=True, slots=True)
class _Panel:
    """Results of one unit in one diagram."""

    unit: str
    label: str
    factor: float = 1.0
    """What they are multiplied by."""
    from_start: bool = False
    """Whether it is what they are beyond their first value that is shown."""


_PANELS = (
    _Panel("m", "from where it began [m]", from_start=True),
    _Panel("N", "force [kN]", 1e-3),
    _Panel("W", "power [kW]", 1e-3),
    _Panel("", "in units of its own"),
)
_STYLES = ("-", "--", ":", "-.")
_PASSED_OVER = re.compile(r"\.residual$|\.solver\.|\[(?!1\])")
"""Errors, counters, and of lists such as elevation[1], elevation[2] ... all but the first."""
_STILL = 1e-9
"""Of the largest value in a diagram: a line that moves by less is left out."""


def plot_coupling(result: xr.Dataset, path: Path) -> None:
    """Draw a coupled run into a file.

    Parameters
    ----------
    result
        As `couple` returns it.
    path
        Picture to write; the suffix says of which kind (.png, .svg, .pdf).

    Raises
    ------
    OptionError
        If matplotlib is not installed, knows no such suffix, or the file cannot be written.
    """
    check_picture(path)
    figure = draw_coupling(result)
    with style(), replacing(path) as temporary:
        figure.savefig(temporary, format=path.suffix.removeprefix("."), dpi=72)


def draw_coupling(result: xr.Dataset) -> Figure:
    """Outputs in m (from their first value on), in N, the power of every connection, and outputs that have no unit.

    Outputs that stay as they began are left out, and so are diagrams in which nothing is left.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    shown = [(panel, lines) for panel in _PANELS if (lines := list(_lines(result, panel)))]
    rows = max(len(shown), 1)
    with style():
        figure, panels = new_figure(rows, size=(9.0, 1.0 + 2.4 * rows))
        for axes, (panel, lines) in zip(panels, shown, strict=False):
            _draw(axes, result["time"].values, lines)
            axes.set_ylabel(panel.label)
        panels[-1].set_xlabel("time [s]")
        entitle(figure, result, "a coupled run")
    return figure


def _lines(result: xr.Dataset, panel: _Panel) -> Iterator[tuple[str, Floats]]:
    """Names and values of what moves."""
    named = {
        str(name): values.values for name, values in result.data_vars.items()
        if values.attrs["units"] == panel.unit and not _PASSED_OVER.search(str(name))
    }  # fmt: skip
    largest = max((float(np.abs(values).max()) for values in named.values()), default=0.0)
    for name, values in named.items():
        if np.ptp(values) > _STILL * largest:
            yield name, panel.factor * (values - values[0] if panel.from_start else values)


def _draw(axes: Axes, times: Floats, lines: Sequence[tuple[str, Floats]]) -> None:
    for k, (name, values) in enumerate(lines):
        again, color = divmod(k, len(COLORS))
        axes.plot(times, values, _STYLES[again % len(_STYLES)], color=COLORS[color], label=name)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
