"""Units of the description, against pint's table of units."""

from __future__ import annotations

import pint
import pytest

from cablefmu.fmu.units import UNITS

registry = pint.UnitRegistry()


def quantity(text: str) -> pint.Quantity:
    """FMI's way of writing units ("N.m.s/rad", "m/s2") for pint."""
    spelled = text.replace(".", "*").replace("s2", "s**2").replace("m2", "m**2").replace("m3", "m**3")
    return registry.Quantity(1.0, "" if text == "1" else spelled)


@pytest.mark.parametrize("name", UNITS)
def test_exponents_are_those_of_the_name(name: str) -> None:
    product = registry.Quantity(1.0, "")
    for base, power in UNITS[name].exponents.items():
        product = product * registry.Quantity(1.0, base) ** power
    assert product.to_base_units().magnitude == quantity(name).to_base_units().magnitude
    assert product.dimensionality == quantity(name).dimensionality


@pytest.mark.parametrize(("name", "display"), [(name, display) for name in UNITS for display in UNITS[name].display])
def test_display_units_are_worth_their_factor(name: str, display: str) -> None:
    """FMI: value in the display unit = factor times value in the unit."""
    assert quantity(name).to(quantity(display).units).magnitude == pytest.approx(
        UNITS[name].display[display], rel=1e-15
    )
