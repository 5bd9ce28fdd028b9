"""docs/validation.md says what the kernel does now."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.validation.checks import Check, Section
from tests.validation.page import FIGURES, PAGE, page


def test_page_is_current(sections: dict[str, Section]) -> None:
    """If not: `python -m tests.validation.page`, and look at what changed."""
    assert PAGE.read_text(encoding="utf-8") == page(list(sections.values()))


@pytest.mark.parametrize("name", [name for name, _ in FIGURES.values()])
def test_figure_is_there_and_small(name: str) -> None:
    path = Path(PAGE.parent, f"validation-{name}.svg")
    assert ElementTree.parse(path).getroot().tag == "{http://www.w3.org/2000/svg}svg"
    assert path.stat().st_size < 100_000


def test_a_changed_number_changes_the_page() -> None:
    def text(ours: float, derived: float = 0.0) -> str:
        return page([Section("S", "source", "reason", (Check("x", "N", 10.0, ours, 1e-4, derived),))])

    assert "| x [N] | 10.0000 | 10.0200 | +2.00e-02 | +2.00e-02 | 1.0e-04 |" in text(10.02, derived=0.02)
    assert "| x [N] | 10.000 | 10.000 | below | 0 | 1.0e-04 |" in text(10.00001)
