"""A report as one page: HTML with its figures inside, which needs neither network nor scripts."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from .report import Report, made_on
from .report_figures import figures
from .report_tables import Sheet, sheets

__all__ = ["index_page", "page"]

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1c2530; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; display: block; overflow-x: auto; }
th, td { padding: .2rem .8rem .2rem 0; border-bottom: 1px solid #dfe4ea; text-align: right; white-space: nowrap; }
th { font-weight: 600; vertical-align: bottom; } tr > :first-child { text-align: left; }
.words td { text-align: left; white-space: normal; } .words td:first-child { white-space: nowrap; font-weight: 600; }
figure { margin: 0; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr)); gap: 1rem; }
svg { width: 100%; height: auto; } p.note, footer { color: #5a6573; max-width: 60rem; }
"""


def page(report: Report) -> str:
    """The page of one scene."""
    first, *rest = sheets(report)
    drawn = "\n".join(f"<figure>{svg}</figure>" for svg in figures(report))
    body = [
        f"<h1>{escape(report.scene.name)}: how wrong, how fast</h1>",
        f"<p>{escape(report.scene.description)}</p>",
        _table(first, "words"),
        "<h2>Figures</h2>",
        f'<div class="figures">{drawn}</div>',
        *(_table(sheet, "numbers") for sheet in rest),
    ]
    return _html(f"{report.scene.name}: how wrong, how fast", body)


def index_page(sheet: Sheet, links: Sequence[str]) -> str:
    """The table of all scenes, each name leading to its page."""
    return _html("All scenes: how wrong, how fast", ["<h1>How wrong, how fast</h1>", _table(sheet, "numbers", links)])


def _html(title: str, body: Sequence[str]) -> str:
    content = "\n".join(body)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title>
<style>{_STYLE}</style>
</head>
<body>
{content}
<footer><p>{escape(made_on())}</p></footer>
</body>
</html>
"""


def _table(sheet: Sheet, kind: str, links: Sequence[str] = ()) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in sheet.head)
    rows = "\n".join(f"<tr>{_cells(row, links[k] if links else '')}</tr>" for k, row in enumerate(sheet.rows))
    note = f'<p class="note">{escape(sheet.note)}</p>' if sheet.note else ""
    top = f"<thead><tr>{head}</tr></thead>" if any(sheet.head) else ""
    return f'<h2>{escape(sheet.title)}</h2>\n<table class="{kind}">{top}\n<tbody>\n{rows}\n</tbody></table>\n{note}'


def _cells(row: Sequence[str], link: str) -> str:
    first = f'<a href="{escape(link)}">{escape(row[0])}</a>' if link else escape(row[0])
    return f"<td>{first}</td>" + "".join(f"<td>{escape(cell)}</td>" for cell in row[1:])
