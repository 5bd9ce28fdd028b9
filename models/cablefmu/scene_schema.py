"""The scene format, as pydantic models: which tables and keys there are, and what each may hold.

The models check themselves as far as one file allows: `one_of` keys that exclude each other, lists of one
entry per link, signals, and what only goes together with other tables (`Spec`). What a mistake looks like to
the user is the business of `scene_mistakes`; what the numbers amount to, of `assembly`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, StrictBool, StrictInt, StrictStr, model_validator
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from cablefmu import units as u
from cablefmu.fmu.table import table
from cablefmu.scene_inputs import INPUTS, InputsTable
from cablefmu.scene_table import PerLink, Table, one_per_link

__all__ = ["OUTPUTS", "STATICS", "Spec", "inputs_of", "schema_text"]

MAX_LINKS = 10_000
MAX_OUTPUT_ROWS = 10_000_000

OUTPUTS = (*table().outputs, *table().solver)
"""What every scene has and may do without."""
STATICS = ("statics.residual", "statics.iterations")
"""The same of scenes that start from an equilibrium."""


def _format(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or value != 1:
        raise u.refusal("this version reads scenes with format = 1")
    return value


def _link_count(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MAX_LINKS:
        raise u.refusal(f"a whole number of links from 1 to {MAX_LINKS} is expected, for example 60")
    return value


def _one_line(value: object) -> object:
    if not isinstance(value, str) or not value.strip() or not value.isprintable():
        raise u.refusal("a text of one line is expected")
    return value


class CableTable(Table):
    """The cable: rigid links with elastic joints, link 1 at the top."""

    one_of = (("length", "link_length"), ("density", "link_mass"), ("young_modulus", "joint_stiffness"))

    links: Annotated[StrictInt, Field(ge=1, le=MAX_LINKS), BeforeValidator(_link_count)]
    """Number of rigid links."""
    length: u.Length | None = None
    """Length of the whole cable, shared out evenly."""
    link_length: PerLink[u.Length] | None = None
    """Length of each link."""
    diameter: PerLink[u.Length]
    """Outer diameter: for buoyancy, drag and bending stiffness."""
    density: PerLink[u.Density] | None = None
    """Density of the cable's material."""
    link_mass: PerLink[u.Mass] | None = None
    """Mass of each link."""
    young_modulus: PerLink[u.Modulus] | None = None
    """Modulus of elasticity E; a joint has k = (5/6) E I / l with I = pi r^4 / 4."""
    joint_stiffness: PerLink[u.JointStiffness] | None = None
    """Stiffness of the joint at the top of each link."""
    joint_damping: PerLink[u.JointDamping]
    """Damping of the joint at the top of each link."""


class WaterTable(Table):
    """The water around the cable; without this table the scene is in air."""

    one_of = (("Cd", "drag_per_link"),)

    density: u.Density = 1000.0
    """Density of the water."""
    Cd: PerLink[u.Coefficient] | None = None
    """Drag coefficient, in f = -1/2 rho Cd D l |v_n| v_n."""
    drag_per_link: PerLink[u.LinkDrag] | None = None
    """c_v in f = -c_v |v_n| v_n, as it stands, for each link."""


class FloaterTopTable(Table):
    """A floater at the upper end, at rest at the origin."""

    kind: Literal["floater"]
    mass: u.Mass
    stiffness: u.Stiffness
    """Of the spring about the rest position, vertical."""
    damping: u.Damping
    """Vertical."""
    static_load: u.Force | None = None
    """What its buoyancy carries at rest besides its own weight; by default the pull of the cable at rest."""
    stiffness_horizontal: u.Stiffness | None = None
    """Of the spring about the rest position, horizontal; with it and damping_horizontal the floater surges."""
    damping_horizontal: u.Damping | None = None
    static_pull: u.Force | None = None
    """What its mooring carries at rest, to the left; by default the horizontal pull of the cable at rest."""

    @property
    def surges(self) -> bool:
        """Whether it is free in x as well."""
        return self.stiffness_horizontal is not None

    @model_validator(mode="after")
    def _both_ways(self) -> FloaterTopTable:
        if (self.stiffness_horizontal is None) != (self.damping_horizontal is None):
            raise u.refusal("a floater that surges needs stiffness_horizontal and damping_horizontal, 0 allowed")
        if self.static_pull is not None and not self.surges:
            raise u.refusal("static_pull is only for a floater that surges, with stiffness_horizontal")
        return self


class MotionTopTable(Table):
    """A vessel that somebody else computes: its motion is an input, the cable's force on it an output."""

    kind: Literal["motion"]
    acceleration: StrictBool = True
    """Whether the accelerations are inputs as well. Without them the FMU is of Co-Simulation alone, and takes what the
    velocity did since the last step, or its slope."""


TopTable = FloaterTopTable | MotionTopTable
Position = tuple[u.Coordinate, u.Coordinate]


class LoadTable(Table):
    """A point mass that hangs on the cable."""

    kind: Literal["load"]
    mass: u.Mass
    rotary_inertia: u.RotaryInertia = 0.0
    """Rigidly added to the last link."""
    density: u.Density | None = None
    """Of the load's material, in water; its buoyancy follows."""
    volume: u.Volume | None = None
    """Displaced volume, in water."""


class AnchorMassTable(Table):
    """An anchor made of so much (neutrally buoyant) mass that it does not move."""

    kind: Literal["anchor-mass"]
    mass: u.Mass
    position: Position
    """Where it stands: x to the right, y downward from the top port."""


class AnchorSpringTable(Table):
    """An anchor that stiff springs hold."""

    kind: Literal["anchor-spring"]
    mass: u.Mass
    density: u.Density | None = None
    """Of the anchor's material, in water; its buoyancy follows."""
    volume: u.Volume | None = None
    """Displaced volume, in water."""
    stiffness_horizontal: u.Stiffness
    damping_horizontal: u.Damping
    stiffness_vertical: u.Stiffness
    damping_vertical: u.Damping
    position: Position
    """At rest: x to the right, y downward from the top port."""


class FloaterTable(Table):
    """A second floater, held by springs about its rest position."""

    kind: Literal["floater"]
    mass: u.Mass
    stiffness_horizontal: u.Stiffness
    damping_horizontal: u.Damping
    stiffness_vertical: u.Stiffness
    damping_vertical: u.Damping
    position: Position
    """At rest: x to the right, y downward from the top port."""
    horizontal_force: StrictBool = False
    """Whether there is an input F_cx."""


class PinTable(Table):
    """An anchor that cannot move."""

    kind: Literal["pin"]
    position: Position
    """Where it holds the cable's end: x to the right, y downward from the top port."""


class MotionEndTable(Table):
    """A vessel at the lower end that somebody else computes: its motion is an input, the cable's force an output."""

    kind: Literal["motion"]
    position: Position
    """Where it is at rest: x to the right, y downward from the top port."""
    acceleration: StrictBool = True
    """Whether the accelerations are inputs as well, as at the top."""


TerminalTable = LoadTable | AnchorMassTable | AnchorSpringTable | FloaterTable | PinTable | MotionEndTable


class StraightShape(Table):
    """All links at one angle from the downward vertical."""

    kind: Literal["straight"]
    angle: u.Angle


class AnglesShape(Table):
    """Each link at its own angle from the downward vertical."""

    kind: Literal["angles"]
    angles: Annotated[tuple[u.Angle, ...], AfterValidator(one_per_link)]


class HangingShape(Table):
    """Straight down."""

    kind: Literal["hanging"]


class CatenaryShape(Table):
    """The rest shape between the top port and the terminal's position."""

    kind: Literal["catenary"]


class OutputsTable(Table):
    """Which outputs the scene does without."""

    drop: tuple[Literal[(*OUTPUTS, *STATICS)], ...] = ()  # type: ignore[valid-type]
    """Names of outputs to leave out."""
    solver: StrictBool = True
    """Whether there are outputs solver.* that tell how well the built-in solver does."""

    @property
    def dropped(self) -> tuple[str, ...]:
        """Names of all outputs that are left out, each once."""
        return tuple(dict.fromkeys((*self.drop, *(() if self.solver else table().solver))))


class RunTable(Table):
    """How the scene is run unless the command line says otherwise."""

    stop_time: u.Duration
    step: u.Duration = 0.1
    """Communication step and output interval."""
    frame_interval: u.Duration | None = None
    """Between the shapes in a picture; by default a thirtieth of the stop time."""
    record: tuple[Literal["theta", "omega", "nodes", "tensions", "modes", "stiffness"], ...] = ()
    """What a run keeps beside the outputs: link angles and rates, places of the nodes, pulls in the links over time;
    natural frequencies with mode shapes, and the cable's end stiffness, about the equilibrium at the start."""
    tolerance: u.Tolerance = 1e-6
    """Relative tolerance of the solver."""
    solver: Literal["automatic", "explicit", "implicit"] = "automatic"
    """Method of the built-in solver (Co-Simulation); automatic: whichever is cheaper, decided during the run."""
    initial: Literal["shape", "equilibrium"] = "shape"
    """Start from the shape as it stands, or from the stable equilibrium that is found from there."""

    @model_validator(mode="after")
    def _reasonable(self) -> RunTable:
        if self.step > self.stop_time:
            raise u.refusal("step must not be longer than stop_time")
        if self.stop_time / self.step > MAX_OUTPUT_ROWS:
            raise u.refusal(f"stop_time / step must be at most {MAX_OUTPUT_ROWS}")
        return self


class Spec(Table):
    """A scene file of cablefmu."""

    format: Annotated[Literal[1], BeforeValidator(_format)]
    """Version of this format."""
    description: Annotated[StrictStr, BeforeValidator(_one_line)]
    """One line, for lists of scenes."""
    gravity: u.Acceleration = 9.81
    cable: CableTable
    water: WaterTable | None = None
    top: Annotated[TopTable, Field(discriminator="kind")]
    terminal: Annotated[TerminalTable, Field(discriminator="kind")]
    shape: Annotated[StraightShape | AnglesShape | HangingShape | CatenaryShape, Field(discriminator="kind")]
    inputs: InputsTable = InputsTable()
    outputs: OutputsTable = OutputsTable()
    run: RunTable

    @classmethod
    def contradictions(cls, data: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], str]]:
        """What only shows when tables are read together."""
        yield from _statics_without_equilibrium(data)
        terminal, top = data.get("terminal"), data.get("top")
        kind = terminal.get("kind") if isinstance(terminal, dict) else None
        if not isinstance(terminal, dict) or not isinstance(kind, str):
            return
        if kind in ("load", "anchor-spring"):
            given = [key for key in ("density", "volume") if key in terminal]
            if "water" in data and len(given) != 1:
                state = "density and volume contradict each other" if given else "density or volume is missing"
                yield ("terminal",), f"{state}: in water, exactly one of density, volume is needed"
            if "water" not in data:
                for key in given:
                    yield ("terminal", key), "only for scenes with [water], and this one has none"
        if not isinstance(top, dict) or top.get("kind") not in ("floater", "motion"):
            return
        surges = top.get("kind") == "floater" and "stiffness_horizontal" in top
        named = data.get("inputs")
        allowed = inputs_of(top["kind"], surges, kind, terminal.get("horizontal_force") is True)
        own = [name for name in allowed if name in INPUTS]
        for name in named if isinstance(named, dict) and allowed else ():
            if name in INPUTS and name not in allowed:
                ends = f'top "{top["kind"]}" and terminal "{kind}"'
                yield ("inputs", name), f"a scene with {ends} has the inputs {', '.join(own)}"
        shape = data.get("shape")
        if kind == "load" and isinstance(shape, dict) and shape.get("kind") == "catenary":
            yield (
                ("shape", "kind"),
                'a catenary needs a terminal with a position; for a load: "hanging", "straight"',
            )


def _statics_without_equilibrium(data: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Outputs that only an equilibrium has can only be dropped there."""
    outputs, run = data.get("outputs"), data.get("run")
    dropped = outputs.get("drop") if isinstance(outputs, dict) else None
    named = [name for name in STATICS if name in dropped] if isinstance(dropped, list) else []
    if named and not (isinstance(run, dict) and run.get("initial") == "equilibrium"):
        yield ("outputs", "drop"), f'{named[0]} exists only in scenes with [run] initial = "equilibrium"'


def _motion(end: int, acceleration: bool) -> tuple[str, ...]:
    kinds = ("", "v", "a") if acceleration else ("", "v")
    return tuple(f"{kind}{axis}_{end}" for kind in kinds for axis in "xy")


def inputs_of(
    top: str, surges: bool, terminal: str, horizontal_force: bool, accelerations: tuple[bool, bool] = (True, True)
) -> tuple[str, ...]:
    """Names of the inputs of a scene by the kinds of its ends, in their fixed order; none for an unknown kind."""
    at_end = {
        "load": ("F_cx", "F_cy"),
        "anchor-mass": (),
        "anchor-spring": (),
        "pin": (),
        "floater": ("u_m2", "F_cx") if horizontal_force else ("u_m2",),
        "motion": _motion(2, accelerations[1]),
    }.get(terminal)
    if at_end is None:
        return ()
    at_top = _motion(1, accelerations[0]) if top == "motion" else ("u_m1", "u_m1x") if surges else ("u_m1",)
    return tuple(name for name in table().inputs if name in (*at_top, *at_end))


class _SchemaGenerator(GenerateJsonSchema):
    """TOML has no null: an optional key is there or not."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        if schema.get("default", ...) is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)


def schema_text() -> str:
    """JSON Schema of the scene format for editors, as it is kept in scene.schema.json."""
    schema = Spec.model_json_schema(schema_generator=_SchemaGenerator)
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["title"] = "cablefmu scene"
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
