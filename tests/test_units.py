"""Numbers and texts with units become SI, and nothing else gets through."""

from __future__ import annotations

import math
from typing import Any, get_args

import pytest
from pydantic_core import PydanticCustomError

from cablefmu import units as u


def measure(kind: Any) -> u.Measure:
    """The `Measure` that an annotated type carries."""
    return next(entry for entry in get_args(kind) if isinstance(entry, u.Measure))


@pytest.mark.parametrize(
    ("kind", "written", "si"),
    [
        (u.Length, 240, 240.0),
        (u.Length, "240 m", 240.0),
        (u.Length, "20mm", 0.02),
        (u.Length, "1 ft", 0.3048),
        (u.Angle, "45 deg", math.pi / 4.0),
        (u.Angle, "-45°", -math.pi / 4.0),
        (u.Angle, "0.5 rad", 0.5),
        (u.Modulus, "80 GPa", 8e10),
        (u.Modulus, "8e10 N/m^2", 8e10),
        (u.Density, "7.85 g/cm^3", 7850.0),
        (u.Density, "7850 kg/m**3", 7850.0),
        (u.JointStiffness, "26 N m/rad", 26.0),
        (u.JointStiffness, "1 N*m/deg", 180.0 / math.pi),
        (u.JointDamping, "2.8 N·m·s/rad", 2.8),
        (u.Stiffness, "120 kN/m", 1.2e5),
        (u.Damping, "7920 N s/m", 7920.0),
        (u.LinkDrag, "200 N s^2/m^2", 200.0),
        (u.RotaryInertia, "50 kg m^2", 50.0),
        (u.Volume, "7.6 dm^3", 0.0076),
        (u.Frequency, "0.25 1/s", 0.25),
        (u.Duration, "2 min", 120.0),
        (u.Force, "-2 kN", -2000.0),
        (u.Acceleration, "981 cm/s^2", 9.81),
        (u.Tolerance, 1e-6, 1e-6),
    ],
)
def test_a_value_is_read_in_si(kind: Any, written: object, si: float) -> None:
    # Unit factors are products of powers of ten: a few roundings.
    assert measure(kind).read(written) == pytest.approx(si, rel=4e-15)


@pytest.mark.parametrize(
    ("kind", "written", "says"),
    [
        (u.Length, "5 kg", 'a length [m] is expected, for example 240 or "240 m"'),
        (u.Length, "240", "the unit is missing"),
        (u.Length, "240 metros", "a length [m]"),
        (u.Length, "1,5 m", "a length [m]"),
        (u.Length, "", "a length [m]"),
        (u.Length, "1e400 m", "not a finite number"),
        (u.Length, 10**400, "not a finite number"),
        (u.Length, math.nan, "not a finite number"),
        (u.Length, math.inf, "not a finite number"),
        (u.Length, True, "a length [m]"),
        (u.Length, [1.0], "a length [m]"),
        (u.Length, 0, "greater than 0"),
        (u.Length, "-2 m", "greater than 0"),
        (u.Length, 1e16, "greater than 0 (from 1e-12 to 1e+15 m)"),
        (u.Stiffness, -1, "0 or greater"),
        # An angle counts as a unit: pint alone would take each of these.
        (u.Frequency, "2 rad/s", "a frequency [Hz]"),
        (u.Frequency, "2 rpm", "a frequency [Hz]"),
        (u.Angle, "3 percent", "an angle [rad]"),
        (u.JointStiffness, "26 N m", "a rotational stiffness [N m/rad]"),
        (u.Angle, 45, 'for example 0.785 or "45 deg"'),
        (u.Tolerance, "1 m", "a relative tolerance (a plain number) is expected"),
        (u.Tolerance, 0.5, "from 1e-13 to 0.1"),
    ],
)
def test_anything_else_is_refused_with_what_is_allowed(kind: Any, written: object, says: str) -> None:
    with pytest.raises(PydanticCustomError) as refused:
        measure(kind).read(written)
    assert says in refused.value.message()


@pytest.mark.parametrize("text", ["9**9**9**9 m", "1 m^99999999", "1 " + "m " * 5000, "1 __import__('os')", "1 m;2"])
def test_a_text_is_never_evaluated_as_an_expression(text: str) -> None:
    with pytest.raises(PydanticCustomError, match="a length"):
        measure(u.Length).read(text)
