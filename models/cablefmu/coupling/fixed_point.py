"""Values w with G(w) = w: what an iterated step and the start of a coupling look for.

G is one evaluation of all models. Plain repetition, w <- G(w), diverges where a vessel is lighter than the cable
that it carries: the error is multiplied by minus the ratio of their masses. The interface quasi-Newton method takes the
combination of what was tried whose residuals r = G(w) - w cancel in the least-squares sense, w <- G(w) + W c,
c = argmin |V c + r|, with the changes of residuals in V and of G in W (IQN-ILS; Degroote, Bathe and Vierendeels,
2009; the same as Anderson's mixing). It needs no derivatives, and in a linear problem of m values ends after at most
m + 2 evaluations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ..cable import Floats
from .schema import IterationSpec

__all__ = ["Found", "NotFoundError", "solve"]

_SMALLEST = 1e-12
"""Of the largest singular value: directions that say less are rounding."""


@dataclass(frozen=True, slots=True)
class Found:
    """A fixed point."""

    values: Floats
    evaluations: int


class NotFoundError(Exception):
    """No fixed point after so many evaluations; `residual` relative to the scale of each value."""

    def __init__(self, residual: Floats) -> None:
        super().__init__("no fixed point")
        self.residual = residual


class _Method(Protocol):
    def next(self, tried: Floats, given: Floats) -> Floats:
        """Where to evaluate next, after G(tried) = given."""


@dataclass(slots=True)
class _Plain:
    def next(self, tried: Floats, given: Floats) -> Floats:
        return given


@dataclass(slots=True)
class _QuasiNewton:
    residuals: list[Floats] = field(default_factory=list)
    givens: list[Floats] = field(default_factory=list)

    def next(self, tried: Floats, given: Floats) -> Floats:
        self.residuals.append(given - tried)
        self.givens.append(given)
        if len(self.givens) == 1:
            return given
        newest = slice(max(0, len(self.givens) - 1 - tried.size), -1)  # more columns than values say nothing new
        V = np.column_stack(self.residuals[newest]) - self.residuals[-1][:, None]
        W = np.column_stack(self.givens[newest]) - given[:, None]
        c = np.linalg.lstsq(V, -self.residuals[-1], rcond=_SMALLEST)[0]
        return np.asarray(given + W @ c, dtype=float)


_METHODS: dict[str, Callable[[], _Method]] = {"quasi-newton": _QuasiNewton, "none": _Plain}


def solve(evaluate: Callable[[Floats], Floats], first: Floats, scale: Floats, settings: IterationSpec) -> Found:
    """Evaluate until no value changes by more than the tolerance, relative to its scale.

    Parameters
    ----------
    evaluate
        G.
    first
        Where to begin, shape (m,).
    scale
        Size of each value, above 0, shape (m,).
    settings
        Tolerance, most evaluations, and how the next try is found.

    Returns
    -------
    Found
        The values of the last evaluation.

    Raises
    ------
    NotFoundError
        If there was none after `settings.most` evaluations, or a value is no longer a finite number.
    """
    method = _METHODS[settings.acceleration]()
    tried = first / scale
    residual = np.zeros_like(first)
    for count in range(1, settings.most + 1):
        given = evaluate(tried * scale) / scale
        residual = np.abs(given - tried)
        if np.all(residual <= settings.tolerance):
            return Found(given * scale, count)
        tried = method.next(tried, given)
        if not np.all(np.isfinite(tried)):
            break
    raise NotFoundError(residual)
