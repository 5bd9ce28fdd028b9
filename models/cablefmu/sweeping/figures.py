"""What is kept of a run: extremes of every output, and of tensions how much they tire the cable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import fsum

import rainflow

from ..cable import Floats
from .schema import StatisticsSpec
from .subjects import Outcome, Output

__all__ = ["EXTREMES", "Plan", "equivalent_range", "figures", "plan_for"]

EXTREMES = ("min", "max", "final")
_FATIGUE = ("tension_top", "tension_end", "tension_max")


@dataclass(frozen=True, slots=True)
class Plan:
    """Which of a subject's outputs are kept, and of which of them cycles are counted."""

    kept: Mapping[str, int]
    """Column of each"""
    fatigue: Sequence[str]
    slope: float


def plan_for(outputs: Sequence[Output], spec: StatisticsSpec) -> Plan:
    """Of the outputs that a subject has; what the file names and the subject lacks is left out."""
    columns = {output.name: k for k, output in enumerate(outputs)}
    health = [name for name in columns if "solver" in name.split(".")[:-1] or "statics" in name.split(".")[:-1]]
    wanted = [name for name in columns if name not in health] if spec.outputs is None else spec.outputs
    tensions = [name for name in columns if name.rpartition(".")[2] in _FATIGUE and name in wanted]
    fatigue = tensions if spec.fatigue is None else [name for name in spec.fatigue if name in columns]
    names = dict.fromkeys([*(name for name in wanted if name in columns), *fatigue])
    return Plan({name: columns[name] for name in names}, fatigue, spec.slope)


def figures(outcome: Outcome, plan: Plan) -> dict[str, float]:
    """NAME.min, NAME.max, NAME.final over the output times, and NAME.equivalent for what tires."""
    found: dict[str, float] = {}
    for name, column in plan.kept.items():
        values = outcome.values[:, column]
        found[f"{name}.min"], found[f"{name}.max"] = float(values.min()), float(values.max())
        found[f"{name}.final"] = float(values[-1])
    duration = float(outcome.times[-1] - outcome.times[0])
    for name in plan.fatigue:
        series = outcome.values[:, plan.kept[name]]
        found[f"{name}.equivalent"] = equivalent_range(series, duration, plan.slope)
    return found


def equivalent_range(series: Floats, duration: float, slope: float) -> float:
    """Range of the sine of 1 Hz that does the same damage in the same time.

    Cycles by rainflow counting (ASTM E1049-85, 5.4.4), half cycles as halves; damage after Palmgren and Miner on an
    S-N curve N S^m = const: S_eq = (sum n_i S_i^m / (duration x 1 Hz))^(1/m).

    Parameters
    ----------
    series
        Values over time, in any unit.
    duration
        [s]
    slope
        m of the S-N curve.

    Returns
    -------
    float
        In the unit of the series; 0 where nothing changes.
    """
    cycles = [(size, count) for size, _, count, _, _ in rainflow.extract_cycles(series.tolist())]
    largest = max((size for size, _ in cycles), default=0.0)
    if largest == 0.0:
        return 0.0
    # Relative to the largest, so that no power of it overflows.
    damage = fsum(count * (size / largest) ** slope for size, count in cycles)
    return float(largest * (damage / duration) ** (1.0 / slope))
