"""What an input does inside a step: the polynomial through the newest samples of its source."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Polynomial", "through"]

Sample = tuple[float, float]
"""Time [s] and value"""


@dataclass(frozen=True, slots=True)
class Polynomial:
    """Newton's form: c_0 + c_1 (t - t_0) + c_2 (t - t_0)(t - t_1), newest sample first."""

    nodes: tuple[float, ...]
    coefficients: tuple[float, ...]

    def __call__(self, time: float) -> float:
        value = 0.0
        for node, coefficient in zip(reversed(self.nodes), reversed(self.coefficients), strict=True):
            value = value * (time - node) + coefficient
        return value

    def derivatives(self, time: float) -> list[float]:
        """Of order 1, 2 ... at `time`, as many as its order."""
        if len(self.nodes) == 1:
            return []
        slope = self.coefficients[1]
        if len(self.nodes) == 2:
            return [slope]
        bend = self.coefficients[2]
        return [slope + bend * ((time - self.nodes[0]) + (time - self.nodes[1])), 2.0 * bend]


def through(samples: Sequence[Sample], order: int) -> Polynomial:
    """The polynomial of at most this order, 0 to 2, through the newest samples; the last is the newest.

    With fewer samples than order + 1, as at the start, of a lower order.
    """
    newest = list(reversed(samples[-order - 1 :]))
    nodes = tuple(time for time, _ in newest)
    differences = [value for _, value in newest]
    coefficients = [differences[0]]
    for span in range(1, len(nodes)):
        differences = [
            (differences[k] - differences[k + 1]) / (nodes[k] - nodes[k + span]) for k in range(len(differences) - 1)
        ]
        coefficients.append(differences[0])
    return Polynomial(nodes, tuple(coefficients))
