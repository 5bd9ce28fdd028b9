"""A coupling with its FMUs: everything that can be refused is refused before the run, all of it at once."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..fmu.platforms import for_this_machine
from ..scene_mistakes import Mistake
from .connections import Connection, Variable, connect
from .description import Coupling
from .graph import loops, order
from .mistakes import coupling_error
from .models import Model, open_models
from .power import Bond, bonds_of
from .schema import CouplingSpec

__all__ = ["System", "opened", "varied"]

_ROUNDING = 1e-9
"""Relative: a stop time that is so near a multiple of the step is one."""
_MOST_STEPS = 10_000_000


@dataclass(frozen=True)
class System:
    """Models, what connects them, and the order to step them in."""

    coupling: Coupling
    models: Mapping[str, Model]
    """In the order of the file."""
    connections: Sequence[Connection]
    bonds: Sequence[Bond]
    loops: Sequence[Sequence[Connection]]

    @property
    def settings(self) -> CouplingSpec:
        return self.coupling.spec.coupling

    @property
    def order(self) -> list[str]:
        """Sources before what they feed."""
        return order(list(self.models), self.connections)

    @property
    def iterated(self) -> list[str]:
        """Models whose step depends on others': what has no connected input is stepped once."""
        return [name for name in self.models if any(c.target.model == name for c in self.connections)]

    @property
    def holding(self) -> list[Variable]:
        """Connected inputs that stay constant inside a step because their FMU takes no other."""
        return [c.target for c in self.connections if not self.models[c.target.model].interpolates(c.target.name)]

    @property
    def can_repeat(self) -> bool:
        """Whether a whole step can be taken back."""
        return all(model.can_roll_back for model in self.models.values())

    @property
    def starts_iterated(self) -> bool:
        """Whether the first steps, which have too few samples, are iterated: where the models can go back."""
        return self.settings.extrapolation > 0 and not self.fixed

    @property
    def fixed(self) -> list[str]:
        """Models with connected inputs that cannot be rolled back."""
        return [name for name in self.iterated if not self.models[name].can_roll_back]

    @property
    def notes(self) -> list[str]:
        """What the user should know of this coupling before it runs."""
        notes = []
        if self.settings.extrapolation and self.holding:
            names = ", ".join(map(str, self.holding))
            notes.append(
                f"held inside a step at the value extrapolated to its end, as the FMU takes no slopes: {names}"
            )
        if self.settings.extrapolation == 2 and self.fixed:
            names = ", ".join(self.fixed)
            notes.append(
                "the first steps have inputs of lower order, which leaves an error of the step squared, "
                f"as these models cannot be rolled back: {names}"
            )
        if self.settings.adaptive and not self.can_repeat:
            names = ", ".join(name for name, model in self.models.items() if not model.can_roll_back)
            notes.append(f"no step is repeated, as these models cannot be rolled back: {names}")
        return notes

    def times(self) -> list[float]:
        """Communication points of constant steps: 0, step, 2 step, ..., and the stop time [s]."""
        stop, step = self.settings.stop_time, self.settings.step
        count = max(1, math.ceil(stop / step * (1.0 - _ROUNDING)))
        return [k * step for k in range(count)] + [stop]


@contextmanager
def opened(coupling: Coupling, *, elsewhere: bool = False) -> Iterator[System]:
    """Build, unpack and check everything in a temporary folder.

    `elsewhere`: whether FMUs of scenes are to run on other machines than this one as well.

    Raises
    ------
    CouplingError
        With one line for every mistake.
    """
    folder = Path(tempfile.mkdtemp(prefix="cablefmu-"))
    mistakes: list[Mistake] = []
    try:
        models = open_models(coupling, folder, mistakes, None if elsewhere else for_this_machine())
        connections = connect(coupling.spec, models, mistakes)
        models = {name: _without_fed(model, connections) for name, model in models.items()}
        bonds = bonds_of(coupling.spec, models, connections, mistakes)
        system = System(coupling, models, connections, bonds, loops(models, connections))
        mistakes += _wrong_settings(system)
        if mistakes:
            raise coupling_error(coupling.source, mistakes)
        yield system
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def varied(system: System, **settings: Any) -> System:
    """The same models and connections with other settings of [coupling].

    Raises
    ------
    CouplingError
        If the models do not have what these ask for.
    """
    spec = system.coupling.spec
    spec = spec.model_copy(update={"coupling": spec.coupling.model_copy(update=settings)})
    other = replace(system, coupling=replace(system.coupling, spec=spec))
    mistakes = list(_wrong_settings(other))
    if mistakes:
        raise coupling_error(other.coupling.source, mistakes)
    return other


def _without_fed(model: Model, connections: Sequence[Connection]) -> Model:
    """With constant values for those inputs alone that nothing is connected to."""
    fed = {c.target.name for c in connections if c.target.model == model.name}
    return replace(model, constants={name: value for name, value in model.constants.items() if name not in fed})


def _wrong_settings(system: System) -> Iterator[Mistake]:
    """What the algorithm asks of the models, and they do not have."""
    settings = system.settings
    if settings.stop_time / settings.step > _MOST_STEPS:
        yield Mistake("coupling.step", f"more than {_MOST_STEPS:,} steps; a longer one is expected", settings.step)
    if settings.algorithm == "iterated":
        for name in system.fixed:
            text = f"model {name} cannot be rolled back (canGetAndSetFMUstate); jacobi or gauss-seidel is expected"
            yield Mistake("coupling.algorithm", text, settings.algorithm)
    else:
        for loop in system.loops:
            if not any(connection.delayed for connection in loop):
                names = ", ".join(map(str, loop))
                text = f"algebraic loop: {names}; iterated is expected, or delayed = true in one of them"
                yield Mistake("coupling.algorithm", text, settings.algorithm)
    if settings.adaptive and settings.adaptive.control == "power" and not system.bonds:
        yield Mistake("coupling.adaptive.control", "at least one [[power]] is expected", "power")
    regular = math.isclose(system.times()[-1] - system.times()[-2], settings.step, rel_tol=1e-6)
    for name, model in system.models.items():
        if not model.can_vary_step and (settings.adaptive or not regular):
            text = f"model {name} takes steps of one length alone"
            key = "coupling.adaptive" if settings.adaptive else "coupling.stop_time"
            yield Mistake(key, text + ("" if settings.adaptive else "; a multiple of the step is expected"))
