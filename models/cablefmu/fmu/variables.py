"""Which variables a scene's FMU has, and everything that a description says of each.

Written once: the XML of both FMI versions and the accessors in the resource file are derived of it. A
variable's place in the list is its value reference.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

from ..cable import Cable, Initial, SolverChoice
from .table import table

__all__ = ["ENUMERATIONS", "STATE_OUTPUTS", "Enumeration", "Item", "Kind", "Variable", "variables_of"]

STATE_OUTPUTS = ("y_m1", "v_m1")
"""Outputs that are states themselves: floater 1's displacement and velocity."""


FRAME = "x right, y down"
"""Every variable with a direction says so."""

COSIMULATION_ONLY = "Co-Simulation only: stays 0 in Model Exchange"


class Kind(IntEnum):
    """What a value reference points at; the numbers are those of resource.h."""

    TIME = 0
    PARAMETER = 1
    INPUT = 2
    STATE = 3
    DERIVATIVE = 4
    OUTPUT = 5
    SOLVER = 6
    SOLVER_CHOICE = 7
    STATICS = 8


@dataclass(frozen=True, slots=True)
class Item:
    """One value of an enumeration."""

    name: str
    value: int
    description: str


@dataclass(frozen=True, slots=True)
class Enumeration:
    """A type that is no number."""

    name: str
    description: str
    items: tuple[Item, ...]

    def value_of(self, name: str) -> int:
        """The value that stands for an item."""
        return next(item.value for item in self.items if item.name == name)


_SOLVER_CHOICES = Enumeration(
    "SolverChoice",
    "Integrator of the FMU in Co-Simulation",
    (
        Item(SolverChoice.AUTOMATIC, 1, "Whichever is cheaper, decided during the run from stiffness and cost"),
        Item(SolverChoice.EXPLICIT, 2, "Dormand-Prince 5(4): for motion that is itself fast"),
        Item(SolverChoice.IMPLICIT, 3, "Linearly implicit and L-stable: for stiff cables, joints and end springs"),
    ),
)

ENUMERATIONS = {"solver": _SOLVER_CHOICES}
"""Parameters that are no numbers, by name."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of the FMU."""

    reference: int
    name: str
    kind: Kind
    index: int
    """Slot in the kernel's list of that kind, or index into the state vector."""
    unit: str
    description: str
    causality: str
    variability: str
    initial: str | None = None
    start: float | None = None
    nominal: float | None = None
    minimum: float | None = None
    derivative_of: int | None = None
    """Value reference of the state that this is the time derivative of."""
    depends_on: tuple[int, ...] | None = None
    """Value references of the inputs and states that it depends on; None: on all of them."""
    on_all_at_start: bool = False
    """Whether at the start it depends on parameters as well, and so on everything that is known then."""
    enumeration: Enumeration | None = None
    """Its type, where it is no real number; it has no unit then, and `start` is a value of the enumeration."""


def variables_of(cable: Cable, dropped_outputs: Iterable[str] = ()) -> list[Variable]:
    """All variables of the scene's FMU, the value reference being the place in the list.

    Parameters
    ----------
    cable
        The scene's numbers.
    dropped_outputs
        Names of outputs to leave out. A state that is dropped as an output stays as a local variable.

    Notes
    -----
    Where a run starts from equilibrium, the start values of the states are the guess that the search begins with, and
    states, derivatives and outputs all depend on every parameter and input at the start.
    """
    dropped = set(dropped_outputs)
    listing = _Listing()
    listing.add("time", Kind.TIME, 0, "s", "Time", causality="independent", variability="continuous")
    _add_parameters(listing, cable)
    _add_solver_choice(listing, cable)
    _add_inputs(listing, cable)
    states = _add_states(listing, cable, dropped)
    _add_derivatives(listing, cable, states)
    _add_outputs(listing, cable, states, dropped)
    _add_health(listing, cable, dropped)
    return listing.variables


class _Listing:
    """Hands out value references in order."""

    def __init__(self) -> None:
        self.variables: list[Variable] = []

    def add(self, name: str, kind: Kind, index: int, unit: str, description: str, **more: object) -> Variable:
        variable = Variable(len(self.variables), name, kind, index, unit, description, **more)  # type: ignore[arg-type]
        self.variables.append(variable)
        return variable


def _add_parameters(listing: _Listing, cable: Cable) -> None:
    for name, row in table().parameters.items():
        if name in cable.parameters:
            listing.add(
                name, Kind.PARAMETER, row.slot, row.unit, row.description, causality="parameter", variability="fixed",
                initial="exact", start=cable.parameters[name], minimum=None if row.least == "-inf" else 0.0,
            )  # fmt: skip


def _add_solver_choice(listing: _Listing, cable: Cable) -> None:
    choices = ENUMERATIONS["solver"]
    listing.add(
        "solver", Kind.SOLVER_CHOICE, 0, "", f"{choices.description}; Model Exchange does not use it",
        causality="parameter", variability="fixed", initial="exact", start=choices.value_of(cable.solver),
        enumeration=choices,
    )  # fmt: skip


def _add_inputs(listing: _Listing, cable: Cable) -> None:
    for name in cable.inputs:
        row = table().inputs[name]
        listing.add(
            name, Kind.INPUT, row.slot, row.unit, f"{row.description}; {FRAME}", causality="input",
            variability="continuous", start=cable.input_start.get(name, 0.0), nominal=1000.0,
        )  # fmt: skip


def _add_states(listing: _Listing, cable: Cable, dropped: set[str]) -> list[Variable]:
    """The state vector in order: y_m1, theta[1..n], v_m1, omega[1..n]."""
    rows = table().outputs
    described = [("y_m1", rows["y_m1"].unit, f"{rows['y_m1'].description}; {FRAME}")]
    described += [
        (f"theta[{i}]", "rad", f"Link {i}: angle from the downward vertical, positive towards +x; {FRAME}")
        for i in range(1, cable.n + 1)
    ]
    described += [("v_m1", rows["v_m1"].unit, f"{rows['v_m1'].description}; {FRAME}")]
    described += [
        (f"omega[{i}]", "rad/s", f"Link {i}: angular rate, positive towards +x; {FRAME}") for i in range(1, cable.n + 1)
    ]
    starts = [*cable.position, *cable.velocity]
    sought = cable.initial is Initial.EQUILIBRIUM
    states = []
    for k, (name, unit, description) in enumerate(described):
        causality = "output" if name in STATE_OUTPUTS and name not in dropped else "local"
        states.append(listing.add(
            name, Kind.STATE, k, unit, description, causality=causality, variability="continuous",
            initial="approx" if sought else "exact", start=float(starts[k]), nominal=1.0,
            depends_on=(len(listing.variables),), on_all_at_start=sought,
        ))  # fmt: skip
    return states


def _add_derivatives(listing: _Listing, cable: Cable, states: list[Variable]) -> None:
    half = cable.n + 1
    for k, state in enumerate(states):
        unit = {"m": "m/s", "rad": "rad/s", "m/s": "m/s2", "rad/s": "rad/s2"}[state.unit]
        # q' = v exactly; accelerations depend on everything.
        depends_on = (states[k + half].reference,) if k < half else None
        listing.add(
            f"der({state.name})", Kind.DERIVATIVE, k, unit, f"Time derivative of {state.name}; {FRAME}",
            causality="local", variability="continuous", initial="calculated", derivative_of=state.reference,
            depends_on=depends_on, on_all_at_start=cable.initial is Initial.EQUILIBRIUM,
        )  # fmt: skip


def _add_outputs(listing: _Listing, cable: Cable, states: list[Variable], dropped: set[str]) -> None:
    half = cable.n + 1
    heave, angles = states[0].reference, tuple(s.reference for s in states[1:half])
    heave_rate, rates = states[half].reference, tuple(s.reference for s in states[half + 1 :])
    depends_on: dict[str, tuple[int, ...] | None] = {
        "x_c": angles,
        "y_c": (heave, *angles),
        "vx_c": angles + rates,
        "vy_c": (*angles, heave_rate, *rates),
        "energy": tuple(s.reference for s in states),
    }
    for name, row in table().outputs.items():
        if name in dropped or name in STATE_OUTPUTS:
            continue
        listing.add(
            name, Kind.OUTPUT, row.slot, row.unit, f"{row.description}; {FRAME}", causality="output",
            variability="continuous", initial="calculated", nominal=row.nominal, depends_on=depends_on.get(name),
            on_all_at_start=name == "energy" or cable.initial is Initial.EQUILIBRIUM,
        )  # fmt: skip


def _add_health(listing: _Listing, cable: Cable, dropped: set[str]) -> None:
    """Of the solver, and of the equilibrium where one is sought: at initialisation, after which it stays."""
    for name, row in table().solver.items():
        if name not in dropped:
            listing.add(
                name, Kind.SOLVER, row.slot, row.unit, f"{row.description}; {COSIMULATION_ONLY}", causality="output",
                variability="continuous", initial="calculated", depends_on=(),
            )  # fmt: skip
    for name, row in table().statics.items():
        if name not in dropped and cable.initial is Initial.EQUILIBRIUM:
            listing.add(
                name, Kind.STATICS, row.slot, row.unit, row.description, causality="output", variability="discrete",
                initial="calculated", depends_on=(), on_all_at_start=True,
            )  # fmt: skip
