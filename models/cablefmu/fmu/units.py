"""Units of the FMU's variables: SI exponents, and units that people like to read."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

__all__ = ["UNITS", "Unit"]


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as an FMI description declares it."""

    exponents: dict[str, int]
    """Exponents of the SI base units, e.g. {"kg": 1, "s": -2}; "rad" counts as one."""
    display: dict[str, float] = field(default_factory=dict)
    """Other units by name: value in that unit = factor times value in this one. The first is the default."""


_DEGREES = 180.0 / math.pi

UNITS: dict[str, Unit] = {
    "1": Unit({}),
    "s": Unit({"s": 1}),
    "Hz": Unit({"s": -1}),
    "m": Unit({"m": 1}),
    "m/s": Unit({"m": 1, "s": -1}),
    "m/s2": Unit({"m": 1, "s": -2}),
    "m3": Unit({"m": 3}),
    "rad": Unit({"rad": 1}, {"deg": _DEGREES}),
    "rad/s": Unit({"rad": 1, "s": -1}, {"deg/s": _DEGREES}),
    "rad/s2": Unit({"rad": 1, "s": -2}, {"deg/s2": _DEGREES}),
    "kg": Unit({"kg": 1}, {"t": 1e-3}),
    "kg/m3": Unit({"kg": 1, "m": -3}),
    "kg.m2": Unit({"kg": 1, "m": 2}),
    "N": Unit({"kg": 1, "m": 1, "s": -2}, {"kN": 1e-3}),
    "N/s": Unit({"kg": 1, "m": 1, "s": -3}, {"kN/s": 1e-3}),
    "N/s2": Unit({"kg": 1, "m": 1, "s": -4}, {"kN/s2": 1e-3}),
    "N.m2": Unit({"kg": 1, "m": 3, "s": -2}),
    "J": Unit({"kg": 1, "m": 2, "s": -2}, {"kJ": 1e-3}),
    "N/m": Unit({"kg": 1, "s": -2}, {"kN/m": 1e-3}),
    "N.s/m": Unit({"kg": 1, "s": -1}, {"kN.s/m": 1e-3}),
    "N.m/rad": Unit({"kg": 1, "m": 2, "s": -2, "rad": -1}),
    "N.m.s/rad": Unit({"kg": 1, "m": 2, "s": -1, "rad": -1}),
}
