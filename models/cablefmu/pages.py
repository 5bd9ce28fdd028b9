"""Pages for people: one HTML file each, which needs neither network nor scripts, light or dark, on a phone as well."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

__all__ = ["html_page"]

_STYLE = """
:root { color-scheme: light dark; --ink: #1c2530; --faint: #5a6573; --line: #dfe4ea; --ground: #fff; --bad: #fbdcdc; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #dfe5ec; --faint: #9aa6b4; --line: #36404c; --ground: #151a20; --bad: #552222; }
  a { color: #7fb8ee; }
}
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--ground);
  max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
p { max-width: 60rem; } p.note, footer { color: var(--faint); }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; display: block; overflow-x: auto; }
th, td { padding: .2rem .8rem .2rem 0; border-bottom: 1px solid var(--line); white-space: nowrap; }
th { font-weight: 600; vertical-align: bottom; }
"""


def html_page(title: str, body: Sequence[str], *, style: str, made_with: str, head: Sequence[str] = ()) -> str:
    """The whole file.

    Parameters
    ----------
    title
        Plain text.
    body
        Elements of HTML.
    style
        CSS beside what all pages have; colours are --ink, --faint, --line, --ground and --bad.
    made_with
        Versions and machine, plain text.
    head
        Further elements of HTML for the page's head.
    """
    content = "\n".join(body)
    further = "".join(f"{element}\n" for element in head)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
{further}<title>{escape(title)}</title>
<style>{_STYLE}{style}</style>
</head>
<body>
{content}
<footer><p>{escape(made_with)}</p></footer>
</body>
</html>
"""
