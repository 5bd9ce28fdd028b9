"""The page: the moving cable, controls, numbers; one HTML file that needs no network and lets no foreign script run."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..files import check_writable, replacing
from ..pages import html_page
from .arrays import doubles, steps
from .figure import MARKERS, RUN_COLORS, bokeh_script, bokeh_version, figure_json, need_bokeh, palette
from .motion import Motion, check_number, extent_of, tension_range

__all__ = ["check_page", "view_page", "write_page"]

_SCRIPTS = ("runs.js", "stage.js", "player.js")
_SPEEDS = (0.1, 0.2, 0.5, 1, 2, 5, 10)
_KEYS = (
    ("Space", "play, pause"), ("← →", "one recorded moment back, on; with Shift ten"),
    ("Home End", "to the start, the end"), ("↑ ↓", "faster, slower"), ("+ −", "closer, wider"), ("0", "all of it"),
    ("T", "colours of tension"),
)  # fmt: skip


def check_page(path: Path) -> None:
    """Find out before a run whether its page can be made.

    Raises
    ------
    OptionError
        If Bokeh is not installed, or the folder is not writable.
    """
    need_bokeh()
    check_writable(path)


def write_page(motions: Sequence[Motion], path: Path) -> None:
    """Write the page of one run, or of two in one picture.

    Raises
    ------
    OptionError
        If there are more, Bokeh is not installed, or the file cannot be written.
    """
    page = view_page(motions)
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def view_page(motions: Sequence[Motion]) -> str:
    """The text of that page.

    It shows every recorded moment as it is and, while it plays, straight lines between one and the next. Scripts find
    `window.cablefmu` on it: `shape(run)` (time, x and y of all nodes as they are drawn), `view()`, `seek(t)`, `play()`,
    `pause()`, `isPlaying()` and `rate()`, pictures in a second.

    Raises
    ------
    OptionError
        If there are more than two, or Bokeh is not installed.
    """
    need_bokeh()
    check_number(motions)
    extent, tensions = extent_of(motions), tension_range(motions)
    scripts = [bokeh_script(), _script()]
    carried = {
        "figure": figure_json(motions, extent, tensions),
        "runs": [_carried(motion) for motion in motions],
        "extent": asdict(extent),
    }
    body = [
        *_heading(motions),
        '<div class="viewer">', _STAGE, _controls(tensions is not None, checked=len(motions) == 1),
        *_beside(motions, tensions), "</div>",
        "<noscript><p>This page plays by a script of its own; the browser has scripts switched off.</p></noscript>",
        *(f'<script type="application/json" id="{name}">{_json(what)}</script>' for name, what in carried.items()),
        f"<script>{scripts[0]}</script>", f'<script type="module">{scripts[1]}</script>',
    ]  # fmt: skip
    return html_page(
        f"{_names(motions)}: the moving cable",
        body,
        style=(files(__package__) / "view.css").read_text(encoding="utf-8"),
        made_with=f"{'; '.join(dict.fromkeys(motion.source for motion in motions))}; Bokeh {bokeh_version()}",
        head=[_policy(scripts)],
    )


def _script() -> str:
    folder = files(__package__)
    return "\n".join((folder / name).read_text(encoding="utf-8") for name in _SCRIPTS)


def _policy(scripts: Sequence[str]) -> str:
    """What the browser may run and fetch: these scripts alone, and nothing."""
    digests = (base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii") for script in scripts)
    allowed = " ".join(f"'sha256-{digest}'" for digest in digests)
    policy = f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data: blob:"
    return f'<meta http-equiv="Content-Security-Policy" content="{policy}">'


def _json(what: Any) -> str:
    """JSON that nothing in it can end the script element of."""
    return json.dumps(what, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _carried(motion: Motion) -> dict[str, Any]:
    return {
        "time": doubles(motion.time),
        "x": steps(motion.x),
        "y": steps(motion.y),
        "tension": None if motion.tension is None else steps(motion.tension),
        "values": [{"name": value.name, "values": doubles(value.values)} for value in motion.values],
        "top_marker": MARKERS[motion.top],
        "end_marker": MARKERS[motion.end],
    }


# --- what stands around the picture ---


_STAGE = """
<div class="stage" tabindex="0" role="group" aria-label="The cable: drag to move, wheel or pinch to zoom; keys below">
<div id="plot"></div><div id="rate" aria-hidden="true"></div>
</div>
"""


def _names(motions: Sequence[Motion]) -> str:
    return " and ".join(motion.name for motion in motions)


def _heading(motions: Sequence[Motion]) -> list[str]:
    lines = [f"<h1>{escape(_names(motions))}</h1>"]
    for k, motion in enumerate(motions):
        whose = f"{_swatch(k)} {escape(motion.name)}: " if len(motions) > 1 else ""
        lines.append(f"<p>{whose}{escape(motion.description)}</p>")
        if motion.ended_early:
            end = f"{motion.name} ended early, at t = {motion.time[-1]:g} s: {motion.ended_early}"
            lines.append(f'<p class="ended" id="ended-{k}">{escape(end)}</p>')
    return lines


def _swatch(k: int) -> str:
    return f'<span class="swatch" style="background:{RUN_COLORS[k]}"></span>'


def _controls(has_tensions: bool, *, checked: bool) -> str:
    """Two runs are told apart by colour, unless one asks for their tensions."""
    speeds = "".join(f'<option value="{s:g}"{" selected" * (s == 1)}>{s:g} ×</option>' for s in _SPEEDS)
    box = f'<label><input type="checkbox" id="colours"{" checked" * checked}> Tension</label>' if has_tensions else ""
    return f"""
<div class="controls" role="group" aria-label="Playing">
<button type="button" id="play">Play</button>
<input type="range" id="time" min="0" max="0" value="0" aria-label="Time"><output id="clock" for="time"></output>
<select id="speed" aria-label="Speed">{speeds}</select>
<button type="button" id="wider" aria-label="Zoom out">−</button>
<button type="button" id="closer" aria-label="Zoom in">+</button>
<button type="button" id="whole">All of it</button>
{box}
</div>
"""


def _beside(motions: Sequence[Motion], tensions: tuple[float, float] | None) -> list[str]:
    keys = "".join(f"<dt><kbd>{escape(key)}</kbd></dt><dd>{escape(does)}</dd>" for key, does in _KEYS)
    return [
        '<aside class="beside">', _values(motions), *([] if tensions is None else [_scale(*tensions)]), _ends(motions),
        f"<details><summary>Keys</summary><dl>{keys}</dl></details>", "</aside>",
    ]  # fmt: skip


def _values(motions: Sequence[Motion]) -> str:
    """A row for every value that any of the runs has, a column for every run."""
    shown = {value.name: value for motion in motions for value in motion.values}
    head = "".join(
        f'<th>{_swatch(k)}<span class="name" title="{escape(motion.name)}">{escape(motion.name)}</span></th>'
        for k, motion in enumerate(motions)
    )
    rows = "\n".join(
        f'<tr title="{escape(value.text)}"><th>{escape(name)} <span class="unit">[{escape(value.unit)}]</span></th>'
        + "".join(f'<td id="value-{escape(name)}-{k}"></td>' for k in range(len(motions)))
        + "</tr>"
        for name, value in shown.items()
    )
    times = '<td class="clock"></td>' * len(motions)
    return (
        f"<table><thead><tr><th></th>{head}</tr></thead>\n<tbody>\n"
        f"<tr><th>time</th>{times}</tr>\n{rows}\n</tbody></table>"
    )


def _scale(low: float, high: float) -> str:
    return f"""
<p>Tension [N]</p><div class="scale" style="background:linear-gradient(to right,{",".join(palette())})"></div>
<div class="ends"><span>{_short(low)}</span><span>{_short(high)} and more</span></div>
"""


def _short(number: float) -> str:
    """Four digits, without an exponent."""
    return f"{float(f'{number:.4g}'):.10g}"


_SIGNS = {"square": "■", "inverted_triangle": "▼", "circle": "●", "triangle": "▲"}


def _ends(motions: Sequence[Motion]) -> str:
    """What the signs at the ends are."""
    kinds = dict.fromkeys(kind for motion in motions for kind in (motion.top, motion.end))
    signs = " &nbsp; ".join(f"{_SIGNS[MARKERS[kind]]} {kind}" for kind in kinds)
    water = " &nbsp; — surface at y = 0" if any(motion.in_water for motion in motions) else ""
    return f"<p>{signs}{water}</p>"
