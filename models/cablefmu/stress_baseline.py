"""Shares of the allowed error that every stress case was once measured to use: nothing may grow worse unnoticed.

What theory allows is a bound for all cases, and most keep a thousandth of it: a solver could lose two digits and pass.
So what was measured is kept in stress_baseline.csv, and compared with. `cablefmu stress --record FILE.csv` writes it.
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
    """Shares of what is allowed."""

    position: float
    energy: float


@cache
def baseline() -> Mapping[str, Measured]:
    """By the case's name; cases that end in an error are not in it."""
    lines = (resources.files("cablefmu") / "stress_baseline.csv").read_text(encoding="utf-8").splitlines()
    return {row["case"]: Measured(float(row["position"]), float(row["energy"])) for row in csv.DictReader(lines)}


def write_baseline(measured: Iterable[tuple[str, Measured]], path: Path) -> None:
    """Write such a file, two digits each.

    Raises
    ------
    OptionError
        If it cannot be written.
    """
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", "position", "energy"])
        writer.writerows([name, f"{found.position:.1e}", f"{found.energy:.1e}"] for name, found in measured)
