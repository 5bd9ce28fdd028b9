"""Whether a run of a stress case was right: judged by references of tighter tolerance.

The error at a time is the largest distance of any joint P_0 ... P_n from where the farthest of the references has it. A
run at tolerance r may err by

    allowed(t) = MULTIPLE r S K(t)

S is the cable's length or, where forces drive it farther, its largest distance from the origin: a step may err by
r (1 + |x|) in every angle, and an angle moves joints by as much times the length that hangs on it. MULTIPLE leaves room
for the errors of many steps to add up. K >= 1 is what the motion makes of a small disturbance, whenever it enters: by
how much the distance between two starts that differ by `NUDGE` in the angles has grown since it was smallest (but not
from below `TRACE` of what it was, where rounding begins). It is some tens in a whip or a snap, and grows without bounds
in a chaotic motion. That is compared up to its horizon, where the two starts are `PARTING` times as far apart as they
were, or r K passes `ANYTHING`; `FEWEST` output times must come before it, or nothing would be said.
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

__all__ = ["ANYTHING", "LIMIT", "LOOSEST", "MULTIPLE", "NUDGE", "PARTING", "TIGHTER", "TIGHTEST", "Row", "judge"]

NUDGE = 1e-9
"""[rad]"""
MULTIPLE = 5.0
TRACE = 0.01
PARTING, ANYTHING = 1e3, 0.1
FEWEST = 3
TIGHTER, TIGHTEST, LOOSEST = 100.0, 1e-12, 1e-7
"""References: the tolerance over TIGHTER, but not below TIGHTEST, where rounding takes over, nor above LOOSEST."""
LIMIT, REFERENCE_LIMIT, EXPLICIT_LIMIT, DENSE_LIMIT = 60.0, 90.0, 8.0, 4.0
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
    """Its largest up to the horizon [m]."""
    ratio: float = float("nan")
    """The largest of error / allowed."""
    growth: float = float("nan")
    """K at the horizon."""
    spread: float = float("nan")
    """Largest distance between two references [m]."""
    references: str = ""
    horizon: float = float("nan")
    """[s]; the stop time where nothing parts."""
    stop_time: float = float("nan")

    @property
    def passed(self) -> bool:
        return self.verdict in ("within tolerance", "clean error")


_SAME_TIME = 1e-9
"""Output times that differ by less, relatively, are the same."""

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
    row.n, row.figures = int(facts.get("n", 0)), dict(run.figures)
    row.seconds = run.seconds if run.seconds > 0.0 else math.nan
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
    times, parted = _parted(references, run, scale, ask)
    growth = np.fmax.accumulate(parted / np.minimum.accumulate(np.clip(parted, TRACE, 1.0)))
    growth = np.fmax(growth, 1.0)
    known = (np.fmax.accumulate(parted) <= PARTING) & (growth <= ANYTHING / row.tolerance)
    if np.count_nonzero(known) - 1 < min(FEWEST, len(times) - 1):
        row.verdict, row.message = "wrong", "too chaotic for its output times: nothing to compare"
        return
    row.horizon = float(times[known][-1])
    row.growth = float(growth[known][-1])

    def apart(one: Answer, other: Answer, share: bool = False) -> float:
        """Largest distance up to the horizon [m], or share of the allowed; infinite if anything is not a number."""
        at, distance = _distances(one, other)
        if share:
            distance = distance / (MULTIPLE * row.tolerance * scale * np.interp(at, times, growth))
        largest = float(np.max(distance[at <= row.horizon * (1.0 + _SAME_TIME)]))
        return largest if math.isfinite(largest) else math.inf

    row.error = max(apart(run, answer) for answer in answers)
    row.ratio = max(apart(run, answer, share=True) for answer in answers)
    row.spread = max(apart(one, other) for one, other in combinations(answers, 2))
    row.verdict = "within tolerance" if row.ratio <= 1.0 else "wrong"
    if row.verdict == "wrong":
        row.message = f"{row.error:.2g} m from a reference, {row.ratio:.3g} times what is allowed"


def _parted(
    references: Mapping[str, tuple[Request, Answer]], run: Answer, scale: float, ask: Ask
) -> tuple[Floats, Floats]:
    """How far a nudged start leads from the same one, over NUDGE S, and when; by the method that the case chose."""
    method = "implicit" if run.figures.get("implicit", 0.0) > 0.5 else "explicit"
    own = [name for name in references if name != "dense"]
    request, answer = references[method if method in own else own[0]]
    nudged = ask(replace(request, nudge=NUDGE), REFERENCE_LIMIT)
    if nudged.outcome != "ended":  # an equilibrium, perhaps, that is found from there no more
        return answer.times, np.ones_like(answer.times)
    times, distance = _distances(answer, nudged)
    return times, distance / (NUDGE * scale)


def _distances(one: Answer, other: Answer) -> tuple[Floats, Floats]:
    """The times that both have [s], and the largest distance between equal joints at each [m]."""
    same = _SAME_TIME * one.times[-1]
    nearest = np.minimum(np.searchsorted(one.times, other.times - same), len(one.times) - 1)
    both = np.abs(one.times[nearest] - other.times) <= same
    gap = one.points[nearest[both]] - other.points[both]
    return other.times[both], np.max(np.hypot(gap[..., 0], gap[..., 1]), axis=1)
