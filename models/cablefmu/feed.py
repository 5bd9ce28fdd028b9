"""Forces over time, as a run feeds them to an FMU.

A communication step never spans a jump of an input. Inside a step the FMU follows the force, and does
not hold it: by its time derivatives at the step's start (FMI 2), or by asking back (FMI 3). So a run does not
depend on the communication step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .scene_inputs import FOLLOWING
from .signals import Constant, Signal

__all__ = ["ORDERS", "Feed"]

ORDERS = 8
"""Derivatives that the FMU takes, INPUT_ORDERS in instance.h."""

_EXACT = 1e-12
"""Largest misfit of the polynomial over one step, relative to the force's own size."""

_ROUNDING = 8.0
"""Late in a run a force is known only as well as its time: to so many units in the last place of it."""

_FOLLOWED = {
    *(place for place, _ in FOLLOWING.values()),
    *(name for name, (_, order) in FOLLOWING.items() if order == 1),
}
"""Places and velocities, which follow what is held."""

_SHORTEST = 2.0**-20
"""Smallest part of a step; a force that needs smaller ones is beyond every solver's patience."""


@dataclass(frozen=True, slots=True)
class Feed:
    """The inputs of one run; `names` and `signals` go together."""

    signals: Mapping[str, Signal]

    @property
    def names(self) -> list[str]:
        return list(self.signals)

    @property
    def varies(self) -> bool:
        """Whether any force changes during the run."""
        return any(not isinstance(signal, Constant) for signal in self.signals.values())

    def values(self, time: float) -> list[float]:
        """Forces at `time`, after a jump [N]."""
        return [signal(time) for signal in self.signals.values()]

    def values_to_hold(self, time: float, end: float) -> list[float]:
        """For a step in which nothing but acceleration is held: that, and forces, as they are in its middle."""
        middle = 0.5 * (time + end)
        return [signal(time if name in _FOLLOWED else middle) for name, signal in self.signals.items()]

    def values_before(self, time: float, limit: float) -> list[float]:
        """Forces at `time` or, from `limit` on, just before `limit`, where they jump [N]."""
        return self.values(time if time < limit else math.nextafter(limit, -math.inf))

    def derivatives(self, time: float) -> list[list[float]]:
        """Per input its derivatives at `time`, after a jump: to `ORDERS` or its degree, as all others are 0."""
        return [signal.derivatives(time, _orders(signal)) for signal in self.signals.values()]

    def next_break(self, time: float, end: float) -> float:
        """The next time after `time` at which a force or its slope jumps, or `end` if none does before."""
        return min((b for signal in self.signals.values() for b in signal.breaks(time, end)), default=end)

    def polynomial_reach(self, time: float, end: float) -> float:
        """How far from `time`, at most to `end`, the derivatives at `time` describe every force."""
        reach = end - time
        shortest = reach * _SHORTEST
        for signal in self.signals.values():
            if signal.degree is not None and signal.degree <= ORDERS:
                continue
            derivatives = signal.derivatives(time, ORDERS)
            while reach > shortest and not all(_fits(signal, time, reach * part, derivatives) for part in (0.5, 1.0)):
                reach *= 0.5
        return time + reach if reach < end - time else end


def _orders(signal: Signal) -> int:
    return ORDERS if signal.degree is None else min(signal.degree, ORDERS)


def _fits(signal: Signal, time: float, ahead: float, derivatives: Sequence[float]) -> bool:
    """Whether the polynomial at time + ahead is the force there, just before a jump, but for rounding."""
    total = signal(time)
    size, slope, power = abs(total), 0.0, 1.0  # power: ahead^(k-1) / (k-1)!
    for order, derivative in enumerate(derivatives, start=1):
        slope += abs(derivative * power)
        power *= ahead / order
        total += derivative * power
        size += abs(derivative * power)
    actual = signal(max(time, math.nextafter(time + ahead, -math.inf)))
    return abs(total - actual) <= _EXACT * size + _ROUNDING * math.ulp(time + ahead) * slope
