"""Which variables a scene's FMU has, and everything that a description says of each.

Written once: the XML of both FMI versions and the accessors in the resource file are derived of it. A
variable's place in the list is its value reference.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum

from ..cable import PORT_OUTPUTS, Cable, Initial, SolverChoice, Terminal, Top, Whole
from ..scene_schema import MAX_LINKS
from .table import table

__all__ = [
    "ENUMERATIONS",
    "STATE_OUTPUTS",
    "Enumeration",
    "Item",
    "Kind",
    "Variable",
    "elements_of",
    "outputs_of",
    "variables_of",
]

STATE_OUTPUTS = ("y_m1", "v_m1", "x_m1", "vx_m1")
"""Outputs that are states themselves: floater 1's displacement and velocity."""


_SPRUNG = (Terminal.ANCHOR_SPRING, Terminal.FLOATER)

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
    WHOLE = 9
    LINKS = 10
    PRELOAD = 11


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
    """Slot in the kernel's list of that kind, or index into its state vector (with arrays: which of its parts)."""
    unit: str
    description: str
    causality: str
    variability: str
    initial: str | None = None
    start: float | None = None
    nominal: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    derivative_of: int | None = None
    """Value reference of the state that this is the time derivative of."""
    depends_on: tuple[int, ...] | None = None
    """Value references of the inputs and states that it depends on; None: on all of them."""
    on_all_at_start: bool = False
    """Whether at the start it depends on parameters as well, and so on everything that is known then."""
    enumeration: Enumeration | None = None
    """Its type, where it is no real number; it has no unit then, and `start` is a value of the enumeration."""
    dimension: int | None = None
    """Of an array: value reference of its number of elements."""


def variables_of(cable: Cable, dropped_outputs: Iterable[str] = (), whole: Whole | None = None) -> list[Variable]:
    """All variables of the scene's FMU, the value reference being the place in the list.

    Parameters
    ----------
    cable
        The scene's numbers.
    dropped_outputs
        Names of outputs to leave out. A state that is dropped as an output stays as a local variable.
    whole
        The cable before it is divided: links are arrays then, and their number n is a parameter (FMI 3).

    Notes
    -----
    Where a run starts from equilibrium, the start values of the states are the guess that the search begins with, and
    states, derivatives and outputs all depend on every parameter and input at the start. Arrays start from a shape, so
    they have no start values, and everything depends on that shape.
    """
    if whole:
        cable = whole.rest_of(cable)
    dropped = set(dropped_outputs)
    listing = _Listing()
    listing.add("time", Kind.TIME, 0, "s", "Time", causality="independent", variability="continuous")
    links = _add_links(listing, cable) if whole else None
    _add_parameters(listing, cable, whole.parameters if whole else {})
    _add_preloads(listing, whole.preloads if whole else ())
    _add_solver_choice(listing, cable)
    _add_inputs(listing, cable)
    begin = _Start(cable.initial is Initial.EQUILIBRIUM, links)
    states = _add_states(listing, cable, dropped, begin)
    _add_derivatives(listing, states, begin)
    _add_outputs(listing, cable, states, dropped, begin)
    _add_health(listing, cable, dropped)
    return listing.variables


@dataclass(frozen=True, slots=True)
class _Start:
    """How the states begin."""

    is_sought: bool
    """An equilibrium is, so the start values are a guess."""
    links: int | None
    """Value reference of the number of links, where that is a parameter."""

    @property
    def on_all(self) -> bool:
        """Whether the states depend at the start on what else is known then."""
        return self.is_sought or self.links is not None


class _Listing:
    """Hands out value references in order."""

    def __init__(self) -> None:
        self.variables: list[Variable] = []

    def add(self, name: str, kind: Kind, index: int, unit: str, description: str, **more: object) -> Variable:
        variable = Variable(len(self.variables), name, kind, index, unit, description, **more)  # type: ignore[arg-type]
        self.variables.append(variable)
        return variable


def _add_links(listing: _Listing, cable: Cable) -> int:
    return listing.add(
        "n", Kind.LINKS, 0, "", "Number of links that the cable is divided into", causality="structuralParameter",
        variability="fixed", initial="exact", start=cable.n, minimum=1, maximum=MAX_LINKS,
    ).reference  # fmt: skip


def _add_parameters(listing: _Listing, cable: Cable, whole: Mapping[str, float]) -> None:
    of_kind = ((Kind.PARAMETER, table().parameters, cable.parameters), (Kind.WHOLE, table().whole, whole))
    for kind, rows, values in of_kind:
        for name, row in rows.items():
            if name in values:
                listing.add(
                    name, kind, row.slot, row.unit, row.description, causality="parameter", variability="fixed",
                    initial="exact", start=values[name], minimum=None if row.least == "-inf" else 0.0,
                )  # fmt: skip


def _add_preloads(listing: _Listing, names: Iterable[str]) -> None:
    for name in names:
        row = table().parameters[name]
        what = row.description.partition("; fixed")[0]
        listing.add(
            name, Kind.PRELOAD, row.slot, row.unit, f"{what}; worked out for the rest shape at the start",
            causality="calculatedParameter", variability="fixed", initial="calculated",
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
            variability="continuous", start=cable.input_start.get(name, 0.0),
            nominal=1000.0 if row.unit == "N" else 1.0,
        )  # fmt: skip


def _add_states(listing: _Listing, cable: Cable, dropped: set[str], begin: _Start) -> list[Variable]:
    """q, then dq/dt, in the kernel's order: y_m1, theta[1..n], x_m1 as far as there are any; or the same in arrays."""
    sides = (("y_m1", "theta", "rad", "angle from the downward vertical", "x_m1"),
             ("v_m1", "omega", "rad/s", "angular rate", "vx_m1"))  # fmt: skip
    states = []
    for half, (heave, link, unit, what, surge) in enumerate(sides):
        starts = cable.padded((cable.position, cable.velocity)[half])
        for name, index in _places(cable, heave, link, surge, begin):
            row = table().outputs.get(name)
            text = row.description if row else f"{_link_named(name.removeprefix(link))}: {what}, positive towards +x"
            if row is None and begin.links is not None:
                how: dict[str, object] = {"initial": "calculated", "dimension": begin.links}
            else:
                start = 0.0 if begin.links is not None else float(starts[index])
                how = {"initial": "approx" if begin.is_sought else "exact", "start": start}
            states.append(listing.add(
                name, Kind.STATE, _ARRAYS[name] if begin.links is not None else half * len(starts) + index,
                row.unit if row else unit, f"{text}; {FRAME}",
                causality="output" if row and name not in dropped else "local", variability="continuous", nominal=1.0,
                depends_on=(len(listing.variables),), on_all_at_start=begin.on_all, **how,
            ))  # fmt: skip
    return states


_ARRAYS = {"y_m1": 0, "theta": 1, "v_m1": 2, "omega": 3, "x_m1": 4, "vx_m1": 5}
"""Array in resource.h."""


def _places(cable: Cable, heave: str, link: str, surge: str, begin: _Start) -> list[tuple[str, int]]:
    """Names of half the states, and where they stand in the kernel's half."""
    links = [(link, 1)] if begin.links is not None else [(f"{link}[{i}]", i) for i in range(1, cable.n + 1)]
    top = [(heave, 0)] if cable.top is not Top.MOTION else []
    return [*top, *links, *([(surge, cable.n + 1)] if cable.top is Top.FREE else [])]


def elements_of(variables: Iterable[Variable], n: int) -> list[Variable]:
    """The same, with every array's elements in its place: `index` counts them from 0, names are those of scalars."""
    elements: list[Variable] = []
    for variable in variables:
        if variable.dimension is None:
            elements.append(variable)
            continue
        array = variable.name.removeprefix("der(").removesuffix(")")
        for i in range(1, n + 1):
            name = variable.name.replace(array, f"{array}[{i}]")
            text = variable.description.replace(_link_named(""), f"Link {i}").replace(array, f"{array}[{i}]")
            elements.append(replace(variable, name=name, index=i - 1, description=text))
    return elements


def _link_named(index: str) -> str:
    return f"Link {index.strip('[]')}" if index else "Every link, 1 at the top"


def _add_derivatives(listing: _Listing, states: list[Variable], begin: _Start) -> None:
    half = len(states) // 2
    for k, state in enumerate(states):
        unit = {"m": "m/s", "rad": "rad/s", "m/s": "m/s2", "rad/s": "rad/s2"}[state.unit]
        # q' = v exactly; accelerations depend on everything.
        depends_on = (states[k + half].reference,) if k < half else None
        listing.add(
            f"der({state.name})", Kind.DERIVATIVE, state.index, unit, f"Time derivative of {state.name}; {FRAME}",
            causality="local", variability="continuous", initial="calculated", derivative_of=state.reference,
            depends_on=depends_on, on_all_at_start=begin.on_all, dimension=state.dimension,
        )  # fmt: skip


def _add_outputs(listing: _Listing, cable: Cable, states: list[Variable], dropped: set[str], begin: _Start) -> None:
    place_of = {variable.name: variable.reference for variable in listing.variables}
    half = len(states) // 2
    angles, rates = (
        tuple(s.reference for s in part if s.unit == unit)
        for part, unit in ((states[:half], "rad"), (states[half:], "rad/s"))
    )

    def of_top(*names: str) -> tuple[int, ...]:
        return tuple(place_of[name] for name in names if name in place_of)

    x, y, vx, vy = of_top("x_m1", "x_1"), of_top("y_m1", "y_1"), of_top("vx_m1", "vx_1"), of_top("v_m1", "vy_1")
    # Sideways a vessel takes the cable along, but not what springs hold its other end to.
    masses = {name for names in PORT_OUTPUTS.values() for name in names if name.startswith("m_")}
    stretched = x if cable.top is not Top.MOTION or cable.terminal in _SPRUNG else ()
    depends_on: dict[str, tuple[int, ...] | None] = {
        "x_c": x + angles,
        "y_c": y + angles,
        "vx_c": angles + vx + rates,
        "vy_c": angles + vy + rates,
        "energy": stretched + y + angles + vx + vy + rates,
        **dict.fromkeys(masses, angles),
    }
    for name in outputs_of(cable):
        if name in dropped or name in STATE_OUTPUTS:
            continue
        row = table().outputs[name]
        listing.add(
            name, Kind.OUTPUT, row.slot, row.unit, f"{row.description}; {FRAME}", causality="output",
            variability="continuous", initial="calculated", nominal=row.nominal, depends_on=depends_on.get(name),
            on_all_at_start=name in masses | {"energy"} or begin.on_all,
        )  # fmt: skip


def outputs_of(cable: Cable) -> list[str]:
    """Names of the outputs that the cable has, those that are states among them, in the order of the table."""
    return [name for name in table().outputs if name not in cable.absent_outputs]


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
