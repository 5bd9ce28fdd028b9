"""One number of ours beside one that was published, and a group of them with a common source and reason."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Check", "Section", "read_table"]

DATA = Path(__file__).parents[1] / "data"


@dataclass(frozen=True)
class Check:
    """`ours` must be `published + derived` within `tolerance`, all in `unit`."""

    quantity: str
    unit: str
    published: float
    ours: float
    tolerance: float
    derived: float = 0.0
    """By how much the model must differ from the source's, from a formula (not from a fit)."""
    on_page: bool = True
    """Long tables are tested in full and printed in part."""

    @property
    def difference(self) -> float:
        return self.ours - self.published

    @property
    def departure(self) -> float:
        """What is left of the difference once the derived part is taken off."""
        return self.difference - self.derived

    @property
    def passes(self) -> bool:
        """False for NaN, too."""
        return abs(self.departure) <= self.tolerance


@dataclass(frozen=True)
class Section:
    """Checks against one source, for one reason."""

    title: str
    source: str
    why: str
    """How the derived difference comes about, and why the tolerance is what it is."""
    checks: tuple[Check, ...]


def read_table(name: str) -> list[dict[str, float]]:
    """Rows of tests/data/NAME.csv, whose first line says where the numbers come from."""
    with (DATA / f"{name}.csv").open(encoding="utf-8") as file:
        assert next(file).startswith("#")
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
