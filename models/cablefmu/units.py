"""A value of a scene file: a number in SI, or a text with its unit such as "45 deg" or "240 m".

A `Measure` says what one key expects (which quantity, in which unit, between which limits). As pydantic
metadata, ``Annotated[float, Measure(...)]``, it turns what the file has into a float in SI or refuses it
with a sentence for a person, and it describes itself in the JSON Schema.

Units are compared with their angles: pint counts a radian as nothing, but "2 rad/s" is not a frequency
of 2 Hz and "3 percent" is not an angle, so the root units must agree to the last one.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

import pint
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

__all__ = [
    "LARGEST",
    "SMALLEST",
    "Acceleration",
    "Angle",
    "AngleOffset",
    "Coefficient",
    "Coordinate",
    "Damping",
    "Density",
    "Duration",
    "Force",
    "Frequency",
    "InputForce",
    "InputPlace",
    "JointDamping",
    "JointStiffness",
    "Length",
    "LinkDrag",
    "Mass",
    "Measure",
    "Modulus",
    "RotaryInertia",
    "Stiffness",
    "Time",
    "Tolerance",
    "Volume",
    "hertz",
]  # fmt: skip

LARGEST = 1e15
"""No quantity of a scene may exceed this in SI, so that no product of a few of them overflows."""
SMALLEST = 1e-12
"""Quantities that must be greater than 0 must be at least this, for the same reason."""

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# A bounded grammar for units (names with one-digit powers), because pint would evaluate "9**9**9**9".
_FACTOR = r"(?:[^\W\d_]|[°%_])+(?:(?:\^|\*\*)?[-+]?\d)?"
_UNIT = rf"(?:1\s*/\s*)?{_FACTOR}(?:\s*[*/·]\s*{_FACTOR}|\s+{_FACTOR})*"
_TEXT = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>{_UNIT})?\s*")
_LONGEST_TEXT = 100


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    """Make the unit table once, when the first text with a unit comes by."""
    return pint.UnitRegistry()


@lru_cache(maxsize=512)
def _root_units(unit: str) -> Any:
    """Root units of a unit text, radians included, for example kg m^2/(s^2 rad) for "N m/rad"."""
    registry = _registry()
    return registry.Quantity(1.0, registry.parse_units(unit)).to_root_units().units


@lru_cache(maxsize=512)
def _factor(unit: str, target: str) -> float | None:
    """How many `target` one `unit` is; None if they measure different things or `unit` is unknown."""
    try:
        if _root_units(unit) != _root_units(target):
            return None
        registry = _registry()
        return float(registry.Quantity(1.0, registry.parse_units(unit)).m_as(target))
    except (pint.PintError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        return None


@dataclass(frozen=True, slots=True)
class Measure:
    """What one key of a scene file expects.

    Parameters
    ----------
    noun
        The quantity with its article, "a length".
    unit
        SI unit in which a bare number is taken; "" for pure numbers, which take no text.
    example
        Two ways to write it, for messages.
    lower, upper
        Limits in SI, both allowed.
    positive
        Whether the value must be greater than 0 (and so at least `SMALLEST`).
    also
        What else the key allows, for messages.
    """

    noun: str
    unit: str
    example: str
    lower: float = -LARGEST
    upper: float = LARGEST
    positive: bool = False
    also: str = ""

    @property
    def expected(self) -> str:
        """The sentence that every refusal ends with."""
        unit = f" [{self.unit}]" if self.unit else ""
        return f"{self.noun}{unit} is expected, for example {self.example}{self.also}"

    @property
    def limits(self) -> str:
        """The allowed range in words."""
        unit = f" {self.unit}" if self.unit else ""
        if self.positive:
            return f"greater than 0 (from {SMALLEST:g} to {self.upper:g}{unit})"
        if self.lower == 0.0:
            return f"0 or greater (up to {self.upper:g}{unit})"
        return f"from {self.lower:g} to {self.upper:g}{unit}"

    def read(self, value: object) -> float:
        """Turn what the file has into SI.

        Raises
        ------
        PydanticCustomError
            For a wrong type (a boolean is no number), a text without or with a wrong unit, infinity, NaN
            and values outside the limits.
        """
        if isinstance(value, str):
            number = self._from_text(value)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            number = _as_float(value)
        else:
            raise refusal(self.expected)
        if not math.isfinite(number):
            raise refusal(f"this is not a finite number; {self.expected}")
        lower = SMALLEST if self.positive else self.lower
        if not lower <= number <= self.upper:
            raise refusal(f"{self.noun} must be {self.limits}, for example {self.example}")
        return number

    def _from_text(self, text: str) -> float:
        match = _TEXT.fullmatch(text) if len(text) <= _LONGEST_TEXT else None
        if match is None or not self.unit:
            raise refusal(self.expected)
        unit = match["unit"]
        if unit is None:
            raise refusal(f"the unit is missing; {self.expected}")
        factor = _factor(unit.replace("·", "*"), self.unit)
        if factor is None:
            raise refusal(self.expected)
        return float(match["number"]) * factor

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        lower = SMALLEST if self.positive else self.lower
        number: JsonSchemaValue = {"type": "number", "minimum": lower, "maximum": self.upper}
        if not self.unit:
            return number
        text = {
            "type": "string",
            "pattern": rf"^\s*{_NUMBER}\s*(?:1\s*/\s*)?[A-Za-zµ°%].*$",
            "examples": [self.example],
        }
        return {"anyOf": [number, text], "description": f"{self.noun} [{self.unit}], e.g. {self.example}"}


def refusal(text: str) -> PydanticCustomError:
    """An error of ours, `text` being the whole message."""
    return PydanticCustomError("refused", "{text}", {"text": text})


def _as_float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:  # TOML integers have no upper limit
        return math.inf


def hertz(frequency: float | None, period: float | None) -> float:
    """Frequency [Hz], whichever way a table gives it: `one_of` sees to it that there is one of them."""
    return frequency if frequency is not None else 1.0 / (period or 1.0)


def _above_zero(noun: str, unit: str, example: str) -> Measure:
    return Measure(noun, unit, example, 0.0, positive=True)


def _not_negative(noun: str, unit: str, example: str) -> Measure:
    return Measure(noun, unit, example, 0.0)


Length = Annotated[float, _above_zero("a length", "m", '240 or "240 m"')]
Coordinate = Annotated[float, Measure("a coordinate", "m", '120 or "120 m"')]
Mass = Annotated[float, _above_zero("a mass", "kg", '60 or "60 kg"')]
Density = Annotated[float, _above_zero("a density", "kg/m^3", '7850 or "7850 kg/m^3"')]
Volume = Annotated[float, _not_negative("a volume", "m^3", '0.0076 or "7.6 dm^3"')]
Modulus = Annotated[float, _not_negative("a modulus of elasticity", "Pa", '8e10 or "80 GPa"')]
JointStiffness = Annotated[float, _not_negative("a rotational stiffness", "N m/rad", '26 or "26 N m/rad"')]
JointDamping = Annotated[float, _not_negative("a rotational damping", "N m s/rad", '2.8 or "2.8 N m s/rad"')]
Stiffness = Annotated[float, _not_negative("a stiffness", "N/m", '1200 or "1200 N/m"')]
Damping = Annotated[float, _not_negative("a damping", "N s/m", '237.6 or "237.6 N s/m"')]
RotaryInertia = Annotated[float, _not_negative("a rotary inertia", "kg m^2", '50 or "50 kg m^2"')]
Acceleration = Annotated[float, _not_negative("an acceleration", "m/s^2", '9.81 or "9.81 m/s^2"')]
Coefficient = Annotated[float, _not_negative("a coefficient (a plain number)", "", "1.0")]
LinkDrag = Annotated[float, _not_negative("a drag coefficient of a link", "N s^2/m^2", '200 or "200 N s^2/m^2"')]
Time = Annotated[float, Measure("a time", "s", '15.5 or "15.5 s"')]
Duration = Annotated[float, _above_zero("a time", "s", '31 or "31 s"')]
Frequency = Annotated[float, _above_zero("a frequency", "Hz", '0.25 or "0.25 Hz"')]
Force = Annotated[float, Measure("a force", "N", '200 or "200 N"')]
InputPlace = Annotated[
    float,
    Measure("a coordinate", "m", '0.5 or "0.5 m"', also=', or a table, for example { signal = "sine", ... }'),
]
InputForce = Annotated[
    float,
    Measure("a force", "N", '200 or "200 N"', also=', or a table, for example { signal = "sine", ... }'),
]
# A link's angle at the start: within one turn, so that 45 for "45 deg" is noticed.
Angle = Annotated[float, Measure("an angle", "rad", '0.785 or "45 deg"', -2.0 * math.pi, 2.0 * math.pi)]
# Phase of a sine: any number of turns.
AngleOffset = Annotated[float, Measure("an angle", "rad", '1.57 or "90 deg"')]
Tolerance = Annotated[float, Measure("a relative tolerance (a plain number)", "", "1e-6", 1e-13, 0.1)]
