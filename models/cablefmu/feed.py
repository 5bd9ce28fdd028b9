"""Forces over time, as a run feeds them to an FMU.

A communication step never spans a jump of an input. Inside a step the FMU follows the force, and does
not hold it: by its time derivatives at the step's start (FMI 2), or by asking back (FMI 3). So a run does not
depend on the communication step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from .scene_inputs import FOLLOWING
from .signals import Constant, Derivative, Signal

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


@dataclass(frozen=True)
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

    def values_and_derivatives(self, time: float) -> tuple[list[float], list[list[float]]]:
        """Per input its value and its derivatives at `time`, after a jump: to `ORDERS` or its degree, others are 0."""
        known = [[source(time), *source.derivatives(time, most)] for source, most in self._sources]
        values = [known[place][order] for place, order, _ in self._places]
        return values, [known[place][order + 1 : order + 1 + count] for place, order, count in self._places]

    @property
    def orders(self) -> list[int]:
        """Per input how many derivatives say all of it."""
        return [_orders(signal) for signal in self.signals.values()]

    def next_break(self, time: float, end: float) -> float:
        """The next time after `time` at which a force or its slope jumps, or `end` if none does before."""
        return min((b for source, _ in self._sources for b in source.breaks(time, end)), default=end)

    @cached_property
    def _places(self) -> list[tuple[int, int, int]]:
        """Per input: which source it is of, which derivative of that, and how many derivatives say all of it."""
        sources = [id(source) for source, _ in self._sources]
        return [(sources.index(id(_source(s))), _order(s), _orders(s)) for s in self.signals.values()]

    @cached_property
    def _sources(self) -> list[tuple[Signal, int]]:
        """Each signal once of which others are derivatives, and how many derivatives all of them take."""
        most: dict[int, tuple[Signal, int]] = {}
        for signal in self.signals.values():
            source, order = _source(signal), _order(signal) + _orders(signal)
            most[id(source)] = (source, max(order, most.get(id(source), (source, 0))[1]))
        return list(most.values())

    @cached_property
    def _curved(self) -> list[Signal]:
        """Those that are no polynomial which `ORDERS` derivatives say."""
        return [s for s in self.signals.values() if s.degree is None or s.degree > ORDERS]

    def polynomial_reach(self, time: float, end: float) -> float:
        """How far from `time`, at most to `end`, the derivatives at `time` describe every force."""
        reach = end - time
        shortest = reach * _SHORTEST
        for signal in self._curved:
            derivatives = signal.derivatives(time, ORDERS)
            while reach > shortest and not all(_fits(signal, time, reach * part, derivatives) for part in (0.5, 1.0)):
                reach *= 0.5
        return time + reach if reach < end - time else end


def _source(signal: Signal) -> Signal:
    return signal.of if isinstance(signal, Derivative) else signal


def _order(signal: Signal) -> int:
    return signal.order if isinstance(signal, Derivative) else 0


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
