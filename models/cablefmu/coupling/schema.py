"""What a coupling file may hold: one pydantic model a table, units as in scene files."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field

from ..scene_table import Table
from ..units import Duration, Measure, Tolerance

__all__ = ["AdaptiveSpec", "ConnectionSpec", "CouplingSpec", "FileSpec", "IterationSpec", "ModelSpec", "PowerSpec"]

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*$")]
Variable = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*\.\S(.*\S)?$")]
Port = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*(\.\S(.*\S)?)?$")]
Number = Annotated[float, Measure("a number", "", "1.0")]
Value = bool | int | float | str
"""Of a parameter: a number, true or false, a text, or the name of an enumeration's item"""

ALGORITHMS = ("jacobi", "gauss-seidel", "iterated")


class IterationSpec(Table):
    """How an iterated step, and the start of every coupling, finds values that agree."""

    tolerance: Tolerance = 1e-6
    """Of a connection's value, relative to the largest that it had so far (at least its nominal)."""
    most: Annotated[int, Field(ge=1, le=1000)] = 30
    """Iterations in one step; more are an error."""
    acceleration: Literal["quasi-newton", "none"] = "quasi-newton"


class AdaptiveSpec(Table):
    """Steps of varying length."""

    tolerance: Tolerance
    """Of what `control` looks at, relative to its largest value so far."""
    smallest: Duration
    largest: Duration
    control: Literal["signals", "power"] = "signals"
    """How far inputs were extrapolated wrongly, or the power residuals of [[power]]."""


class CouplingSpec(Table):
    """[coupling]"""

    name: Name | None = None
    description: str = ""
    stop_time: Duration
    step: Duration
    report_time: Duration | None = None
    """Stop time of a report's runs, of which there are many; `stop_time` by default."""
    algorithm: Literal["jacobi", "gauss-seidel", "iterated"] = "jacobi"
    extrapolation: Annotated[int, Field(ge=0, le=2)] = 0
    """Order of the polynomial that inputs follow inside a step."""
    tolerance: Tolerance = 1e-8
    """Relative tolerance that every model's own solver is given."""
    iteration: IterationSpec = IterationSpec()
    adaptive: AdaptiveSpec | None = None


class ModelSpec(Table):
    """[[model]]"""

    name: Name
    scene: str | None = None
    """A scene's name or TOML file: its FMU is built."""
    fmu: str | None = None
    """The path of an FMU."""
    partner: str | None = None
    """A partner FMU that ships with this package."""
    vessel: dict[str, Any] | None = None
    """A vessel's table: its FMU is built."""
    waves: dict[str, Any] | None = None
    """A sea's table: its FMU is built."""
    fmi: Literal[2, 3] | None = None
    """Version of FMI that a scene is built for."""
    parameters: Annotated[dict[str, Value], Field(default_factory=dict)]
    inputs: Annotated[dict[str, Number], Field(default_factory=dict)]
    """Constant values of inputs that nothing is connected to."""
    feedthrough: bool = True
    """false: where its description leaves open what an output depends on, it is the state alone."""

    one_of = (("scene", "fmu", "partner", "vessel", "waves"),)


class ConnectionSpec(Table):
    """[[connection]]: one output to one input, or two ports by the names of their members."""

    from_: Annotated[Variable | None, Field(alias="from")] = None
    to: Variable | None = None
    ports: tuple[Port, Port] | None = None
    gain: Number = 1.0
    offset: Number = 0.0
    """Added to what is connected, in the input's unit: of where a vessel is from its rest to where it is."""
    delayed: bool = False
    """The input may be late by one step: what breaks an algebraic loop where nothing iterates."""

    @classmethod
    def contradictions(cls, data: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], str]]:
        if "ports" in data:
            for key in ("from", "to", "gain", "offset"):
                if key in data:
                    yield (key,), "ports say what is connected with what; leave it out, or ports"
        elif not {"from", "to"} <= data.keys():
            yield (), 'from and to are expected, or ports, for example from = "vessel.vx", to = "cable.vx_1"'


class PowerSpec(Table):
    """[[power]]: an output that flows one way and an effort that comes back the other, whose product is a power."""

    name: Name
    flow: Variable
    effort: Variable


class FileSpec(Table):
    """A whole file."""

    coupling: CouplingSpec
    model: Annotated[tuple[ModelSpec, ...], Field(min_length=1)]
    connection: tuple[ConnectionSpec, ...] = ()
    power: tuple[PowerSpec, ...] = ()
