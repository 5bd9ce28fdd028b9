"""The kernel's table of scalars, read from the same file that the C compiler reads.

``variables.def`` names every number that crosses the border once, with unit and description; a row's place
in its list is its slot number in the kernel.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

__all__ = ["Row", "Table", "table"]

_LISTS = ("PARAMETER", "INPUT", "OUTPUT", "SOLVER", "STATICS", "WHOLE")
_ROW = re.compile(rf'^({"|".join(_LISTS)})\((\w+), "([^"]*)", (?:([-+\w.]+), )?"([^"]*)"\)$', re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Row:
    """One scalar that can cross the border."""

    name: str
    unit: str
    """Unit under its FMI name, "1" if there is none."""
    description: str
    slot: int
    """Index in the kernel's list of its kind."""
    least: str = "-inf"
    """Parameters: smallest allowed value, "-inf", "0", or "+0" for above zero."""
    nominal: float = 1.0
    """Outputs: order of magnitude, in `unit`."""


@dataclass(frozen=True, slots=True)
class Table:
    """All rows by name, in slot order."""

    parameters: dict[str, Row]
    inputs: dict[str, Row]
    outputs: dict[str, Row]
    solver: dict[str, Row]
    """Health of the built-in solver, outputs as well: solver.steps, ..."""
    statics: dict[str, Row]
    """Of the equilibrium that a run starts from, outputs as well: statics.residual, ..."""
    whole: dict[str, Row]
    """Parameters of the undivided cable, in FMUs whose number of links is a parameter"""


@cache
def table() -> Table:
    """The table that the installed binaries were compiled with."""
    text = (files("cablefmu") / "binaries" / "variables.def").read_text(encoding="utf-8")
    lists: dict[str, dict[str, Row]] = {kind: {} for kind in _LISTS}
    for kind, name, unit, extra, description in _ROW.findall(text):
        rows = lists[kind]
        if kind in ("SOLVER", "STATICS"):
            name = f"{kind.lower()}.{name}"
        if kind in ("PARAMETER", "WHOLE"):
            rows[name] = Row(name, unit, description, len(rows), least=extra)
        else:
            rows[name] = Row(name, unit, description, len(rows), nominal=float(extra or 1.0))
    return Table(*lists.values())
