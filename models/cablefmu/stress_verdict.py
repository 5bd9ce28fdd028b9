"""Whether a run of a stress case was right: judged by references of tighter tolerance.

The error is the largest distance of any joint P_0 ... P_n from where a reference has it, at any output time up to the horizon,
and from the farthest of the references. It is measured in the scale S, the cable's length or, where forces drive it
farther, its largest distance from the origin; so error / (r S) says how many times the tolerance r it is.

Every step is allowed an error of r (1 + |x|) in every angle and rate, and errors of some hundred steps add up and
are carried along by the motion. `ALLOWED` is what that may amount to; what a motion multiplies by more than
`PARTING` is chaotic at this precision, and compared only up to there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from .cable import Floats
from .stress_grid import Case
from .stress_run import Answer, Request

__all__ = ["ALLOWED", "PARTING", "Row", "judge"]

ALLOWED = 100.0
"""Largest error / (tolerance S)."""
NUDGE, PARTING = 1e-9, 1e3
"""[rad]; the horizon is where starts so far apart have parted by more than PARTING times as much (times S)."""
TIGHTER, TIGHTEST, LOOSEST = 100.0, 1e-12, 1e-7
"""References: the tolerance over TIGHTER, but not below TIGHTEST, where rounding takes over, nor above LOOSEST."""
LIMIT, REFERENCE_LIMIT, EXPLICIT_LIMIT, DENSE_LIMIT = 60.0, 40.0, 10.0, 4.0
"""Seconds for the run itself, for a reference by the own solver, by its explicit method, by the dense matrices."""
DENSE_LINKS = 30
MOST_ROWS = 100
"""Output times that are compared."""


@dataclass
class Row:
    """One case's line in the table."""

    case: Case
    verdict: str = "crash"
    """"within tolerance", "clean error", "wrong", "hang" or "crash"."""
    message: str = ""
    n: int = 0
    tolerance: float = float("nan")
    solver: str = ""
    """"explicit", "implicit" or "both"."""
    figures: dict[str, float] = field(default_factory=dict)
    seconds: float = float("nan")
    """What the run took."""
    error: float = float("nan")
    """[m]"""
    ratio: float = float("nan")
    """error / (tolerance S)"""
    spread: float = float("nan")
    """Largest distance between two references [m]."""
    references: str = ""
    horizon: float = float("nan")
    """[s]; the stop time where nothing parts."""
    stop_time: float = float("nan")

    @property
    def passed(self) -> bool:
        return self.verdict in ("within tolerance", "clean error")


Ask = Callable[[Request, float], Answer]


def judge(case: Case, ask: Ask, folder: Path) -> Row:
    """Run a case, find references and compare.

    Parameters
    ----------
    case
        What to run.
    ask
        Runs a request within a limit [s] (`Worker.ask`).
    folder
        Where its FMU may lie meanwhile.
    """
    fmu = folder / f"{case.name}.fmu"
    row = Row(case)
    run = ask(Request(case, fmu), LIMIT)
    _describe(row, run)
    if run.outcome != "ended":
        row.message = run.message
        row.verdict = run.outcome if run.outcome != "error" else "clean error" if case.fails else "wrong"
    elif case.fails:
        row.verdict, row.message = "wrong", f"this should have ended in an error: {case.fails}"
    else:
        _compare(row, run, _references(case, fmu, run, ask), ask)
    fmu.unlink(missing_ok=True)
    return row


def _describe(row: Row, run: Answer) -> None:
    facts = run.facts
    row.n, row.seconds, row.figures = int(facts.get("n", 0)), run.seconds, dict(run.figures)
    row.tolerance, row.stop_time = facts.get("tolerance", math.nan), facts.get("stop_time", math.nan)
    implicit = run.figures.get("implicit")
    row.solver = "" if implicit is None else {0.0: "explicit", 1.0: "implicit"}.get(implicit, "both")


def _references(case: Case, fmu: Path, run: Answer, ask: Ask) -> dict[str, tuple[Request, Answer]]:
    """Those that ended, by name: own explicit and implicit solver, dense matrices; if it is but one, that one twice."""
    rows = math.ceil((len(run.times) - 1) / MOST_ROWS)
    tolerance = min(max(run.facts["tolerance"] / TIGHTER, TIGHTEST), LOOSEST)
    base = Request(case, fmu, step=rows * run.facts["step"], tolerance=tolerance)
    found: dict[str, tuple[Request, Answer]] = {}

    def add(name: str, request: Request, limit: float) -> None:
        answer = ask(request, limit)
        if answer.outcome == "ended":
            found[name] = request, answer

    add("implicit", replace(base, solver="implicit"), REFERENCE_LIMIT)
    add("explicit", replace(base, solver="explicit"), EXPLICIT_LIMIT)
    if run.facts["n"] <= DENSE_LINKS:
        stiff = run.figures.get("implicit", 0.0) > 0.5
        add("dense", replace(base, solver="Radau" if stiff else "DOP853"), DENSE_LIMIT)
    if len(found) == 1:
        (name, (request, _)) = next(iter(found.items()))
        add(f"{name} at a tenth", replace(request, tolerance=0.1 * tolerance), REFERENCE_LIMIT)
    return found


def _compare(row: Row, run: Answer, references: Mapping[str, tuple[Request, Answer]], ask: Ask) -> None:
    answers = [answer for _, answer in references.values()]
    row.references = ", ".join(references)
    if len(answers) < 2:
        row.verdict, row.message = "wrong", "there are no two references to judge by"
        return
    scale = max(run.facts["length"], max(float(np.max(np.abs(answer.points))) for answer in answers))
    row.horizon = _horizon(references, scale, ask)
    row.error = max(_apart(run, answer, row.horizon) for answer in answers)
    row.spread = max(_apart(one, other, row.horizon) for one, other in combinations(answers, 2))
    row.ratio = row.error / (row.tolerance * scale)
    row.verdict = "within tolerance" if row.ratio <= ALLOWED else "wrong"
    if row.verdict == "wrong":
        row.message = f"{row.error:.2g} m from a reference, allowed are {ALLOWED * row.tolerance * scale:.2g} m"


def _horizon(references: Mapping[str, tuple[Request, Answer]], scale: float, ask: Ask) -> float:
    """Until when a nudged start leads to the same motion [s]; by the quicker one of the own solvers."""
    own = [pair for name, pair in references.items() if name != "dense"]
    request, answer = min(own, key=lambda pair: pair[1].seconds)
    nudged = ask(replace(request, nudge=NUDGE), REFERENCE_LIMIT)
    if nudged.outcome != "ended":
        return float(answer.times[-1])
    times, distance = _distances(answer, nudged)
    parted = np.flatnonzero(~(distance <= PARTING * NUDGE * scale))
    return float(times[parted[0] - 1] if parted.size else times[-1])


def _distances(one: Answer, other: Answer) -> tuple[Floats, Floats]:
    """The times that both have [s], and the largest distance between equal joints at each [m]."""
    nearest = np.searchsorted(one.times, other.times - 1e-9 * one.times[-1])
    nearest = np.minimum(nearest, len(one.times) - 1)
    both = np.abs(one.times[nearest] - other.times) <= 2e-9 * one.times[-1]
    gap = one.points[nearest[both]] - other.points[both]
    return other.times[both], np.max(np.hypot(gap[..., 0], gap[..., 1]), axis=1)


def _apart(one: Answer, other: Answer, horizon: float) -> float:
    """The largest distance up to the horizon [m]; infinite where anything is not a number."""
    times, distance = _distances(one, other)
    largest = float(np.max(distance[times <= horizon * (1.0 + 1e-9)]))
    return largest if math.isfinite(largest) else math.inf
