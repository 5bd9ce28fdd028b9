"""The page of the gallery: every figure with what one sees, its parameters, run time and error, in one file."""

from __future__ import annotations

import base64
import io
import tomllib
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any

from .files import replacing
from .fmu.table import table
from .gallery import TIGHTER, VISIBLE, Error, Exhibit, Shown, what_to_see
from .pages import html_page
from .plot import draw
from .plot_style import style
from .provenance import version_text
from .scene import Scene

__all__ = ["error_text", "write_gallery"]

_STYLE = """
figure { margin: 0; } img { max-width: 100%; height: auto; background: #fff; border-radius: 4px; }
section { border-top: 1px solid var(--line); margin-top: 2rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; max-width: 60rem; }
dt { color: var(--faint); } dd { margin: 0; } nav a { margin-right: .8rem; white-space: nowrap; }
@media (max-width: 40rem) { dl { grid-template-columns: 1fr; } dd { margin-bottom: .5rem; } }
"""

_ABOUT = (
    "Every figure of the dissertation's chapter 6 with results, computed anew from the scenes that ship. The print's "
    "own pictures were not at hand, so the shapes at the start, which each scene file states, are ours."
)


def write_gallery(shown: Sequence[Shown], folder: Path) -> Path:
    """Write index.html, which needs no other file; returns its path.

    Raises
    ------
    OptionError
        If matplotlib is not installed, or the file cannot be written.
    """
    links = (f'<a href="#{_anchor(one)}">{escape(one.exhibit.number)}</a>' for one in shown)
    body = [
        "<h1>Figures 6.1 to 6.17</h1>",
        f"<p>{escape(_ABOUT)}</p>",
        f"<nav>{''.join(links)}</nav>",
        *(line for one in shown for line in _section(one)),
    ]
    page = html_page("cablefmu gallery", body, style=_STYLE, made_with=version_text())
    path = folder / "index.html"
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def _anchor(shown: Shown) -> str:
    return f"figure-{shown.exhibit.number.replace('.', '-')}"


def _section(shown: Shown) -> Iterator[str]:
    exhibit, scene = shown.exhibit, shown.scene
    yield f'<section id="{_anchor(shown)}">'
    yield f"<h2>Figure {escape(exhibit.number)}: {escape(scene.description)}</h2>"
    yield f'<figure><img alt="{escape(_alternative(shown))}" src="data:image/png;base64,{_picture(shown)}"></figure>'
    yield "<dl>"
    for term, text in _told(shown).items():
        yield f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>"
    yield "</dl></section>"


def _alternative(shown: Shown) -> str:
    exhibit = shown.exhibit
    what = f"the cable every {exhibit.interval:g} s" if exhibit.interval else f"{', '.join(exhibit.names)} over time"
    return f"{exhibit.scene}: {what}"


def _picture(shown: Shown) -> str:
    """PNG in base64."""
    exhibit, content = shown.exhibit, io.BytesIO()
    figure = draw(shown.result, exhibit.kind, names=exhibit.names, interval=exhibit.interval)
    with style():
        figure.savefig(content, format="png", dpi=110)
    return base64.b64encode(content.getvalue()).decode("ascii")


def _told(shown: Shown) -> dict[str, str]:
    """What stands under a figure."""
    result, exhibit = shown.result, shown.exhibit
    end, run_time = float(result["time"].values[-1]), float(result.attrs["run_time"])
    told = {
        "the same by": _command(exhibit),
        "what one sees": what_to_see(shown.scene),
        "parameters": parameters_text(shown.scene),
        "inputs": inputs_text(shown.scene),
        "run time": f"{run_time:.3g} s for {end:g} s, {end / run_time:,.0f} times faster than real time "
        f"(tolerance {result.attrs['tolerance']:g})",
        "error": error_text(shown.error),
    }
    if exhibit.note:
        told["note"] = exhibit.note
    if "ended_early" in result.attrs:
        told["ended early"] = f"at t = {end:g} s: {result.attrs['ended_early']}"
    return told


def _command(exhibit: Exhibit) -> str:
    """What makes this picture on the command line."""
    if not exhibit.names:
        return f"cablefmu run {exhibit.scene} --plot {exhibit.scene}.png"
    run = f"cablefmu run {exhibit.scene} --record theta"
    return f"{run} && cablefmu plot build/{exhibit.scene}.csv --kind {exhibit.kind} --names {','.join(exhibit.names)}"


def error_text(error: Error | None) -> str:
    """In words."""
    if error is None:
        return "not known: the run at a tighter tolerance ended earlier"
    text = (
        f"{error.largest:.2g} m at most, any point at any time, against a run at a tolerance {TIGHTER:g} times tighter"
    )
    if error.visible_from is None:
        return text
    return f"{text}; below {1e3 * VISIBLE:g} mm before t = {error.visible_from:g} s"


def parameters_text(scene: Scene) -> str:
    """The cable and its ends in numbers."""
    cable, rows = scene.cable, table().parameters
    parts = [f"n = {cable.n} links", f"L = {cable.links.length.sum():.6g} m"]
    for name, value in cable.parameters.items():
        unit = "" if rows[name].unit == "1" else f" {rows[name].unit}"
        parts.append(f"{name} = {value:.6g}{unit}")
    return ", ".join(parts)


def inputs_text(scene: Scene) -> str:
    """The forces as the scene file has them."""
    given: dict[str, Any] = tomllib.loads(scene.text).get("inputs", {})
    texts = [f"{name}: {_signal(value)}" for name, value in given.items()]
    return "; ".join(texts) or "none"


def _signal(value: object) -> str:
    if not isinstance(value, dict):
        return f"{value}"
    more = (f"{key} {', '.join(map(str, of)) if isinstance(of, list) else of}" for key, of in value.items())
    return ", ".join(text.removeprefix("signal ") for text in more)
