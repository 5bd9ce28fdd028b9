"""What errors are measured against, how good that is, and up to when a motion can be known at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .cable import Floats
from .errors import RunError
from .report_peers import dense_course
from .report_runs import OUTPUTS, Apart, Course, FmuRuns, apart, distance

__all__ = ["DENSE_LINKS", "Horizon", "Trusted", "trusted"]

TIGHT = (1e-11, 1e-10, 1e-9)
"""Tolerances of the reference, the first that the FMU reaches; 1e-11 is a hundredth of the ladder's tightest."""

GOOD = 0.1
"""Of the accuracy asked for: so far may a reference be from what it is checked by."""

DENSE_LINKS = 120
"""Up to so many links the dense reference answers within a minute or two."""

NUDGE = 1e-9
"""Of every start angle for the second run, times a normally distributed number [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Horizon:
    """Up to when two starts that hardly differ stay together."""

    time: float
    """Last output time up to which they do [s]"""
    is_chaotic: bool
    """Whether that is before the stop time"""
    growth: Floats
    """Distance of the two over the output times of the reference, shape (m,) [m]"""


@dataclass(frozen=True, slots=True, eq=False)
class Trusted:
    """The reference of a scene."""

    course: Course
    tolerance: float
    checked_by: str
    """What it was compared with, in words"""
    is_independent: bool
    """Whether that is another solver on other equations"""
    difference: Apart
    """Its distance from that, up to the horizon: so good is it"""
    horizon: Horizon


def trusted(runs: FmuRuns, accuracy: float, limit: float) -> Trusted:
    """Find a scene's reference, what it is good to, and its horizon.

    Parameters
    ----------
    accuracy
        Motion is chaotic from where two starts 1e-9 rad apart differ by more than this [m]; `GOOD` of it is what the
        reference must be good to.
    limit
        CPU time of every run [s].

    Raises
    ------
    RunError
        If the FMU reaches no tight tolerance in that time, if the two starts part within the first output interval, or
        if the reference and what it is checked by are more than a tenth of `accuracy` apart.
    """
    course, tolerance = _tightest(runs, limit)
    horizon = _horizon(runs, course, tolerance, accuracy)
    words, is_independent, others = _second_opinions(runs, tolerance, limit)
    found = [apart(other, course, horizon.time) for other in others]
    difference = max(found, key=lambda off: off.position)
    if not difference.position <= GOOD * accuracy:
        raise RunError(
            f"{runs.scene.name}: no reference is to be trusted: the FMU at {tolerance:g} and {words} are "
            f"{difference.position:.3g} m apart up to {horizon.time:g} s, more than a tenth of the accuracy asked for"
        )
    return Trusted(course, tolerance, words, is_independent, difference, horizon)


def _tightest(runs: FmuRuns, limit: float) -> tuple[Course, float]:
    reason = ""
    for tolerance in TIGHT:
        try:
            return runs.run(tolerance=tolerance, limit=limit), tolerance
        except RunError as error:
            reason = str(error)
    raise RunError(f"{runs.scene.name}: no reference, as no run at a tolerance of {TIGHT[-1]:g} ended: {reason}")


def _horizon(runs: FmuRuns, course: Course, tolerance: float, accuracy: float) -> Horizon:
    cable = runs.scene.cable
    nudge = NUDGE * np.random.default_rng(1).standard_normal(cable.n)
    start = {f"theta[{i}]": float(cable.position[i] + nudge[i - 1]) for i in range(1, cable.n + 1)}
    other = runs.run(tolerance=tolerance, start=start)
    growth = distance({name: other.outputs[name] - course.outputs[name] for name in OUTPUTS})
    parted = growth > accuracy
    if not np.any(parted):
        return Horizon(float(course.times[-1]), False, growth)
    first = int(np.argmax(parted))
    if first < 2:
        raise RunError(
            f"{runs.scene.name}: two starts {NUDGE:g} rad apart part by more than {accuracy:g} m within the first "
            "output interval; a shorter step in the scene, or a larger accuracy, is needed"
        )
    return Horizon(float(course.times[first - 1]), True, growth)


def _second_opinions(runs: FmuRuns, tolerance: float, limit: float) -> tuple[str, bool, list[Course]]:
    """Another solver on other equations; where that is out of reach, the FMU's own two methods."""
    reason = f"{runs.scene.cable.n} links are more than {DENSE_LINKS}"
    if runs.scene.cable.n <= DENSE_LINKS:
        try:
            return "the dense NumPy model under scipy's DOP853", True, [dense_course(runs.scene, limit)]
        except RunError as error:
            reason = f"the dense NumPy model took {error}"
    words = f"own solver only ({reason}): its explicit against its implicit method"
    methods: list[Callable[[], Course]] = [
        lambda: runs.run(tolerance=tolerance, solver="explicit", limit=limit),
        lambda: runs.run(tolerance=tolerance, solver="implicit", limit=limit),
    ]
    both = [found for method in methods if (found := _unless_slow(method)) is not None]
    if len(both) < 2:
        looser = 10.0 * tolerance
        words = f"own solver only ({reason}, and one of its two methods is too slow): itself at {looser:g}"
        both = [runs.run(tolerance=looser)]
    return words, False, both


def _unless_slow(run: Callable[[], Course]) -> Course | None:
    try:
        return run()
    except RunError:
        return None
