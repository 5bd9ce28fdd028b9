"""What a sweep says as a whole: of every figure how it is spread, and what it exceeds in how many cases."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from ..cable import Floats
from ..files import replacing

__all__ = ["LEVELS", "Summary", "exceedance", "summary_of", "write_summary"]

LEVELS = (0.5, 0.1, 0.01)
"""Shares of the cases"""


@dataclass(frozen=True, slots=True)
class Summary:
    """Of one figure over the cases that ended."""

    name: str
    unit: str
    count: int
    smallest: float
    mean: float
    deviation: float
    """Standard deviation of the sample; 0 of one case"""
    exceeded: Sequence[float | None]
    """What the shares `LEVELS` of the cases exceed; None where there are too few to tell"""
    largest: float
    case: int
    """Where it is largest"""


def exceedance(values: Floats) -> tuple[Floats, Floats]:
    """Values in rising order, and the share of cases that a further one is expected to exceed each of them.

    The k-th of N in rising order is exceeded with the probability 1 - k / (N + 1), whatever the distribution (Weibull's
    plotting position).

    Parameters
    ----------
    values
        Of the cases, shape (N,).

    Returns
    -------
    values, shares
        Each of shape (N,).
    """
    count = len(values)
    return np.sort(values), 1.0 - np.arange(1, count + 1) / (count + 1)


def summary_of(result: xr.Dataset) -> list[Summary]:
    """One a figure, of the cases that ended; none if none did."""
    ended = result.isel(case=np.flatnonzero(result["status"].values == "ended"))
    found = []
    for name, variable in ended.data_vars.items():
        has = np.flatnonzero(~np.isnan(variable.values)) if variable.dtype.kind == "f" else np.empty(0, dtype=int)
        if "." not in str(name) or str(name).rpartition(".")[2] not in _KINDS or not has.size:
            continue
        found.append(
            _summary(str(name), variable.attrs.get("units", ""), variable.values[has], ended["case"].values[has])
        )
    return found


_KINDS = ("min", "max", "final", "equivalent")


def _summary(name: str, unit: str, values: Floats, cases: Floats) -> Summary:
    ordered, shares = exceedance(values)
    # Shares fall: np.interp wants them rising.
    exceeded = [
        float(np.interp(level, shares[::-1], ordered[::-1])) if shares[-1] <= level <= shares[0] else None
        for level in LEVELS
    ]
    largest = int(np.argmax(values))
    deviation = float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
    return Summary(
        name, unit, len(values), float(values.min()), float(values.mean()), deviation, exceeded,
        float(values[largest]), int(cases[largest]),
    )  # fmt: skip


def write_summary(summaries: Sequence[Summary], path: Path) -> None:
    """As CSV, every double to the last bit."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        exceeded = [f"exceeded by {100.0 * level:g} %" for level in LEVELS]
        writer.writerow(["figure", "unit", "cases", "smallest", "mean", "deviation", *exceeded, "largest", "in case"])
        for s in summaries:
            levels = ["" if value is None else repr(value) for value in s.exceeded]
            spread = [repr(value) for value in (s.smallest, s.mean, s.deviation)]
            writer.writerow([s.name, s.unit, s.count, *spread, *levels, repr(s.largest), s.case])
