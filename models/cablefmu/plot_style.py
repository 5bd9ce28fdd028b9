"""How every picture of the project looks: fonts, colours, labels with units, what it says of a run that ended early."""

from __future__ import annotations

import importlib.util
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import xarray as xr

from .cable import Floats
from .errors import OptionError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["COLORS", "along_cable", "entitle", "labelled", "need_matplotlib", "new_figure", "sequence", "style"]

COLORS = ("#0b6fb8", "#d1495b", "#2e8b57", "#8a6d3b", "#7d5ba6", "#e08e2b", "#7a8794")
"""Of lines that are told apart by a legend, in this order."""

MAP = "viridis"
"""Of what has an order: times, links, pulls. Dark is early, at the top, small."""

_LOOK: dict[str, Any] = {
    "font.family": "DejaVu Sans", "font.size": 10.0, "axes.titlesize": 10.0, "figure.titlesize": 11.0,
    "axes.grid": True, "grid.alpha": 0.3, "lines.linewidth": 1.2, "legend.fontsize": "small",
}  # fmt: skip

_QUANTITIES = {
    "m": "position", "m/s": "velocity", "m/s2": "acceleration", "N": "force", "J": "energy", "rad": "angle",
    "rad/s": "angular rate", "kg": "mass", "W": "power",
}  # fmt: skip


def need_matplotlib() -> None:
    """Raise an OptionError that says what to install where matplotlib is missing."""
    if importlib.util.find_spec("matplotlib") is None:
        raise OptionError("a picture needs matplotlib: pip install 'cablefmu[plot]'")


@contextmanager
def style() -> Iterator[None]:
    """Everything that is drawn inside looks alike, whatever the user's matplotlib is set to.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    need_matplotlib()
    from cycler import cycler
    from matplotlib import rc_context, rcParamsDefault

    look: dict[Any, Any] = {key: value for key, value in rcParamsDefault.items() if key.partition(".")[0] in _SET}
    look |= _LOOK
    look["axes.prop_cycle"] = cycler(color=COLORS)
    with rc_context(look):
        yield


_SET = ("font", "axes", "grid", "lines", "legend", "xtick", "ytick", "text", "figure")
"""Groups of matplotlib's settings that the pictures have their own of."""


def new_figure(rows: int = 1, columns: int = 1, size: tuple[float, float] = (8.0, 6.0)) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels; those below each other share their abscissa, those side by side their ordinate."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharex="col", sharey="row")
    return figure, list(panels.flat)


def entitle(figure: Figure, result: xr.Dataset, text: str) -> None:
    """Title of the whole, and below it when and why the run ended if that was early."""
    lines = [f"{result.attrs.get('title', 'result')}: {text}"]
    if "ended_early" in result.attrs:
        reason = f"ended at t = {result['time'].values[-1]:g} s: {result.attrs['ended_early']}"
        lines += textwrap.wrap(reason, width=int(11 * figure.get_figwidth()))
    figure.suptitle("\n".join(lines))


def labelled(units: str, names: Sequence[str]) -> str:
    """Label of an axis for these variables of one unit: a single one by its name, several by what they are."""
    what = names[0] if len(names) == 1 else _QUANTITIES.get(units, "value")
    down = "\ny down" if any(_is_downward(name) for name in names) else ""
    return f"{what} [{'-' if units in ('', '1') else units}]{down}"


def _is_downward(name: str) -> bool:
    """Whether such a variable has a direction, and that is y: y_c, vy_c, F_cy, v_m1, node_y, hull.y_1, ..."""
    stem = name.rpartition(".")[2].partition("[")[0]
    head, _, tail = stem.partition("_")
    return head in ("y", "vy", "ay") or stem in ("v_m1", "u_m1", "u_m2", "node_y") or (head == "F" and tail[-1:] == "y")


def sequence(count: int) -> list[Any]:
    """Colours of `count` things in their order, dark to bright."""
    from matplotlib import colormaps

    return [colormaps[MAP](0.92 * k / max(count - 1, 1)) for k in range(count)]


def along_cable(axes: Axes, length: Floats) -> None:
    """An ordinate along the cable, its top above."""
    axes.set(ylabel="along the cable from its top [m]", ylim=(float(length.sum()), 0.0))
