"""Pictures of results: every kind by its name, drawn as a figure of matplotlib or written to a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import xarray as xr

from .along import node_positions, picture_needs
from .errors import OptionError
from .files import check_writable, replacing
from .plot_envelope import draw_envelope
from .plot_frames import draw_frames
from .plot_series import draw_series
from .plot_spectrum import draw_spectrum
from .plot_style import need_matplotlib, style
from .plot_tension import draw_tension

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "KINDS", "Kind", "check_picture", "draw", "need_matplotlib", "node_positions", "picture_needs", "write_plot",
]  # fmt: skip

Kind = Literal["frames", "series", "tension", "envelope", "spectrum"]

KINDS: dict[str, tuple[str, ...]] = {
    "frames": ("nodes",),
    "series": (),
    "tension": ("tensions",),
    "envelope": ("nodes", "tensions"),
    "spectrum": (),
}
"""What a run must record for each kind of picture, beside the variables that are named."""

_NAMED = ("series", "spectrum")
_SHAPES = 30
"""In a picture of a result that does not say how far its shapes are apart."""


def draw(
    result: xr.Dataset, kind: str = "frames", *, names: Sequence[str] = (), interval: float | None = None
) -> Figure:
    """Draw a picture of a result.

    Parameters
    ----------
    result
        As `simulate`, `couple` or `open_result` return it; also of a run that ended early, which the title says.
    kind
        "frames": the cable's shape at regular times. "series": variables over time. "tension": the pull along the cable
        over time. "envelope": how far every point gets, and between which pulls. "spectrum": power spectral densities.
    names
        Of variables, for series and spectrum, or a single one; all outputs by default.
    interval
        Between two shapes of frames [s]; the scene's by default.

    Raises
    ------
    OptionError
        If matplotlib is not installed, or the result does not hold what is to be drawn.
    """
    if kind not in KINDS:
        raise OptionError(f"kind = {kind!r}: one of {', '.join(KINDS)} is expected")
    if names and kind not in _NAMED:
        raise OptionError(f"names: a picture of {kind} has none; {' and '.join(_NAMED)} have")
    if interval is not None and kind != "frames":
        raise OptionError(f"interval = {interval}: only a picture of frames has one")
    _check_held(result, kind)
    names = [names] if isinstance(names, str) else names
    with style():
        if kind == "frames":
            return draw_frames(result, _interval(result) if interval is None else interval)
        if kind in _NAMED:
            return draw_series(result, names) if kind == "series" else draw_spectrum(result, names)
        return draw_tension(result) if kind == "tension" else draw_envelope(result)


def _check_held(result: xr.Dataset, kind: str) -> None:
    held = {
        "nodes": {"node_x", "node_y"} <= set(result) or ("theta" in result and "link_length" in result),
        "tensions": "tension" in result,
    }
    needed = KINDS[kind] if kind != "envelope" else ("nodes",)
    for name in needed:
        if not held[name]:
            held_by = f"a run with --record {' '.join(KINDS[kind])} does"
            if "coupling" in result.attrs:
                held_by = "results of couplings have pictures of kind series and spectrum"
            raise OptionError(f"a picture of {kind} needs {name}, which this result does not hold; {held_by}")
    if not result.sizes.get("time"):
        raise OptionError("this result holds no output time, and so nothing to draw")


def _interval(result: xr.Dataset) -> float:
    times = result["time"].values
    return float(result.attrs.get("frame_interval", 0.0)) or float(times[-1] - times[0]) / _SHAPES or 1.0


def write_plot(
    result: xr.Dataset, path: Path, kind: str = "frames", *, names: Sequence[str] = (), interval: float | None = None
) -> None:
    """Draw a picture into a file, whose suffix says of which format (.png, .svg, .pdf); the rest as for `draw`.

    Raises
    ------
    OptionError
        As `draw`, and if matplotlib knows no such suffix, or the file cannot be written.
    """
    figure = draw(result, kind, names=names, interval=interval)
    check_picture(path)
    with style(), replacing(path) as temporary:
        figure.savefig(temporary, format=path.suffix.removeprefix("."), dpi=120)


def check_picture(path: Path) -> None:
    """Find out before a run whether its picture can be made.

    Raises
    ------
    OptionError
        If matplotlib is not installed, knows no such suffix, or the folder is not writable.
    """
    need_matplotlib()
    from matplotlib.backend_bases import FigureCanvasBase

    kinds = FigureCanvasBase.get_supported_filetypes()
    if path.suffix.removeprefix(".") not in kinds:
        allowed = ", ".join(f".{kind}" for kind in sorted(kinds))
        raise OptionError(f"plot = {path}: a name that ends with one of {allowed} is expected")
    check_writable(path)
