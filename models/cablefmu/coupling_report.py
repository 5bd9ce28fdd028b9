"""How wrong and how fast the ways of coupling are: algorithms, orders of inputs, communication steps."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import xarray as xr

from .cable import Floats
from .coupling.description import Coupling
from .coupling.run import run_system
from .coupling.schema import ALGORITHMS, AdaptiveSpec
from .coupling.system import System, opened, varied
from .coupling_report_truth import Truth, find_truth, positions_of
from .errors import CouplingError, OptionError, RunError
from .report_ladder import ALIKE, Said, order

__all__ = [
    "SHARE", "STARTUP", "CoupledRow", "CouplingReport", "Family", "check_coupling_options", "make_coupling_report"
]  # fmt: skip

SHARE = 0.01
"""Of the motion: the accuracy that a setting is recommended for unless it is given in metres."""
STARTUP = 0.1
"""Of the stop time: what comes before is the start-up, while there are fewer samples than an order needs."""

ORDERS = (0, 1, 2)
STEPS = (4.0, 2.0, 1.0, 0.5, 0.25)
"""Communication steps, as multiples of the file's."""
TOLERANCES = (1e-2, 1e-3, 1e-4)
"""Of adaptive steps, whose inputs are linear."""
_LEAST_ADAPTIVE = 1.0 / 256.0
"""Of the file's step: shorter ones are not asked for."""
_NOISE = 3.0
"""Times what the truth is good to: smaller errors say nothing of an order."""
_PATIENCE = 0.5
"""CPU time [s] within which a run is repeated, up to three times, for its price."""


@dataclass(frozen=True, slots=True)
class CoupledRow:
    """One run: its setting, its errors and its price."""

    algorithm: str
    extrapolation: int
    step: float
    """Communication step [s]; of adaptive ones the mean"""
    adaptive: float | None
    """Tolerance of adaptive steps; None for constant ones"""
    position: float | None
    """Largest error of a position at the communication points [m]; None if the run did not end"""
    later: float | None
    """The same after the start-up [m]"""
    residual: float | None
    """Largest power residual of a connection [W]; None without [[power]]"""
    cpu_time: float
    """[s], without building the FMUs"""
    steps: int
    evaluations: int
    """Of the models, iterations included"""
    note: str = ""
    """Why the run is of no use; empty where it is"""

    @property
    def is_stable(self) -> bool:
        """Whether it ended, with an error that is smaller than the motion itself."""
        return self.position is not None and not self.note


@dataclass(frozen=True, slots=True)
class Family:
    """What constant steps of one algorithm and order have in common."""

    algorithm: str
    extrapolation: int
    order: float | None
    """In the step, of the error after the start-up; None where fewer than three runs tell"""
    longest_stable: float | None
    """Longest step tried that is stable, as all shorter ones are [s]"""
    longest_accurate: float | None
    """The same for those that keep the accuracy [s]"""
    note: str
    """What became of the others"""


@dataclass(frozen=True, slots=True, eq=False)
class CouplingReport:
    """All that was measured of one coupling."""

    coupling: Coupling
    accuracy: float
    """[m]"""
    limit: float
    """[s of CPU time]"""
    truth: Truth
    rows: Sequence[CoupledRow]
    refused: Sequence[str]
    """What the models cannot do, in words"""

    @property
    def own(self) -> CoupledRow | None:
        """The run with the settings of the file; None if those are not among what was tried."""
        asked = self.coupling.spec.coupling
        if asked.adaptive is not None:
            return None
        setting = (asked.algorithm, asked.extrapolation, None)
        same = [row for row in self.rows if (row.algorithm, row.extrapolation, row.adaptive) == setting]
        return next((row for row in same if math.isclose(row.step, asked.step)), None)

    @property
    def recommended(self) -> CoupledRow | None:
        """The cheapest that keeps the accuracy; of those that cost the same but for noise, the one that errs least."""
        good = [row for row in self.rows if row.is_stable and _error(row) <= self.accuracy]
        if not good:
            return None
        cheapest = min(row.cpu_time for row in good)
        return min((row for row in good if row.cpu_time <= ALIKE * cheapest), key=_error)

    @property
    def families(self) -> list[Family]:
        """Constant steps, by algorithm and order."""
        constant = [row for row in self.rows if row.adaptive is None]
        names = dict.fromkeys((row.algorithm, row.extrapolation) for row in constant)
        return [self._family([row for row in constant if (row.algorithm, row.extrapolation) == name]) for name in names]

    def _family(self, rows: Sequence[CoupledRow]) -> Family:
        stable = [row for row in rows if row.is_stable]
        told = [row for row in stable if (row.later or 0.0) > _NOISE * self.truth.good_to]
        found = order([row.step for row in told], [row.later or 0.0 for row in told])
        notes = dict.fromkeys(row.note.partition(":")[0] for row in rows if row.note)
        return Family(
            rows[0].algorithm, rows[0].extrapolation, found, _longest(rows, lambda row: row.is_stable),
            _longest(rows, lambda row: row.is_stable and _error(row) <= self.accuracy), "; ".join(notes),
        )  # fmt: skip


def _error(row: CoupledRow) -> float:
    return row.position if row.position is not None else math.inf


def _longest(rows: Sequence[CoupledRow], passes: Callable[[CoupledRow], bool]) -> float | None:
    """Longest step up to which all pass."""
    found = None
    for row in sorted(rows, key=lambda row: row.step):
        if not passes(row):
            break
        found = row.step
    return found


def make_coupling_report(
    coupling: Coupling, *, accuracy: float | None = None, limit: float = 60.0,
    steps: Sequence[float] = STEPS, say: Said = lambda _: None,
) -> CouplingReport:  # fmt: skip
    """Measure a coupling.

    Parameters
    ----------
    coupling
        Its algorithm, extrapolation, step and adaptive steps are varied; all else stays as the file has it.
    accuracy
        Position error [m] that a setting is recommended for; 1 % of the motion by default.
    limit
        CPU time [s] that a run may take, looked at after every communication step.
    steps
        Communication steps to try, as multiples of the file's; of an algorithm and order none that is longer than one
        that is not stable, and no adaptive ones where none is.
    say
        Told what is done next.

    Raises
    ------
    OptionError
        An accuracy or limit out of range.
    CouplingError
        With one line for every mistake in the file, or between the models.
    RunError
        If there is nothing to measure against, or that is not good to a tenth of the accuracy.
    """
    check_coupling_options(accuracy, limit)
    with opened(coupling) as asked:
        spec = asked.settings
        system = asked if spec.report_time is None else varied(asked, stop_time=spec.report_time)
        say("reference")
        truth = find_truth(system)
        wanted = SHARE * truth.motion if accuracy is None else accuracy
        if not truth.good_to <= 0.1 * wanted:
            raise RunError(
                f"{coupling.name}: no reference is to be trusted: {truth.words}: it is good to {truth.good_to:.3g} m, "
                f"more than a tenth of the accuracy, {wanted:.3g} m"
            )
        rows: list[CoupledRow] = []
        refused: dict[str, None] = {}
        stable: set[tuple[str, int]] = set()
        unstable: set[tuple[str, int]] = set()
        for settings in _settings(system, steps):
            try:
                other = varied(system, **settings)
            except CouplingError as error:
                refused[str(error)] = None
                continue
            family = (other.settings.algorithm, other.settings.extrapolation)
            if family in (unstable if other.settings.adaptive is None else unstable - stable):
                continue  # as with all longer steps; a run that blows up costs more than all others
            say(_words(other))
            rows.append(_measured(other, truth, limit))
            (stable if rows[-1].is_stable else unstable).add(family)
    return CouplingReport(coupling, wanted, limit, truth, rows, list(refused))


def check_coupling_options(accuracy: float | None, limit: float) -> None:
    """Refuse numbers that make no sense.

    Raises
    ------
    OptionError
        An accuracy or a limit that is not above 0.
    """
    if accuracy is not None and not (math.isfinite(accuracy) and accuracy > 0.0):
        raise OptionError(f"accuracy = {accuracy:g}: a number above 0 [m] is expected")
    if not limit > 0.0:
        raise OptionError(f"limit = {limit:g}: a number above 0 [s of CPU time] is expected")


def _settings(system: System, steps: Sequence[float]) -> Iterator[dict[str, object]]:
    base = system.settings.step
    for algorithm, extrapolation in product(ALGORITHMS, ORDERS):
        for multiple in sorted(steps):
            yield {"algorithm": algorithm, "extrapolation": extrapolation, "step": base * multiple, "adaptive": None}
    for algorithm, tolerance in product(ALGORITHMS, TOLERANCES):
        adaptive = AdaptiveSpec(tolerance=tolerance, smallest=base * _LEAST_ADAPTIVE, largest=base * max(steps))
        yield {
            "algorithm": algorithm, "extrapolation": 1, "step": base * _LEAST_ADAPTIVE, "adaptive": adaptive
        }  # fmt: skip


def _words(system: System) -> str:
    asked = system.settings
    how = f"step {asked.step:g} s" if asked.adaptive is None else f"adaptive, {asked.adaptive.tolerance:g}"
    return f"{asked.algorithm}, order {asked.extrapolation}, {how}"


# --- one run ---


def _measured(system: System, truth: Truth, limit: float) -> CoupledRow:
    asked = system.settings
    adaptive = None if asked.adaptive is None else asked.adaptive.tolerance
    begun = clock.process_time()
    try:
        result, cpu_time = _timed(system, limit)
    except RunError as failure:
        spent, note = clock.process_time() - begun, f"failed: {failure}"
        return CoupledRow(
            asked.algorithm, asked.extrapolation, asked.step, adaptive, None, None, None, spent, 0, 0, note
        )
    off = _off(result, truth, positions_of(system))
    position, late = float(off.max()), result["time"].values >= STARTUP * asked.stop_time
    residuals = [float(np.abs(result[f"power.{bond.name}.residual"].values).max()) for bond in system.bonds]
    count = int(result.attrs["steps"])
    note = ""
    if position > truth.motion:
        note = f"diverged: off by {position:.2g} m, more than the motion itself, {truth.motion:.2g} m"
    return CoupledRow(
        asked.algorithm, asked.extrapolation, asked.step if adaptive is None else asked.stop_time / count, adaptive,
        position, float(off[late].max()), max(residuals, default=None), cpu_time, count,
        int(result.attrs["evaluations"]), note,
    )  # fmt: skip


def _timed(system: System, limit: float) -> tuple[xr.Dataset, float]:
    """The cheapest of three runs, or of those that begin within the patience."""
    cheapest, spent = math.inf, 0.0
    for _ in range(3):
        begun = clock.process_time()

        def in_time(time: float, stop: float, deadline: float = begun + limit) -> None:
            if clock.process_time() > deadline:
                raise RunError(f"more than {limit:g} s of CPU time", time=time)

        result = run_system(system, in_time)
        took = clock.process_time() - begun
        cheapest, spent = min(cheapest, took), spent + took
        if spent >= _PATIENCE:
            break
    return result, cheapest


def _off(result: xr.Dataset, truth: Truth, names: Sequence[str]) -> Floats:
    """Largest error of a position over the run's times [m], shape (m,)."""
    right = truth.at(result["time"].values)
    off = [np.abs(result[name].values - values) for name, values in right.items() if name in names]
    return np.asarray(np.max(off, axis=0), dtype=float)
