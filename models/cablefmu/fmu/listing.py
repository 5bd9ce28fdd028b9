"""The variables of an FMU as rows of a table: those of every link, that differ in a number only, in one row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from .variables import COSIMULATION_ONLY, FRAME, Variable

__all__ = ["Row", "number", "rows_of"]

_INDEX = re.compile(r"\[(\d+)\]")
_INDEXED = re.compile(r"\[\d+\]|(?<=Link )\d+")


@dataclass(frozen=True, slots=True)
class Row:
    """One variable, or the same variable of all links."""

    first: str
    last: str
    """Names; the same where it is one variable."""
    unit: str
    start: str
    """Start value or the range of them; an item's name for an enumeration; empty for what is calculated."""
    description: str
    """Without what the descriptions of all directions, or of all of the solver's figures, end with."""


def rows_of(variables: Sequence[Variable]) -> list[Row]:
    """Rows in the order of the variables."""
    return [_row(group) for group in _groups(variables)]


def _groups(variables: Sequence[Variable]) -> Iterator[list[Variable]]:
    """Neighbours whose names differ in an index."""
    for _, group in groupby(variables, lambda variable: _INDEX.sub("[i]", variable.name)):
        yield list(group)


def _row(group: list[Variable]) -> Row:
    first, last = group[0], group[-1]
    description = first.description.removesuffix(f"; {FRAME}").removesuffix(f"; {COSIMULATION_ONLY}")
    if len(group) > 1:
        description = _INDEXED.sub(lambda found: "[i]" if found[0].startswith("[") else "i", description)
    return Row(first.name, last.name, first.unit, _start(group), description)


def _start(group: list[Variable]) -> str:
    first = group[0]
    if first.start is None:
        return ""
    if first.enumeration:
        return next(item.name for item in first.enumeration.items if item.value == first.start)
    values = [variable.start for variable in group if variable.start is not None]
    low, high = min(values), max(values)
    return number(low) if low == high else f"{number(low)} … {number(high)}"


def number(value: float) -> str:
    """For people: eight digits, 8e8 for 8e+08, a true minus sign."""
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.8g}").replace("-", "−")
