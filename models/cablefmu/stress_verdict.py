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

The energy balance E(t) - E(0) = work - losses, which the solver keeps, may be off by

    allowed = ENERGY r^(4/5) F D + ROUNDING F S

at the end. F D stands for the energy turned over: the largest force in the cable or on it times the farthest way of
any joint. Work and losses are quadratures of order 4 along the steps, whose size goes with r^(1/5). It needs no
reference, and no horizon.

Most runs use a thousandth of that. So neither share may grow by more than `WORSE` over what was once measured
[stress_baseline.py], or over what can be told apart: the distance of two references, rounding, `TIGHTEST` in angles.
Nor may the number of steps by more than `LONGER`, or by `FEW`: a solver whose Jacobian is wrong keeps its tolerance.

Accelerations are compared with the dense equation at states of the motion [stress_accelerations.py].
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from .cable import Floats
from .stress_accelerations import MOST_LINKS
from .stress_baseline import Measured
from .stress_grid import Case
from .stress_run import ACCELERATIONS, Answer, Request

__all__ = [
    "ANYTHING", "DENSE_LINKS", "ENERGY", "FEW", "LIMIT", "LONGER", "LOOSEST", "MULTIPLE", "NUDGE", "PARTING", "TIGHTER",
    "TIGHTEST", "WORSE", "Row", "judge",
]  # fmt: skip

NUDGE = 1e-9
"""[rad]"""
MULTIPLE = 5.0
TRACE = 0.01
ENERGY, ROUNDING = 100.0, 1e-13
WORSE, LONGER, FEW = 10.0, 3.0, 100
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
    """"within tolerance", "clean error", "wrong", "worse" than once measured, "hang" or "crash"."""
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
    energy: float = float("nan")
    """Error of the energy balance / allowed."""
    accelerations: float = float("nan")
    """Their error / allowed; of up to MOST_LINKS links."""
    worse: float = float("nan")
    """How many times more of the allowed it uses than once measured, or than can be told apart."""
    longer: float = float("nan")
    """How many times the steps once measured."""
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


def judge(case: Case, ask: Ask, folder: Path, measured: Measured | None = None) -> Row:
    """Run a case, find references and compare.

    Parameters
    ----------
    case
        What to run.
    ask
        Runs a request within a limit [s] (`Worker.ask`).
    folder
        Where its FMU may lie meanwhile.
    measured
        The shares that it must not exceed by much; None: any.
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
        _weigh(row, run, Request(case, fmu), ask, measured)
    fmu.unlink(missing_ok=True)
    return row


def _describe(row: Row, run: Answer) -> None:
    facts = run.facts
    row.n, row.figures = int(facts.get("n", 0)), dict(run.figures)
    row.seconds = run.seconds if run.seconds > 0.0 else math.nan
    row.tolerance, row.stop_time = facts.get("tolerance", math.nan), facts.get("stop_time", math.nan)
    implicit = run.figures.get("implicit")
    row.solver = "" if implicit is None else {0.0: "explicit", 1.0: "implicit"}.get(implicit, "both")


class _CrashError(Exception):
    """A run beside the one that is judged crashed."""


def _weigh(row: Row, run: Answer, request: Request, ask: Ask, measured: Measured | None) -> None:
    """Everything that a run which ended is judged by; the first that fails is the verdict."""

    def surely(request: Request, limit: float) -> Answer:
        answer = ask(request, limit)
        if answer.outcome == "crash":
            raise _CrashError(f"the run for {request.solver}: {answer.message}")
        return answer

    try:
        known = _compare(row, run, _references(request, run, surely), surely)
        if row.verdict == "within tolerance":
            _compare_accelerations(row, request, surely)
    except _CrashError as crash:
        row.verdict, row.message = "crash", str(crash)
        return
    known_energy = _compare_energy(row, run)
    if row.verdict == "within tolerance" and measured is not None:
        row.worse = max(row.ratio / max(measured.position, known), row.energy / max(measured.energy, known_energy))
        row.longer = row.figures["steps"] / max(measured.steps, 1)
        _compare_with_once(row, measured)


def _compare_with_once(row: Row, measured: Measured) -> None:
    if not row.worse <= WORSE:
        row.verdict = "worse"
        row.message = (
            f"{row.worse:.3g} times what was once measured: of the allowed error {row.ratio:.2g}, "
            f"then {measured.position:.2g}; of energy {row.energy:.2g}, then {measured.energy:.2g}"
        )
    elif row.figures["steps"] > LONGER * measured.steps + FEW:
        row.verdict = "worse"
        row.message = f"{row.figures['steps']:,.0f} steps, {row.longer:.3g} times what was once measured"


def _references(plain: Request, run: Answer, ask: Ask) -> dict[str, tuple[Request, Answer]]:
    """Those that ended, by name: own explicit and implicit solver, dense matrices; if it is but one, that one twice."""
    rows = math.ceil((len(run.times) - 1) / MOST_ROWS)
    tolerance = min(max(run.facts["tolerance"] / TIGHTER, TIGHTEST), LOOSEST)
    base = replace(plain, step=rows * run.facts["step"], tolerance=tolerance)
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


def _compare_accelerations(row: Row, request: Request, ask: Ask) -> None:
    if row.n > MOST_LINKS:
        return
    answer = ask(replace(request, solver=ACCELERATIONS), REFERENCE_LIMIT)
    row.accelerations = answer.figures.get("accelerations", math.inf)
    if not row.accelerations <= 1.0:
        row.verdict = "wrong"
        row.message = answer.message or (
            f"accelerations differ from those of the dense equation, {row.accelerations:.3g} times what is allowed"
        )


def _compare_energy(row: Row, run: Answer) -> float:
    """The share of the allowed that can be told from rounding."""
    way = run.points - run.points[0]
    farthest = float(np.max(np.hypot(way[..., 0], way[..., 1])))
    force, scale = run.figures["force"], _scale(run.facts["length"], [run])
    rounding = ROUNDING * force * scale
    allowed = ENERGY * row.tolerance**0.8 * force * farthest + rounding
    if allowed == 0.0:  # nothing acts
        row.energy = 0.0 if run.figures["energy_residual"] == 0.0 else math.inf
        return 1.0
    row.energy = abs(run.figures["energy_residual"]) / allowed
    if row.verdict == "within tolerance" and not row.energy <= 1.0:
        row.verdict = "wrong"
        row.message = f"the energy balance is off by {row.energy:.3g} times what is allowed"
    return float(rounding / allowed)


def _scale(length: float, answers: Sequence[Answer]) -> float:
    """S [m]"""
    return max(length, max(float(np.max(np.abs(answer.points))) for answer in answers))


def _compare(row: Row, run: Answer, references: Mapping[str, tuple[Request, Answer]], ask: Ask) -> float:
    """Positions; the share of the allowed that references can tell apart."""
    answers = [answer for _, answer in references.values()]
    row.references = ", ".join(references)
    if len(answers) < 2:
        row.verdict, row.message = "wrong", "there are no two references to judge by"
        return math.nan
    scale = _scale(run.facts["length"], answers)
    times, parted = _parted(references, run, scale, ask)
    growth = np.fmax.accumulate(parted / np.minimum.accumulate(np.clip(parted, TRACE, 1.0)))
    growth = np.fmax(growth, 1.0)
    known = (np.fmax.accumulate(parted) <= PARTING) & (growth <= ANYTHING / row.tolerance)
    if np.count_nonzero(known) - 1 < min(FEWEST, len(times) - 1):
        row.verdict, row.message = "wrong", "too chaotic for its output times: nothing to compare"
        return math.nan
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
    between = max(apart(one, other, share=True) for one, other in combinations(answers, 2))
    return max(between, TIGHTEST / (MULTIPLE * row.tolerance))


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
