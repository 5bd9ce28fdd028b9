"""Pictures of the cable: its shape at regular times in one figure, as the dissertation draws it."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .cable import Cable, Floats, Top
from .errors import OptionError
from .files import check_writable, replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["check_picture", "draw_frames", "need_matplotlib", "node_positions", "picture_needs", "plot_frames"]


def node_positions(result: xr.Dataset) -> tuple[Floats, Floats]:
    """Positions of P_0 ... P_n over time from recorded angles.

    Parameters
    ----------
    result
        With `theta` over (time, link) and where the top is, as `simulate(..., record=picture_needs(cable))` gives them.

    Returns
    -------
    x, y
        Each of shape (times, n + 1) [m]; P_0 = (x_m1, y_m1) or (x_1, y_1), P_i = P_{i-1} + l_i (sin th_i, cos th_i).
    """
    length, theta = result["link_length"].values, result["theta"].values
    nothing = np.zeros(len(theta))
    x, y = (
        next((result[name].values for name in names if name in result), nothing)[:, None]
        + np.hstack([nothing[:, None], np.cumsum(length * along(theta), axis=1)])
        for names, along in ((("x_m1", "x_1"), np.sin), (("y_m1", "y_1"), np.cos))
    )
    return x, y


def picture_needs(cable: Cable) -> tuple[str, ...]:
    """What a run must record for its picture: link angles and where the top is."""
    top = {Top.FLOATER: ("y_m1",), Top.FREE: ("x_m1", "y_m1"), Top.MOTION: ("x_1", "y_1")}[cable.top]
    return ("theta", *top)


def plot_frames(result: xr.Dataset, path: Path, interval: float) -> None:
    """Draw the cable every `interval` seconds into one picture.

    Parameters
    ----------
    result
        With link angles and the top, see `node_positions`.
    path
        Picture to write; the suffix says of which kind (.png, .svg, .pdf).
    interval
        Time between two shapes [s].

    Raises
    ------
    OptionError
        If matplotlib is not installed, knows no such suffix, or the file cannot be written.
    """
    figure = draw_frames(result, interval)
    check_picture(path)
    with replacing(path) as temporary:
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


def need_matplotlib() -> None:
    if importlib.util.find_spec("matplotlib") is None:
        raise OptionError("a picture needs matplotlib: pip install 'cablefmu[plot]'")


def draw_frames(result: xr.Dataset, interval: float) -> Figure:
    """The picture that `plot_frames` writes, as a figure of matplotlib.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    need_matplotlib()
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 6), layout="constrained")
    axes = figure.add_subplot()
    x, y = node_positions(result)
    times = result["time"].values
    frames = _frames(times, interval)
    colors = colormaps["viridis"](np.linspace(0.0, 0.92, len(frames)))
    for color, k in zip(colors, frames, strict=True):
        axes.plot(x[k], y[k], color=color, linewidth=1.0)
        axes.plot(x[k, :1], y[k, :1], "s", color=color, markersize=5)
        axes.plot(x[k, -1:], y[k, -1:], "o", color=color, markersize=4)
    axes.set(xlabel="x [m], to the right", ylabel="y [m], down", title=_title(result, times, interval))
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_yaxis()
    axes.grid(alpha=0.3)
    return figure


def _title(result: xr.Dataset, times: Floats, interval: float) -> str:
    return f"{result.attrs['title']}: every {interval:g} s from t = {times[0]:g} s (dark) to {times[-1]:g} s (bright)"


def _frames(times: Floats, interval: float) -> list[int]:
    """Indices of the output times nearest to 0, interval, 2 interval, ..., each once."""
    wanted = np.arange(times[0], times[-1] + 0.5 * interval, interval)
    return sorted({int(np.argmin(np.abs(times - t))) for t in wanted})
