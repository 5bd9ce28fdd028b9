"""The drawing itself, as Bokeh describes it: axes, water, and for every run its cable and its ends.

Bokeh, because it is kept, comes as one script from PyPI with its licence in it, and zooms and pans under mouse and
fingers.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from ..errors import OptionError
from ..plot_style import COLORS
from .motion import Extent, Motion

__all__ = ["MARKERS", "RUN_COLORS", "WATER", "bokeh_script", "bokeh_version", "figure_json", "need_bokeh", "palette"]

MARKERS = {"floater": "square", "vessel": "inverted_triangle", "load": "circle", "anchor": "triangle"}
"""How what is at an end is drawn, in Bokeh's words."""
RUN_COLORS = COLORS[:2]
"""Of the first and the second run."""
WATER = "#4aa3e0"
_FIRST, _LAST, _EVERY = 40, 250, 6
"""Of viridis the part that is seen on light and dark ground alike."""


def need_bokeh() -> None:
    if importlib.util.find_spec("bokeh") is None:
        raise OptionError("a page that moves needs Bokeh: pip install 'cablefmu[view]'")


def bokeh_version() -> str:
    return version("bokeh")


def bokeh_script() -> str:
    """Bokeh's own script, whole, as it ships in its package."""
    from bokeh.resources import Resources

    return str(Resources(mode="inline", components=["bokeh"]).js_raw[0])


def palette() -> list[str]:
    from bokeh.palettes import Viridis256

    return list(Viridis256[_FIRST:_LAST:_EVERY])


def figure_json(motions: Sequence[Motion], extent: Extent, tensions: tuple[float, float] | None) -> dict[str, Any]:
    """The figure as JSON for `Bokeh.embed.embed_item`.

    The script that plays finds its parts by name: `plot`; for run k = 0, 1 the sources `nodes{k}`, `links{k}`,
    `ends{k}`, and of what is drawn `line{k}`, `pulls{k}`.
    """
    from bokeh.embed import json_item
    from bokeh.models import BoxAnnotation, LinearColorMapper, PanTool, Range1d, Span, WheelZoomTool
    from bokeh.plotting import figure

    zoom = WheelZoomTool(zoom_on_axis=False)  # both axes alike, wherever the pointer is
    plot = figure(
        name="plot",
        x_range=Range1d(extent.left, extent.right),
        y_range=Range1d(extent.bottom, extent.top),
        x_axis_label="x [m], to the right",
        y_axis_label="y [m], down",
        tools=[PanTool(), zoom],
        active_scroll=zoom,
        toolbar_location=None,
        sizing_mode="stretch_both",
        background_fill_color=None,
        border_fill_color=None,
        outline_line_color=None,
        lod_threshold=None,
    )
    plot.min_border_left, plot.min_border_right = 64, 12  # room for the axis' numbers, however long: the frame stays
    if any(motion.in_water for motion in motions):
        body = {"fill_color": WATER, "fill_alpha": 0.1, "line_color": None}
        plot.add_layout(BoxAnnotation(top=_DEEP, bottom=0.0, level="underlay", **body))
        plot.add_layout(Span(location=0.0, dimension="width", level="underlay", line_color=WATER, line_width=1.5))
    low, high = tensions or (0.0, 1.0)
    colors = {"field": "tension", "transform": LinearColorMapper(palette=palette(), low=low, high=high)}
    for k in reversed(range(len(motions))):  # the first run is drawn last, above the other
        _draw_run(plot, k, colors)
    return dict(json_item(plot, "plot"))


_DEEP = 1e6
"""As far down as anybody zooms out [m]."""


def _draw_run(plot: Any, k: int, colors: dict[str, Any]) -> None:
    """Empty sources and what is drawn of them; the script fills them."""
    from bokeh.models import ColumnDataSource

    nodes = ColumnDataSource({"x": [], "y": []}, name=f"nodes{k}")
    links = ColumnDataSource({name: [] for name in ("x0", "y0", "x1", "y1", "tension")}, name=f"links{k}")
    ends = ColumnDataSource({"x": [], "y": [], "marker": []}, name=f"ends{k}")
    color = RUN_COLORS[k]
    plot.line("x", "y", source=nodes, name=f"line{k}", line_color=color, line_width=3, line_join="round")
    plot.segment(
        "x0", "y0", "x1", "y1", source=links, name=f"pulls{k}", line_color=colors, line_width=3, line_cap="round"
    )
    plot.scatter(
        "x", "y", marker="marker", source=ends, size=13, fill_color=color, line_color="#ffffff", line_width=1.5
    )
