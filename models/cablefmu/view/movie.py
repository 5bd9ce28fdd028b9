"""The moving cable as a movie: GIF by Pillow, MP4 by ffmpeg, drawn by matplotlib."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..cable import Floats
from ..errors import OptionError
from ..files import check_writable, replacing
from ..plot_style import MAP, need_matplotlib, new_figure, style
from .figure import RUN_COLORS, WATER
from .motion import Motion, check_number, extent_of, tension_range

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

__all__ = ["MOVIES", "check_movie", "movie_times", "write_movie"]

MOVIES = (".gif", ".mp4")
_RATE = 20
"""Pictures in a second of movie; GIF counts in hundredths of a second, and 20 is a whole number of them."""
_MOST = 3000
"""Pictures in a movie: 2.5 minutes."""
_MARKERS = {"floater": "s", "vessel": "v", "load": "o", "anchor": "^"}
_FFMPEG: dict[str, Any] = {"fps": _RATE, "codec": "libx264", "extra_args": ["-pix_fmt", "yuv420p"]}
"""What every player shows."""


def check_movie(path: Path) -> None:
    """Find out before long work whether its movie can be made.

    Raises
    ------
    OptionError
        If what makes it is not installed, or the folder is not writable.
    """
    need_matplotlib()
    if path.suffix == ".mp4" and importlib.util.find_spec("imageio_ffmpeg") is None:
        raise OptionError("a movie as MP4 needs ffmpeg: pip install 'cablefmu[movie]'; a .gif does not")
    check_writable(path)


def movie_times(motions: Sequence[Motion], speed: float) -> Floats:
    """Moments that the pictures show, of the runs' time [s].

    Raises
    ------
    OptionError
        If the speed is not positive, or there would be too many pictures.
    """
    start, end = min(m.time[0] for m in motions), max(m.time[-1] for m in motions)
    if not (speed > 0.0 and np.isfinite(speed)):
        raise OptionError(f"speed = {speed}: a positive number is expected")
    pictures = (end - start) * _RATE / speed + 1.0
    if pictures > _MOST:
        slowest = (end - start) * _RATE / _MOST
        raise OptionError(
            f"speed = {speed:g}: {pictures:.0f} pictures, and a movie has {_MOST} at most; "
            f"{slowest:.2g} or more is expected"
        )
    return np.append(np.arange(start, end, speed / _RATE), end)


def write_movie(motions: Sequence[Motion], path: Path, speed: float = 1.0) -> None:
    """Write the movie of one run, or of two in one picture.

    Parameters
    ----------
    motions
        The runs; a run that is over stands still.
    path
        FILE.gif or FILE.mp4.
    speed
        Seconds of the run in one second of movie.

    Raises
    ------
    OptionError
        If there are more, what makes it is not installed, the speed cannot be, or the file cannot be written.
    """
    check_movie(path)
    check_number(motions)
    times = movie_times(motions, speed)
    from matplotlib import rc_context

    with style(), rc_context(_where_ffmpeg_is(path)), replacing(path) as temporary:
        picture = Picture(motions)
        named = temporary.with_suffix(path.suffix)  # writers go by it
        try:
            picture.settle(times[0])
            writer = _writer(path)
            with writer.saving(picture.figure, str(named), dpi=100):
                for t in times:
                    picture.show(t)
                    writer.grab_frame()
            named.replace(temporary)
        finally:
            named.unlink(missing_ok=True)


def _where_ffmpeg_is(path: Path) -> dict[Any, Any]:
    if path.suffix != ".mp4":
        return {}
    import imageio_ffmpeg

    return {"animation.ffmpeg_path": imageio_ffmpeg.get_ffmpeg_exe()}


def _writer(path: Path) -> AbstractMovieWriter:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    return PillowWriter(fps=_RATE) if path.suffix == ".gif" else FFMpegWriter(**_FFMPEG)


class Picture:
    """A figure that shows the runs at any moment."""

    def __init__(self, motions: Sequence[Motion]) -> None:
        self.motions = motions
        self.figure, (self.axes,) = new_figure(size=(6.4, 5.6))
        self._frame()
        tensions = tension_range(motions) if len(motions) == 1 else None
        self.cables = [self._cable(RUN_COLORS[k], tensions) for k in range(len(motions))]
        self.ends = [self._ends(motion, RUN_COLORS[k]) for k, motion in enumerate(motions)]
        if len(motions) > 1:
            self.axes.legend(self.cables, [motion.name for motion in motions], loc="lower right")

    def _frame(self) -> None:
        extent = extent_of(self.motions)
        margin = 0.05 * max(extent.right - extent.left, extent.bottom - extent.top, 1.0)
        self.axes.set_xlim(extent.left - margin, extent.right + margin)
        self.axes.set_ylim(extent.bottom + margin, extent.top - margin)
        self.axes.set_aspect("equal", adjustable="box")
        self.axes.set(xlabel="x [m], to the right", ylabel="y [m], down")
        if any(motion.in_water for motion in self.motions):
            self.axes.axhspan(0.0, 1e6, color=WATER, alpha=0.10, linewidth=0)
            self.axes.axhline(0.0, color=WATER, linewidth=1.2)

    def _cable(self, color: str, tensions: tuple[float, float] | None) -> LineCollection:
        """Links one by one: of their tension's colour where there is one run alone, else of the run's."""
        from matplotlib.collections import LineCollection

        cable = LineCollection([], linewidths=2.0, capstyle="round", colors=color)
        if tensions is not None:
            cable = LineCollection([], linewidths=2.0, capstyle="round", cmap=MAP)
            cable.set_clim(*tensions)
            self.figure.colorbar(cable, ax=self.axes, label="tension [N]", extend="max")
        self.axes.add_collection(cable, autolim=False)
        return cable

    def _ends(self, motion: Motion, color: str) -> list[Line2D]:
        return [
            self.axes.plot([], [], _MARKERS[kind], color=color, markersize=8, markeredgecolor="white")[0]
            for kind in (motion.top, motion.end)
        ]

    def settle(self, t: float) -> None:
        """Lay it out once, for all pictures: nothing trembles, and none costs more than its drawing."""
        self.show(t)
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")

    def show(self, t: float) -> None:
        """Every run at the moment t [s], between recorded ones along straight lines, beyond its end as it ended."""
        for motion, cable, (top, end) in zip(self.motions, self.cables, self.ends, strict=True):
            x, y = along(motion.time, motion.x, t), along(motion.time, motion.y, t)
            nodes = np.column_stack([x, y])
            cable.set_segments(list(np.stack([nodes[:-1], nodes[1:]], axis=1)))
            if motion.tension is not None and cable.get_clim()[0] is not None:
                cable.set_array(along(motion.time, motion.tension, t))
            top.set_data(x[:1], y[:1])
            end.set_data(x[-1:], y[-1:])
        self.axes.set_title(f"{' and '.join(motion.name for motion in self.motions)}: t = {t:.2f} s{self._ended(t)}")

    def _ended(self, t: float) -> str:
        over = [motion for motion in self.motions if motion.ended_early and t >= motion.time[-1]]
        return "".join(f"\n{motion.name} ended early, at t = {motion.time[-1]:g} s" for motion in over)


def along(time: Floats, rows: Floats, t: float) -> Floats:
    """The row of the moment t, shape of one row."""
    k = int(np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 1))
    if k + 1 == len(time) or t <= time[k]:
        return np.asarray(rows[k])
    w = (t - time[k]) / (time[k + 1] - time[k])
    return np.asarray((1.0 - w) * rows[k] + w * rows[k + 1])
