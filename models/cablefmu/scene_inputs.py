"""The [inputs] table of a scene file: one signal per force, or per coordinate of a motion that is given.

Of a motion the file gives the place alone; velocity and acceleration are its derivatives, so that the three agree.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    StrictInt,
    StrictStr,
    Tag,
    ValidationInfo,
    model_validator,
)

from cablefmu import units as u
from cablefmu.fmu.table import table
from cablefmu.scene_table import Table, context_of
from cablefmu.signals import Constant, CsvError, Derivative, Sampled, Signal, Sine, Spline, Steps, read_csv

__all__ = ["FOLLOWING", "INPUTS", "Input", "InputsTable", "build_signal", "with_derivatives"]

FOLLOWING = {
    f"{prefix}{axis}_{end}": (f"{axis}_{end}", order)
    for end in (1, 2)
    for order, prefix in ((1, "v"), (2, "a"))
    for axis in "xy"
}
"""Inputs that are derivatives of another one: which, and of which order."""
INPUTS = tuple(name for name in table().inputs if name not in FOLLOWING)
"""All inputs that a scene file may name, in their fixed order."""


class ConstantInput(Table):
    """The same force at all times."""

    signal: Literal["constant"]
    value: u.Force

    def build(self, read: Callable[[str], bytes]) -> Signal:
        return Constant(self.value)


class SineInput(Table):
    """offset + amplitude sin(2 pi frequency (t - start) + phase); before start only the offset."""

    one_of = (("frequency", "period"),)

    signal: Literal["sine"]
    amplitude: u.Force
    frequency: u.Frequency | None = None
    period: u.Duration | None = None
    phase: u.AngleOffset = 0.0
    offset: u.Force = 0.0
    start: u.Time | None = None
    """Without it, the sine has always been there."""

    def build(self, read: Callable[[str], bytes]) -> Signal:
        return Sine(self.amplitude, u.hertz(self.frequency, self.period), self.phase, self.offset, self.start)


class StepsInput(Table):
    """Piecewise constant: 0 before the first time, then each value from its time on."""

    signal: Literal["steps"]
    times: Annotated[tuple[u.Time, ...], Field(min_length=1)]
    values: Annotated[tuple[u.Force, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _in_order(self) -> StepsInput:
        if len(self.times) != len(self.values):
            raise u.refusal(f"{len(self.times)} times and {len(self.values)} values; as many of each are needed")
        if any(later <= earlier for earlier, later in zip(self.times, self.times[1:], strict=False)):
            raise u.refusal("times must rise from each entry to the next")
        return self

    def build(self, read: Callable[[str], bytes]) -> Signal:
        return Steps(self.times, self.values)


def _inside_folder(name: str) -> str:
    """A scene and its files travel together, so a file lies in the scene's folder or below it."""
    parts = name.split("/")
    if not name.isprintable() or "\\" in name or ":" in name or any(part in ("", ".", "..") for part in parts):
        raise u.refusal('the path of a file in the folder of the scene is expected, for example "waves/heave.csv"')
    return name


Column = Annotated[
    Annotated[StrictInt, Field(ge=1), Tag("<number>")] | Annotated[StrictStr, Tag("<one>")],
    Discriminator(lambda value: "<one>" if isinstance(value, str) else "<number>"),
]


class CsvInput(Table):
    """Samples from a file, linear in between, held before the first and after the last one."""

    signal: Literal["csv"]
    file: Annotated[StrictStr, AfterValidator(_inside_folder)]
    """Comma-separated, UTF-8, in s and N; path from the scene's folder."""
    time: Column = 1
    """Column of the times, by number from 1 or by its name in the first line."""
    value: Column = 2
    """Column of the forces."""

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo) -> CsvInput:
        context = context_of(info)
        if context is not None:
            try:
                self.build(context.read)
            except CsvError as mistake:
                raise u.refusal(f"{self.file}: {mistake}") from None
        return self

    def build(self, read: Callable[[str], bytes]) -> Sampled:
        return read_csv(read(self.file), time=self.time, value=self.value)


class SineMotion(Table):
    """offset + amplitude sin(2 pi frequency t + phase), at all times."""

    one_of = (("frequency", "period"),)

    signal: Literal["sine"]
    amplitude: u.Coordinate
    frequency: u.Frequency | None = None
    period: u.Duration | None = None
    phase: u.AngleOffset = 0.0
    offset: u.Coordinate = 0.0

    def build(self, read: Callable[[str], bytes]) -> Signal:
        return Sine(self.amplitude, u.hertz(self.frequency, self.period), self.phase, self.offset)


class CsvMotion(CsvInput):
    """Samples from a file, on a cubic spline: at rest before the first and after the last one."""

    file: Annotated[StrictStr, AfterValidator(_inside_folder)]
    """Comma-separated, UTF-8, in s and m; path from the scene's folder."""

    def build(self, read: Callable[[str], bytes]) -> Spline:  # type: ignore[override]
        samples = super().build(read)
        if len(samples.times) < 2:
            raise CsvError("a motion needs two lines with numbers or more")
        return Spline(samples.times, samples.values)


MotionTable = Annotated[SineMotion | CsvMotion, Field(discriminator="signal")]
Motion = Annotated[
    Annotated[u.InputPlace, Tag("<number>")] | Annotated[MotionTable, Tag("<table>")],
    Discriminator(lambda value: "<table>" if isinstance(value, dict | Table) else "<number>"),
]

SignalTable = Annotated[ConstantInput | SineInput | StepsInput | CsvInput, Field(discriminator="signal")]
Input = Annotated[
    Annotated[u.InputForce, Tag("<number>")] | Annotated[SignalTable, Tag("<table>")],
    Discriminator(lambda value: "<table>" if isinstance(value, dict | Table) else "<number>"),
]


class InputsTable(Table):
    """Forces and motions over time; a force that is not named is 0, a motion stays where it is at rest."""

    u_m1: Input | None = None
    """Vertical force on floater 1, downward."""
    u_m2: Input | None = None
    """Vertical force on the second floater, downward."""
    F_cx: Input | None = None
    """Horizontal force on the terminal, to the right."""
    F_cy: Input | None = None
    """Vertical force on the load, downward."""
    u_m1x: Input | None = None
    """Horizontal force on floater 1, to the right, where it surges."""
    x_1: Motion | None = None
    """Where the vessel at the top is, to the right of its rest."""
    y_1: Motion | None = None
    """The same, downward."""
    x_2: Motion | None = None
    """Where the vessel at the lower end is, to the right of the top joint's rest."""
    y_2: Motion | None = None
    """The same, downward."""


def build_signal(
    given: float | ConstantInput | SineInput | StepsInput | CsvInput | SineMotion | CsvMotion,
    read: Callable[[str], bytes],
) -> Signal:
    """Make the signal that a validated [inputs] entry describes; `read` gives the content of its file."""
    return Constant(given) if isinstance(given, float) else given.build(read)


def with_derivatives(signals: Mapping[str, Signal]) -> dict[str, Signal]:
    """The same, with velocity and acceleration of every coordinate among them."""
    following = {name: Derivative(signals[of], order) for name, (of, order) in FOLLOWING.items() if of in signals}
    return {**signals, **following}
