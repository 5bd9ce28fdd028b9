"""What goes through the connections: samples of every source, and what inputs make of them inside a step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..cable import Floats
from .connections import Connection, Variable
from .extrapolation import Polynomial, Sample, through
from .models import Model

__all__ = ["Exchange", "Outputs"]

Outputs = Mapping[Variable, float]
Snapshot = tuple[list[list[Sample]], Floats]


class Exchange:
    """Histories of all connections; numbers of connections are places in `connections`."""

    def __init__(self, connections: Sequence[Connection], models: Mapping[str, Model], order: int) -> None:
        self.connections = list(connections)
        self.order = order
        self.samples: list[list[Sample]] = [[] for _ in connections]
        nominal = [models[c.target.model].nominal(c.target.name) for c in connections]
        self.scale: Floats = np.array(nominal)
        """Largest value so far, at least the nominal"""
        self._into = {name: [k for k, c in enumerate(connections) if c.target.model == name] for name in models}

    def into(self, model: str) -> list[int]:
        """Connections that end at a model."""
        return self._into[model]

    def backward(self, order: Sequence[str]) -> list[int]:
        """Connections from a model to itself or one before it in this order: what a pass through it must guess."""
        place = {name: k for k, name in enumerate(order)}
        within = [k for k, c in enumerate(self.connections) if {c.source.model, c.target.model} <= place.keys()]
        ends = {k: (self.connections[k].source.model, self.connections[k].target.model) for k in within}
        return [k for k, (source, target) in ends.items() if place[source] >= place[target]]

    def out_of(self, model: str) -> list[int]:
        """Connections that begin at a model."""
        return [k for k, c in enumerate(self.connections) if c.source.model == model]

    def inputs(self, model: str) -> list[str]:
        """Connected inputs of a model."""
        return [self.connections[k].target.name for k in self._into[model]]

    def values(self, outputs: Outputs, numbers: Sequence[int] | None = None) -> Floats:
        """What these connections (by default all) carry when outputs are so."""
        chosen = range(len(self.connections)) if numbers is None else numbers
        through = (self.connections[k] for k in chosen)
        return np.array([c.gain * outputs[c.source] + c.offset for c in through])

    def accept(self, time: float, outputs: Outputs) -> None:
        """Take the values at a communication point as samples."""
        for k, value in enumerate(self.values(outputs)):
            self.samples[k] = (
                [*self.samples[k][-self.order :], (time, float(value))] if self.order else [(time, float(value))]
            )
            self.scale[k] = max(self.scale[k], abs(value))

    @property
    def is_short(self) -> bool:
        """Whether there are fewer samples of the past than the order needs."""
        return any(len(samples) <= self.order for samples in self.samples)

    def polynomial(self, k: int, newest: Sample | None = None) -> Polynomial:
        """What connection k carries inside a step, through a newest sample besides those accepted."""
        samples = self.samples[k] if newest is None else [*self.samples[k], newest]
        return through(samples, self.order)

    def save(self) -> Snapshot:
        return [list(samples) for samples in self.samples], self.scale.copy()

    def restore(self, snapshot: Snapshot) -> None:
        self.samples, self.scale = [list(samples) for samples in snapshot[0]], snapshot[1].copy()
