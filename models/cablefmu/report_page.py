"""A report as one page: HTML with its figures inside, which needs neither network nor scripts."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from .pages import html_page
from .report import Report, made_on
from .report_figures import figures
from .report_tables import Sheet, sheets

__all__ = ["index_page", "page", "page_of"]

_STYLE = """
th, td { text-align: right; } tr > :first-child { text-align: left; }
.words td { text-align: left; white-space: normal; } .words td:first-child { font-weight: 600; min-width: 8rem; }
figure { margin: 0; background: #fff; border-radius: 4px; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); gap: 1rem; }
svg { width: 100%; height: auto; display: block; }
"""


def page(report: Report) -> str:
    """The page of one scene."""
    return page_of(report.scene.name, report.scene.description, sheets(report), figures(report))


def page_of(name: str, description: str, tables: Sequence[Sheet], drawn: Sequence[str]) -> str:
    """A page of tables, the first of which is of words, and figures, each the text of one <svg> element."""
    first, *rest = tables
    body = [
        f"<h1>{escape(name)}: how wrong, how fast</h1>",
        f"<p>{escape(description)}</p>",
        _table(first, "words"),
        "<h2>Figures</h2>",
        '<div class="figures">' + "\n".join(f"<figure>{svg}</figure>" for svg in drawn) + "</div>",
        *(_table(sheet, "numbers") for sheet in rest),
    ]
    return _html(f"{name}: how wrong, how fast", body)


def index_page(sheet: Sheet, links: Sequence[str]) -> str:
    """The table of all scenes, each name leading to its page."""
    return _html("All scenes: how wrong, how fast", ["<h1>How wrong, how fast</h1>", _table(sheet, "numbers", links)])


def _html(title: str, body: Sequence[str]) -> str:
    return html_page(title, body, style=_STYLE, made_with=made_on())


def _table(sheet: Sheet, kind: str, links: Sequence[str] = ()) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in sheet.head)
    rows = "\n".join(f"<tr>{_cells(row, links[k] if links else '')}</tr>" for k, row in enumerate(sheet.rows))
    note = f'<p class="note">{escape(sheet.note)}</p>' if sheet.note else ""
    top = f"<thead><tr>{head}</tr></thead>" if any(sheet.head) else ""
    return f'<h2>{escape(sheet.title)}</h2>\n<table class="{kind}">{top}\n<tbody>\n{rows}\n</tbody></table>\n{note}'


def _cells(row: Sequence[str], link: str) -> str:
    first = f'<a href="{escape(link)}">{escape(row[0])}</a>' if link else escape(row[0])
    return f"<td>{first}</td>" + "".join(f"<td>{escape(cell)}</td>" for cell in row[1:])
