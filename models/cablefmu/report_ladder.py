"""Error against price: solvers over a ladder of tolerances, and communication steps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from .errors import RunError
from .report_peers import SCIPY, inputs_at, scipy_course
from .report_reference import Trusted
from .report_runs import SOLVERS, Apart, Course, FmuRuns, TooSlowError, apart, output_times, timed
from .scene import Scene
from .signals import Constant, Signal, Steps

__all__ = [
    "CVODE", "DEFAULT", "PEERS", "TOLERANCES", "Row", "Said", "communication_steps", "held", "held_step", "ladder",
    "longest_held", "order", "recommended",
]  # fmt: skip

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)

CVODE = "CVode"
PEERS = (CVODE, *SCIPY)
"""Integrators that are not ours, FMPy's and scipy's, on the same right-hand side."""

MULTIPLES, PARTS = (10, 5, 2, 1), (2, 5, 10, 20, 50, 100)
"""Communication steps as multiples and as parts of the scene's: 1 s to 1 ms where that is 0.1 s."""

DEFAULT = ("automatic", 1e-6)
ALIKE = 1.1
"""CPU times that differ by less than this factor are the same but for noise."""


@dataclass(frozen=True, slots=True)
class Row:
    """One run of a table: its setting, its error and its price."""

    solver: str
    tolerance: float
    step: float
    """Communication step [s]; for scipy the interval between outputs"""
    inputs: str
    """"exact", or "held" constant over each communication step"""
    error: Apart | None
    """None if the run did not end; `note` says why"""
    cpu_time: float
    """[s]"""
    rhs: int
    steps: int
    energy_residual: float
    """[J]"""
    note: str = ""

    @property
    def is_own(self) -> bool:
        """Whether the FMU's own solver ran, with forces as they are."""
        return self.solver in SOLVERS and self.inputs == "exact"


Said = Callable[[str], None]
"""Told what is done next."""


def ladder(
    runs: FmuRuns, reference: Trusted, limit: float, *, step: float | None = None,
    solvers: Sequence[str] = (*SOLVERS, *PEERS), say: Said = print,
) -> list[Row]:  # fmt: skip
    """Run every solver at every tolerance, with the scene's communication step unless another is given.

    Where a run takes more than `limit` [s of CPU time], tighter tolerances of the same solver are not tried.
    """
    rows: list[Row] = []
    interval = step or runs.scene.step
    for solver in solvers:
        slow = ""
        for tolerance in TOLERANCES:
            if slow:
                rows.append(_failed(solver, tolerance, interval, "exact", slow))
                continue
            say(f"{solver} at {tolerance:g}")
            run = _run_of(runs, solver, tolerance, interval, limit)
            row = _measured(solver, tolerance, interval, "exact", reference, run)
            rows.append(row)
            slow = row.note if row.note.startswith("too slow") else ""
    return rows


def _run_of(runs: FmuRuns, solver: str, tolerance: float, step: float, limit: float) -> Callable[[], Course]:
    if solver in SOLVERS:
        return partial(runs.run, tolerance=tolerance, solver=solver, step=step, limit=limit)
    if solver == CVODE:
        return partial(runs.run, tolerance=tolerance, interface="me", step=step, limit=limit)
    return partial(scipy_course, runs.scene, solver, tolerance, limit)


def _measured(
    solver: str, tolerance: float, step: float, inputs: str, reference: Trusted, run: Callable[[], Course]
) -> Row:
    try:
        found = timed(run)
        error = apart(found, reference.course, reference.horizon.time)
    except TooSlowError as slow:
        return _failed(solver, tolerance, step, inputs, f"too slow: {slow}")
    except RunError as failure:
        return _failed(solver, tolerance, step, inputs, str(failure))
    return Row(
        solver, tolerance, step, inputs, error, found.cpu_time, found.rhs, found.steps, found.energy_residual
    )  # fmt: skip


def _failed(solver: str, tolerance: float, step: float, inputs: str, note: str) -> Row:
    return Row(solver, tolerance, step, inputs, None, 0.0, 0, 0, 0.0, note)


# --- the communication step ---


def communication_steps(runs: FmuRuns, reference: Trusted, limit: float, *, say: Said = print) -> list[Row]:
    """The default setting with other communication steps: forces given exactly, and held as a plain host does."""
    scene, (solver, tolerance) = runs.scene, DEFAULT
    varies = any(not isinstance(signal, Constant) for signal in scene.signals.values())
    rows: list[Row] = []
    for inputs in ("exact", "held") if varies else ("exact",):
        for step in _steps(scene, reference.horizon.time):
            say(f"communication step {step:g} s, inputs {inputs}")
            signals = held(scene, step) if inputs == "held" else None
            run = partial(runs.run, tolerance=tolerance, solver=solver, step=step, signals=signals, limit=limit)
            rows.append(_measured(solver, tolerance, step, inputs, reference, run))
    return rows


def _steps(scene: Scene, horizon: float) -> Iterable[float]:
    """Those of which two fit into what is compared."""
    steps = [scene.step * multiple for multiple in MULTIPLES] + [scene.step / part for part in PARTS]
    return [step for step in steps if 2.0 * step <= horizon]


def held(scene: Scene, step: float) -> dict[str, Signal]:
    """The forces of a scene, each as it is at the start of a communication step until its end."""
    times = tuple(output_times(scene, step)[:-1].tolist())
    values = [inputs_at(scene, time) for time in times]
    return {name: Steps(times, tuple(row[name] for row in values)) for name in scene.signals}


# --- conclusions ---


def recommended(rows: Iterable[Row], accuracy: float) -> Row | None:
    """The cheapest run of the FMU's own solver whose position error is within `accuracy` [m].

    Of those that cost the same but for noise, the one with the smallest error.
    """
    good = [row for row in rows if row.is_own and row.error is not None and row.error.position <= accuracy]
    if not good:
        return None
    cheapest = min(row.cpu_time for row in good)
    return min((row for row in good if row.cpu_time <= ALIKE * cheapest), key=_position)


def longest_held(rows: Iterable[Row], accuracy: float) -> Row | None:
    """The longest communication step that keeps `accuracy` [m] in a host that holds inputs, and all shorter ones do."""
    found = None
    for row in sorted((row for row in rows if row.inputs == "held"), key=lambda row: row.step):
        if row.error is None or row.error.position > accuracy:
            break
        found = row
    return found


def held_step(rows: Iterable[Row], accuracy: float) -> float | None:
    """The step [s] that would keep `accuracy` [m] in such a host where none that was tried does, by order 1."""
    ended = [(row.step, row.error.position) for row in rows if row.inputs == "held" and row.error is not None]
    if not ended:
        return None
    step, error = min(ended)
    return step * accuracy / error if error > accuracy else None


def order(x: Iterable[float], error: Iterable[float]) -> float | None:
    """Exponent p of error ~ x^p by least squares; None for fewer than three points."""
    pairs = [(a, b) for a, b in zip(x, error, strict=True) if a > 0.0 and b > 0.0]
    if len(pairs) < 3:
        return None
    a, b = np.log(np.array(pairs)).T
    return float(np.polyfit(a, b, 1)[0])


def _position(row: Row) -> float:
    return row.error.position if row.error is not None else float("inf")
