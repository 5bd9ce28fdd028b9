"""Writes docs/validation.md and its figures: `python -m tests.validation.page`, from the project's folder."""

from __future__ import annotations

import ctypes
import tempfile
from math import ceil, floor, log10
from pathlib import Path

from tests.kernel.library import compile_kernel, load
from tests.validation import catenary, elastica, frequencies, pendulum, sinking
from tests.validation.checks import Check, Section

__all__ = ["PAGE", "all_sections", "page"]

PAGE = Path(__file__).parents[2] / "docs" / "validation.md"

_HEAD = """\
# Against published numbers

<!-- Written by `python -m tests.validation.page`; tests/validation/test_page.py compares it. -->

The kernel that every FMU contains, beside numbers that do not come from this project's code: classical
solutions, tabulated functions, textbook formulas. The tables in `tests/data/` were evaluated from classical
solutions by other means; their first lines say how. The tests in `tests/validation/` hold every row (and the rows
of the tables left out here) within its tolerance. `PYTHONPATH=models python -m tests.validation.page` writes
this page.

Where the source treats another model (a smooth line, point masses), the expected difference is **derived** from
a formula that knows nothing of our result, and the tolerance applies to what is left of the difference without
it. Nothing of the difference is fitted; where a factor in a tolerance is our choice, it is called so.
"below" means below the tolerance: such differences are rounding, and not the same on every processor.

The model's top always heaves. A fixed top is a floater of 1e15 kg, a free end a load of 1e-12 kg; what that
changes is said in `tests/validation/cables.py`, and lies below all tolerances.
"""


def all_sections(library: ctypes.CDLL) -> list[Section]:
    """In the page's order."""
    topics = (frequencies, pendulum, elastica, catenary, sinking)
    return [section for topic in topics for section in topic.sections(library)]


def page(sections: list[Section]) -> str:
    """The page as text."""
    parts = [_HEAD]
    for section in sections:
        parts.append(f"## {section.title}\n")
        if section.title in FIGURES:
            name, caption = FIGURES[section.title]
            parts.append(f"![{caption}](validation-{name}.svg)\n")
        parts += [
            f"**Source:** {section.source}\n",
            f"**Difference and tolerance:** {section.why}\n",
            _table(section),
        ]
    return "\n".join(parts)


FIGURES = {
    "Many rods: the flexible chain": (
        "frequencies",
        "Error of the first five frequencies, falling as n to the -2",
    ),
    "Elastica, half a link's compliance at the wall": (
        "elastica",
        "Shapes of the cantilever and the published tips",
    ),
    "Hanging between two points: the rest shape": (
        "catenary",
        "Difference of the horizontal pull, falling as n to the -2",
    ),
    "A level cable sinks": ("sinking", "Speed of the sinking cable on the way to its terminal speed"),
}
"""Section -> (docs/validation-NAME.svg, caption)"""


def _table(section: Section) -> str:
    shown = [check for check in section.checks if check.on_page]
    rows = ["| quantity | published | ours | difference | derived | tolerance |", "|---|---|---|---|---|---|"]
    rows += [_row(check) for check in shown]
    worst = max(abs(check.departure) / check.tolerance for check in section.checks)
    share = next(step for step in (0.1, 0.2, 0.5, 1.0) if worst <= step)
    total = f"All {len(section.checks)} values" if len(shown) < len(section.checks) else "All"
    return "\n".join(rows) + f"\n\n{total} need at most {share:g} of the tolerance.\n"


def _row(check: Check) -> str:
    """Decimals to three digits of the difference; where that is noise, to what is certain, and it is not printed."""
    unit = f" [{check.unit}]" if check.unit else ""
    limit = _round_up(check.tolerance)
    if check.published == 0.0:
        return f"| {check.quantity}{unit} | 0 | below {limit} | below | 0 | {limit} |"
    differs = abs(check.difference) > check.tolerance
    decimals = 2 - floor(log10(abs(check.difference))) if differs else floor(-log10(check.tolerance)) - 1
    values = [f"{value:.{decimals}f}" for value in (check.published, check.ours)]
    numbers = [f"{check.difference:+.2e}", f"{check.derived:+.2e}"] if differs else ["below", "0"]
    return f"| {' | '.join([check.quantity + unit, *values, *numbers, limit])} |"


def _round_up(tolerance: float) -> str:
    """Two digits, never less than it is."""
    scale = 10.0 ** (floor(log10(tolerance)) - 1)
    return f"{ceil(tolerance / scale * (1.0 - 1e-12)) * scale:.1e}"


def main() -> None:
    from tests.validation.figures import draw

    with tempfile.TemporaryDirectory() as folder:
        library = load(compile_kernel(Path(folder)))
        PAGE.write_text(page(all_sections(library)), encoding="utf-8")
        draw(library, PAGE.parent)


if __name__ == "__main__":
    main()
