"""What a sweep file may hold: one pydantic model a table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, StrictStr

from ..scene_table import Table
from ..units import Duration, Tolerance, refusal

__all__ = ["MOST_CASES", "FileSpec", "ListSpec", "RunSpec", "SampleSpec", "StatisticsSpec"]

MOST_CASES = 1_000_000


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise refusal("a finite number in SI units is expected")
    return float(value)


def _value(value: object) -> object:
    """A number, or the name of an enumeration's item."""
    return value if isinstance(value, str) else _number(value)


def _values(value: object) -> object:
    if not isinstance(value, list | tuple) or not value:
        raise refusal("a list with at least one value is expected")
    return tuple(value)


def _whole(least: int, most: int) -> BeforeValidator:
    def check(value: object) -> object:
        if type(value) is not int or not least <= value <= most:
            raise refusal(f"a whole number from {least:,} to {most:,} is expected")
        return value

    return BeforeValidator(check)


def _range(value: object) -> object:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refusal("two numbers are expected, the smallest value and the largest")
    low, high = map(_number, value)
    if not low < high:
        raise refusal("the second number must be larger than the first")
    return (low, high)


def _slope(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 1.0 <= value <= 20.0:
        raise refusal("the slope of an S-N curve is expected, a number from 1 to 20")
    return float(value)


Value = Annotated[float | str, BeforeValidator(_value)]
Names = Annotated[tuple[StrictStr, ...], BeforeValidator(_values)]


class RunSpec(Table):
    """[run]: how every case is run; what is left out is the scene's own."""

    stop_time: Duration | None = None
    step: Duration | None = None
    tolerance: Tolerance | None = None
    interface: Literal["cs", "me"] | None = None
    fmi: Annotated[Literal[2, 3] | None, BeforeValidator(lambda value: _version(value))] = None


def _version(value: object) -> object:
    if value not in (None, 2, 3):
        raise refusal("2 or 3 is expected")
    return value


class ListSpec(Table):
    """[list]: cases one by one, in a CSV file whose first line names what is set; an empty field sets nothing."""

    file: StrictStr


class SampleSpec(Table):
    """[sample]: so many points in a box, spread evenly in every direction."""

    method: Literal["latin-hypercube"] = "latin-hypercube"
    count: Annotated[int, _whole(1, MOST_CASES)]
    """How many points are expected, a whole number"""
    seed: Annotated[int, _whole(0, 2**32 - 1)] = 0
    ranges: Annotated[dict[str, Annotated[tuple[float, float], BeforeValidator(_range)]], Field(min_length=1)]
    """Smallest and largest value by name"""


class StatisticsSpec(Table):
    """[statistics]: what is kept of a case."""

    outputs: Names | None = None
    """All but those that tell how the solver fares."""
    fatigue: tuple[StrictStr, ...] | None = None
    """Outputs whose cycles are counted; the tensions at top and end, and the largest."""
    slope: Annotated[float, BeforeValidator(_slope)] = 3.0
    """Of the S-N curve"""


class FileSpec(Table):
    """A whole file."""

    one_of = (("scenes", "coupling"),)

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")] | None = None
    description: StrictStr = ""
    scenes: Names | None = None
    """Names of shipped scenes, paths of scene files or of FMUs."""
    coupling: StrictStr | None = None
    """A shipped coupling's name or a coupling file's path."""
    run: RunSpec = RunSpec()
    set: dict[str, Value] = Field(default_factory=dict)
    """The same in every case"""
    list: ListSpec | None = None
    grid: dict[str, Annotated[tuple[Value, ...], BeforeValidator(_values)]] = Field(default_factory=dict)
    sample: SampleSpec | None = None
    statistics: StatisticsSpec = StatisticsSpec()

    @classmethod
    def contradictions(cls, data: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], str]]:
        yield from super().contradictions(data)
        if "coupling" in data and "run" in data:
            yield ("run",), "a coupling is run as its own file says; leave this table out"
