"""Power through the connections: what one model gives less what the other takes.

A flow goes one way and an effort comes back. Model A says the flow y_f and is given the effort u_e; model B says the
effort y_e and is given the flow u_f. At the end of a step A's power is y_f u_e, B's u_f y_e. They differ by as much as
the inputs, held or extrapolated, are no longer the other's outputs (the residual of Sadjina et al., 2017). Gains are
divided out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..scene_mistakes import Mistake
from .connections import Connection, Variable, find_variable
from .models import Model
from .schema import FileSpec

__all__ = ["Bond", "bonds_of"]

_WATT = (1, 2, -3, 0, 0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Bond:
    """A flow and the effort that comes back."""

    name: str
    flow: Connection
    effort: Connection

    def powers(self, outputs: Mapping[Variable, float], inputs: Mapping[Variable, float]) -> tuple[float, float]:
        """Power by the side that says the flow, and by the side that says the effort [W]."""
        given = outputs[self.flow.source] * inputs[self.effort.target] / self.effort.gain
        taken = inputs[self.flow.target] / self.flow.gain * outputs[self.effort.source]
        return given, taken


def bonds_of(
    spec: FileSpec, models: Mapping[str, Model], connections: Sequence[Connection], mistakes: list[Mistake]
) -> list[Bond]:
    """Resolve every [[power]]; what is wrong is added to `mistakes`."""
    bonds: list[Bond] = []
    all_known = not mistakes  # a connection that has a mistake of its own is not missed here
    usable = [c for c in connections if c.gain and not c.offset]
    for k, table in enumerate(spec.power, start=1):
        key = f"power {k}"
        flow = find_variable(f"{key}.flow", table.flow, "output", spec, models, mistakes)
        effort = find_variable(f"{key}.effort", table.effort, "output", spec, models, mistakes)
        if flow is None or effort is None:
            continue
        there = [c for c in usable if c.source == flow and c.target.model == effort.model]
        back = [c for c in usable if c.source == effort and c.target.model == flow.model]
        if len(there) != 1 or len(back) != 1:
            text = (
                f"one connection from {flow} to model {effort.model} and one from {effort} to {flow.model}, "
                "without offsets, are expected"
            )
            mistakes += [Mistake(key, text)] if all_known else []
            continue
        units = [models[v.model].unit(v.name) for v in (flow, effort)]
        if all(units):
            product = tuple(a + b for a, b in zip(units[0].exponents, units[1].exponents, strict=True))  # type: ignore[union-attr]
            if product != _WATT:
                names = " times ".join(unit.name for unit in units if unit)
                mistakes.append(Mistake(key, f"{flow} times {effort} is {names}, which is no power"))
                continue
        if table.name in [bond.name for bond in bonds]:
            mistakes.append(Mistake(f"{key}.name", "another power has this name; once is allowed", table.name))
            continue
        bonds.append(Bond(table.name, there[0], back[0]))
    return bonds
