"""The [inputs] table of a scene file: one force signal per input."""

from __future__ import annotations

from collections.abc import Callable
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
from cablefmu.signals import Constant, CsvError, Sampled, Signal, Sine, Steps, read_csv

__all__ = ["INPUTS", "Input", "InputsTable", "build_signal"]

INPUTS = tuple(table().inputs)
"""All inputs that a scene may have, in their fixed order."""


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
        frequency = self.frequency if self.frequency is not None else 1.0 / (self.period or 1.0)
        return Sine(self.amplitude, frequency, self.phase, self.offset, self.start)


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


SignalTable = Annotated[ConstantInput | SineInput | StepsInput | CsvInput, Field(discriminator="signal")]
Input = Annotated[
    Annotated[u.InputForce, Tag("<number>")] | Annotated[SignalTable, Tag("<table>")],
    Discriminator(lambda value: "<table>" if isinstance(value, dict | Table) else "<number>"),
]


class InputsTable(Table):
    """Forces over time; an input that is not named is 0."""

    u_m1: Input | None = None
    """Vertical force on floater 1, downward."""
    u_m2: Input | None = None
    """Vertical force on the second floater, downward."""
    F_cx: Input | None = None
    """Horizontal force on the terminal, to the right."""
    F_cy: Input | None = None
    """Vertical force on the load, downward."""


def build_signal(
    given: float | ConstantInput | SineInput | StepsInput | CsvInput, read: Callable[[str], bytes]
) -> Signal:
    """Make the signal that a validated [inputs] entry describes; `read` gives the content of its file."""
    return Constant(given) if isinstance(given, float) else given.build(read)
