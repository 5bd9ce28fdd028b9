"""An input in kN."""

from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Kilo(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """Takes u, says nothing."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        self.u = 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))

    def to_xml(self, *options: Any) -> Element:
        root: Element = super().to_xml(*options)
        root.insert(1, definitions := Element("UnitDefinitions"))
        SubElement(SubElement(definitions, "Unit", name="kN"), "BaseUnit", kg="1", m="1", s="-2", factor="1000")
        next(root.iter("ScalarVariable"))[0].set("unit", "kN")
        return root

    def do_step(self, current_time: float, step_size: float) -> bool:
        return True
