"""A page with the stress grid as a heat map and a table; one file that needs no other."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from .files import replacing
from .pages import html_page
from .stress_table import COLUMNS, explained, made_with, plain, summary
from .stress_verdict import LIMIT, Row

__all__ = ["write_page"]

_SHOWN = (
    "case", "verdict", "solver", "n", "tolerance", "fmi", "steps", "seconds", "error", "ratio", "energy",
    "accelerations", "worse", "longer", "growth", "horizon", "references", "changed", "message",
)  # fmt: skip
_WIDE = {"changed": ' class="words"', "message": ' class="words"'}
_CELL, _LINE, _LEFT = 11, 14, 88
"""Pixels: a cell, a line of them, room for the groups' names."""
_SOLVERS = {"explicit": "#4a90c2", "implicit": "#e08a2e", "both": "#8e62a8"}
_NOTHING, _FAILED = "#cfcfcf", "#c00000"

_STYLE = """
table { font-size: 12px; } th, td { text-align: left; vertical-align: top; padding-right: .6rem; }
th { position: sticky; top: 0; background: var(--ground); }
tr.failed { background: var(--bad); }
td.words { white-space: normal; min-width: 14rem; max-width: 24rem; overflow-wrap: anywhere; }
.map { display: flex; flex-wrap: wrap; gap: 1rem 1.5rem; margin: 1.5rem 0; }
.map figure { margin: 0; overflow-x: auto; } .map figcaption { font-size: 13px; margin-bottom: .3rem; }
.map svg { display: block; fill: currentColor; }
.key { display: inline-block; width: .8em; height: .8em; margin: 0 .25em 0 .7em; vertical-align: -.05em; }
.ramp { width: 7em; margin: 0 .4em; }
"""


def write_page(rows: Sequence[Row], path: Path) -> Path:
    """Write the page.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    title = "Stiff and extreme cases"
    words = "".join(f"<p>{html.escape(text)}</p>\n" for text in explained())
    body = [f"<h1>{title}</h1>", f"<p><b>{html.escape(summary(rows))}</b></p>", words, _heat_map(rows), _table(rows)]
    page = html_page(title, body, style=_STYLE, made_with=made_with())
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def _table(rows: Sequence[Row]) -> str:
    value = dict(COLUMNS)
    lines = ["<table><thead><tr>" + "".join(f"<th>{name}</th>" for name in _SHOWN) + "</tr></thead><tbody>"]
    for row in rows:
        cells = "".join(f"<td{_WIDE.get(name, '')}>{_cell(value[name](row))}</td>" for name in _SHOWN)
        lines.append(f'<tr class="{"" if row.passed else "failed"}">{cells}</tr>')
    return "\n".join([*lines, "</tbody></table>\n"])


def _cell(value: object) -> str:
    return plain(value, ".3g") if isinstance(value, float) else html.escape(str(value))


@dataclass(frozen=True)
class _Panel:
    """One figure of every case: its heading (HTML), colour and words."""

    heading: str
    colour: Callable[[Row], str]
    words: Callable[[Row], str]


def _steps(row: Row) -> float:
    return row.figures.get("steps", math.nan)


def _heat(name: str, low: str, high: str) -> str:
    """A heading with the colours from one number to the other."""
    stops = ", ".join(_shade(10.0**share, 1.0, 10.0) for share in (0.0, 0.25, 0.5, 0.75, 1.0))
    ramp = f'<span class="key ramp" style="background: linear-gradient(to right, {stops})"></span>'
    return f"{name} &ensp;{low}{ramp}{high}"


def _keys(colours: Mapping[str, str]) -> str:
    return "".join(f'<span class="key" style="background: {colour}"></span>{name}' for name, colour in colours.items())


def _panels() -> tuple[_Panel, ...]:
    return (
        _Panel(f"solver {_keys({**_SOLVERS, 'did not run': _NOTHING})}", lambda r: _SOLVERS.get(r.solver, _NOTHING),
               lambda r: r.solver),
        _Panel(_heat("steps", "1", "1e6"), lambda r: _shade(_steps(r), 1.0, 1e6), lambda r: f"{_steps(r):,.0f} steps"),
        _Panel(_heat("time", "1 ms", f"{LIMIT:g} s"), lambda r: _shade(r.seconds, 1e-3, LIMIT),
               lambda r: f"{r.seconds:.3g} s"),
        _Panel(_heat("error / allowed", "1e-6", "1"), lambda r: _shade(r.ratio, 1e-6, 1.0),
               lambda r: f"{r.ratio:.2g} of the allowed"),
        _Panel(_heat("energy balance / allowed", "1e-6", "1"), lambda r: _shade(r.energy, 1e-6, 1.0),
               lambda r: f"off by {r.energy:.2g} of the allowed"),
        _Panel(_heat("accelerations / allowed", "1e-6", "1"), lambda r: _shade(r.accelerations, 1e-6, 1.0),
               lambda r: f"off by {r.accelerations:.2g} of the allowed"),
    )  # fmt: skip


def _heat_map(rows: Sequence[Row]) -> str:
    """A line per group of the grid; in every panel a cell per case, with its name and number under the pointer."""
    groups = [(name, list(members)) for name, members in groupby(rows, lambda row: row.case.group)]
    width = _LEFT + max(len(members) for _, members in groups) * _CELL + 2
    height = len(groups) * _LINE + 2
    parts = ['<div class="map">']
    for panel in _panels():
        parts.append(f"<figure><figcaption>{panel.heading}</figcaption>")
        parts.append(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-size="11" '
            'font-family="sans-serif">'
        )
        for line, (group, members) in enumerate(groups):
            y = 1 + line * _LINE
            parts.append(f'<text x="{_LEFT - 6}" y="{y + 9}" text-anchor="end">{html.escape(group)}</text>')
            parts += [_square(_LEFT + i * _CELL, y, panel, row) for i, row in enumerate(members)]
        parts.append("</svg></figure>")
    return "\n".join([*parts, "</div>"])


def _square(x: int, y: int, panel: _Panel, row: Row) -> str:
    edge = "" if row.passed else f' stroke="{_FAILED}" stroke-width="2"'
    words = html.escape(f"{row.case.name}: {panel.words(row)}, {row.verdict}")
    size = f'width="{_CELL - 1}" height="{_CELL - 1}"'
    return f'<rect x="{x}" y="{y}" {size} fill="{panel.colour(row)}"{edge}><title>{words}</title></rect>'


def _shade(value: float, low: float, high: float) -> str:
    """From light green to dark blue, by the logarithm; grey where there is no number."""
    if math.isnan(value):
        return _NOTHING
    share = math.log(min(max(value, low), high) / low) / math.log(high / low)
    return f"hsl({90 + 150 * share:.0f}, 55%, {88 - 62 * share:.0f}%)"
