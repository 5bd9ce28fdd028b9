"""How many cases go to a worker at once: enough that sending them costs little, few enough that all end together."""

from __future__ import annotations

import math

__all__ = ["IN_HAND", "Sizer"]

TARGET = 0.5
"""What a batch should take [s]: the work that an interruption may lose, a hundred times what a task costs."""
_LEAST = 0.05
"""... and at least towards the end [s]"""
IN_HAND = 2
"""Batches that a worker has: one that it runs, one that waits for it."""


class Sizer:
    """Learns from every batch what a case costs."""

    def __init__(self) -> None:
        self._cases, self._seconds = 0, 0.0

    def learn(self, cases: int, seconds: float) -> None:
        self._cases += cases
        self._seconds += seconds

    def next(self, waiting: int, workers: int) -> int:
        """Cases of the next batch, of so many that wait; one by one until something is known."""
        if not self._cases:
            return min(1, waiting)
        case = max(self._seconds / self._cases, 1e-6)
        share = math.ceil(waiting / (IN_HAND * workers))  # of what is left: batches get smaller towards the end
        wanted = max(min(round(TARGET / case), share), round(_LEAST / case), 1)
        return min(wanted, waiting)
