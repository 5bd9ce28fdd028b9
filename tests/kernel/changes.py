"""What derivatives and outputs of a cable change by, of the dense equation by complex step.

f(x + i h d) = f(x) + i h f'(x) d + O(h^2), and h = 1e-30 leaves nothing of the rest: the derivative of the dense
equation, exact but for its rounding, without a line of algebra. It is taken in long double: of doubles the
equation's condition leaves 2e-10 at 60 links, of the kernel's own derivative 2e-12.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from cablefmu.cable import Cable, Floats
from cablefmu.reference.extended import long_double_acceleration, long_double_outputs
from tests.kernel.cases import Case

__all__ = ["Direction", "expected_changes", "random_directions", "unit_directions"]

STEP = np.longdouble(1e-30)


@dataclass(frozen=True)
class Direction:
    """What states and inputs change by."""

    q: Floats
    v: Floats
    inputs: Mapping[str, float]


def unit_directions(cable: Cable) -> Iterator[Direction]:
    """Every coordinate, every rate, every input, one at a time."""
    half = cable.coordinates
    none, nothing = dict.fromkeys(cable.inputs, 0.0), np.zeros(half)
    for one in np.eye(half):
        yield Direction(one, nothing, none)
        yield Direction(nothing, one, none)
    for name in cable.inputs:
        yield Direction(nothing, nothing, none | {name: 1.0})


def random_directions(cable: Cable, count: int) -> Iterator[Direction]:
    """Everything at once, inputs by kilonewtons so that they are seen beside the rest."""
    rng = np.random.default_rng(count)
    for _ in range(count):
        q, v = rng.normal(size=(2, cable.coordinates))
        yield Direction(q, v, {name: 1e3 * rng.normal() for name in cable.inputs})


def expected_changes(c: Case, along: Direction) -> tuple[Floats, dict[str, float]]:
    """Of accelerations and outputs, by complex step."""
    step = 1j * STEP
    q, v = c.q + step * along.q, c.v + step * along.v
    inputs = {name: value + step * along.inputs[name] for name, value in c.inputs.items()}
    acceleration = long_double_acceleration(c.cable, q, v, inputs).imag / STEP
    outputs = {name: np.imag(y) / STEP for name, y in long_double_outputs(c.cable, q, v, inputs).items()}
    return acceleration.astype(float), {name: float(change) for name, change in outputs.items()}
