"""A page with the stress grid as a heat map and a table; one file that needs no other."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from .files import replacing
from .stress_table import COLUMNS, explained, made_with, plain, summary
from .stress_verdict import LIMIT, Row

__all__ = ["write_page"]

_SHOWN = (
    "case", "changed", "fmi", "n", "tolerance", "solver", "steps", "seconds", "error", "ratio", "growth", "horizon",
    "verdict", "references", "message",
)  # fmt: skip
_CELL, _LINE, _LEFT, _TOP, _GAP = 11, 14, 110, 34, 24
"""Pixels: a cell, a line of them, room for the groups' names, for the headings, between panels."""
_SOLVERS = {"explicit": "#4a90c2", "implicit": "#e08a2e", "both": "#8e62a8"}
_NOTHING, _FAILED = "#cfcfcf", "#c00000"

_STYLE = """
body { font: 14px sans-serif; margin: 2em; color: #222; }
p { max-width: 60em; }
table { border-collapse: collapse; font-size: 12px; }
td, th { padding: 2px 6px; border-bottom: 1px solid #ddd; text-align: left; }
tr.failed { background: #fbdcdc; }
td:nth-child(2) { max-width: 30em; overflow-wrap: anywhere; }
"""


def write_page(rows: Sequence[Row], path: Path) -> Path:
    """Write the page.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    words = "".join(f"<p>{html.escape(text)}</p>\n" for text in (made_with(), summary(rows), *explained()))
    page = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Stiff and extreme cases</title>\n'
        f"<style>{_STYLE}</style></head><body>\n<h1>Stiff and extreme cases</h1>\n{words}{_heat_map(rows)}\n"
        f"{_table(rows)}"
        "</body></html>\n"
    )
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def _table(rows: Sequence[Row]) -> str:
    value = dict(COLUMNS)
    lines = ["<table><thead><tr>" + "".join(f"<th>{name}</th>" for name in _SHOWN) + "</tr></thead><tbody>"]
    for row in rows:
        cells = "".join(f"<td>{_cell(value[name](row))}</td>" for name in _SHOWN)
        lines.append(f'<tr class="{"" if row.passed else "failed"}">{cells}</tr>')
    return "\n".join([*lines, "</tbody></table>\n"])


def _cell(value: object) -> str:
    return plain(value, ".3g") if isinstance(value, float) else html.escape(str(value))


@dataclass(frozen=True)
class _Panel:
    """One figure of every case: its heading, colour and words."""

    heading: str
    colour: Callable[[Row], str]
    words: Callable[[Row], str]


def _steps(row: Row) -> float:
    return row.figures.get("steps", math.nan)


_PANELS = (
    _Panel("solver: explicit, implicit, both", lambda r: _SOLVERS.get(r.solver, _NOTHING), lambda r: r.solver),
    _Panel("steps: 1 to 1e6", lambda r: _shade(_steps(r), 1.0, 1e6), lambda r: f"{_steps(r):,.0f} steps"),
    _Panel(f"time: 1 ms to {LIMIT:g} s", lambda r: _shade(r.seconds, 1e-3, LIMIT), lambda r: f"{r.seconds:.3g} s"),
    _Panel(
        "error / allowed: 1e-6 to 1", lambda r: _shade(r.ratio, 1e-6, 1.0), lambda r: f"{r.ratio:.2g} of the allowed"
    ),
)


def _heat_map(rows: Sequence[Row]) -> str:
    """A line per group of the grid; in every panel a cell per case, with its name and number under the pointer."""
    groups = [(name, list(members)) for name, members in groupby(rows, lambda row: row.case.group)]
    across = max(len(members) for _, members in groups) * _CELL + _GAP
    across = max(across, 190)  # room for the headings
    width, height = _LEFT + len(_PANELS) * across, _TOP + len(groups) * _LINE + 10
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-size="11">']
    for k, panel in enumerate(_PANELS):
        parts.append(f'<text x="{_LEFT + k * across}" y="{_TOP - 10}">{html.escape(panel.heading)}</text>')
    for line, (group, members) in enumerate(groups):
        y = _TOP + line * _LINE
        parts.append(f'<text x="{_LEFT - 8}" y="{y + 9}" text-anchor="end">{html.escape(group)}</text>')
        for k, panel in enumerate(_PANELS):
            parts += [_square(_LEFT + k * across + i * _CELL, y, panel, row) for i, row in enumerate(members)]
    return "\n".join([*parts, "</svg>"])


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
