"""Shares of the allowed error, and steps, that every stress case was once measured to use.

What theory allows is a bound for all cases, and most keep a thousandth of it: a solver could lose two digits and pass,
or take a hundred times the steps. So what was measured is kept in stress_baseline.csv, and compared with.
`cablefmu stress --record FILE.csv` writes it.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from .files import replacing

__all__ = ["Measured", "baseline", "write_baseline"]


@dataclass(frozen=True, slots=True)
class Measured:
    """By one case."""

    position: float
    """Share of the allowed error, of the energy balance likewise."""
    energy: float
    steps: int


@cache
def baseline() -> Mapping[str, Measured]:
    """By the case's name; cases that end in an error are not in it."""
    lines = (resources.files("cablefmu") / "stress_baseline.csv").read_text(encoding="utf-8").splitlines()
    return {
        row["case"]: Measured(float(row["position"]), float(row["energy"]), int(row["steps"]))
        for row in csv.DictReader(lines)
    }


def write_baseline(measured: Iterable[tuple[str, Measured]], path: Path) -> None:
    """Write such a file, shares with two digits.

    Raises
    ------
    OptionError
        If it cannot be written.
    """
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "position", "energy", "steps"])
        writer.writerows(
            [name, f"{found.position:.1e}", f"{found.energy:.1e}", str(found.steps)] for name, found in measured
        )
