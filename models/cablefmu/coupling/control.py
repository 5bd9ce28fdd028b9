"""How long steps are: constant ones, or so long that an estimate of their error stays at its tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from ..errors import RunError
from .exchange import Exchange
from .partners import Partner
from .schema import AdaptiveSpec
from .step import Ended, Stepper
from .system import System

__all__ = ["Adaptive", "Constant"]

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 2.0
_QUIET = 1.0
"""Power that is not told from none [W]."""
_MOST_STEPS = 10_000_000

Taken = tuple[float, float, Ended]
"""A step's start and end [s], and how it ended."""


class Constant:
    """Steps of one length; the last may be shorter."""

    rejected = 0

    def __init__(self, system: System, step: Stepper) -> None:
        self._times, self._step = system.times(), step

    def steps(self) -> Iterator[Taken]:
        for start, end in pairwise(self._times):
            yield start, end, self._step(start, end)


class Adaptive:
    """Steps of varying length.

    The error of a step of length h with inputs of order p goes with h^(p+1): the next is
    0.9 h (tolerance / error)^(1/(p+1)), at most twice as long. The error is how far inputs came out from where they
    were extrapolated to, or the power residual. A step with too large an error is repeated where every model can
    be rolled back, and counted where not. While there are too few samples for order p, at the start, steps are of the
    smallest length and not judged.
    """

    def __init__(
        self, system: System, partners: Mapping[str, Partner], exchange: Exchange, step: Stepper, adaptive: AdaptiveSpec
    ) -> None:
        self._system, self._partners, self._exchange = system, partners, exchange
        self._step, self._adaptive = step, adaptive
        self._powers = np.full(len(system.bonds), _QUIET)
        self.rejected = 0
        """Steps whose error was above the tolerance: repeated, if that is possible"""

    def steps(self) -> Iterator[Taken]:
        time, stop = 0.0, self._system.settings.stop_time
        smallest, largest = self._adaptive.smallest, self._adaptive.largest
        size = min(max(self._system.settings.step, smallest), largest)
        for count in range(_MOST_STEPS):
            judged = count >= self._exchange.order
            size = size if judged else smallest
            end = stop if time + size * (1.0 + 1e-9) >= stop else time + size
            ended, error, where = self._tried(time, end, judged=judged)
            while error > 1.0 and self._system.can_repeat:
                self.rejected += 1
                if end - time <= smallest:
                    raise RunError(
                        f"{where}: a step below {smallest:g} s would be needed at t = {time:.12g} s; {self._advice}"
                    )
                size = max(self._next(end - time, error), smallest)
                end = time + size
                ended, error, where = self._tried(time, end, judged=True)
            self._remember(ended)
            self.rejected += error > 1.0
            yield time, end, ended
            if end == stop:
                return
            size = min(max(self._next(end - time, error), smallest), largest)
            time = end
        raise RunError(f"more than {_MOST_STEPS:,} steps")

    @property
    def _advice(self) -> str:
        """What a user can do where steps get too short."""
        text = "a smaller adaptive.smallest or a larger adaptive.tolerance is expected"
        if self._system.loops and self._system.settings.algorithm != "iterated":
            text += '; if none is small enough, the delayed loop is unstable, and algorithm = "iterated" is'
        return text

    def _next(self, size: float, error: float) -> float:
        order = self._exchange.order + 1
        factor = _GROW if error == 0.0 else _SAFETY * error ** (-1.0 / order)
        return size * min(max(factor, _SHRINK), _GROW)

    def _tried(self, time: float, end: float, *, judged: bool) -> tuple[Ended, float, str]:
        """One step, its error in units of the tolerance, and where that was; taken back if it will be repeated."""
        expected = np.array([self._exchange.polynomial(k)(end) for k in range(len(self._exchange.connections))])
        states = _saved(self._partners) if self._system.can_repeat else {}
        try:
            ended = self._step(time, end)
            errors, names = self._errors(ended, expected)
            k = int(np.argmax(errors)) if errors.size else 0
            error, where = (float(errors[k]), names(k)) if errors.size and judged else (0.0, "")
            if error > 1.0:
                for name, state in states.items():
                    self._partners[name].restore(state)
        finally:
            for name, state in states.items():
                self._partners[name].forget(state)
        return ended, error, where

    def _errors(self, ended: Ended, expected: Any) -> tuple[Any, Callable[[int], str]]:
        if self._adaptive.control == "signals":
            found = self._exchange.values(ended.outputs)
            scale = np.maximum(self._exchange.scale, np.abs(found))
            errors = np.abs(found - expected) / (self._adaptive.tolerance * scale)
            return errors, lambda k: f"connection {self._exchange.connections[k]}"
        powers = np.array([bond.powers(ended.outputs, ended.inputs) for bond in self._system.bonds])
        largest = np.maximum(self._powers, np.abs(powers).max(axis=1))
        errors = np.abs(powers[:, 0] - powers[:, 1]) / (self._adaptive.tolerance * largest)
        return errors, lambda k: f"power {self._system.bonds[k].name}"

    def _remember(self, ended: Ended) -> None:
        for k, bond in enumerate(self._system.bonds):
            self._powers[k] = max(self._powers[k], *map(abs, bond.powers(ended.outputs, ended.inputs)))


def _saved(partners: Mapping[str, Partner]) -> dict[str, Any]:
    return {name: partner.save() for name, partner in partners.items()}
