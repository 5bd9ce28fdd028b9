"""A partner FMU: the force of a line, a winch or a heave plate between two points on one axis.

Point b is the ground where nothing is connected to it. SI, positive along the axis that the points share.
"""

import math
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

UNITS = {
    "N": {"kg": "1", "m": "1", "s": "-2"}, "m": {"m": "1"}, "m/s": {"m": "1", "s": "-1"},
    "N/m": {"kg": "1", "s": "-2"}, "N.s/m": {"kg": "1", "s": "-1"}, "N.s2/m2": {"kg": "1", "m": "-1"},
}  # fmt: skip
PARAMETERS = {  # name: start, unit, description
    "stiffness": (0.0, "N/m", "Stiffness"),
    "damping": (0.0, "N.s/m", "Damping in proportion to the velocity"),
    "drag": (0.0, "N.s2/m2", "Damping in proportion to the square of the velocity, as of a plate in water"),
    "rest": (0.0, "m", "Distance of a from b at which there is no force"),
}
INPUTS = {
    "y_a": ("m", "Position of a"),
    "v_a": ("m/s", "Velocity of a"),
    "y_b": ("m", "Position of b"),
    "v_b": ("m/s", "Velocity of b"),
}
OUTPUTS = {"F_a": ("N", "Force on a"), "F_b": ("N", "Force on b, the opposite")}


class Spring(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """F_a = -stiffness (y - rest) - damping v - drag |v| v, with y = y_a - y_b and v likewise."""

    description = "Spring, damper and drag between two points on one axis; SI"

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        for name, (start, _, text) in PARAMETERS.items():
            setattr(self, name, start)
            self.register_variable(Real(name, description=text, **fixed))
        for name, (_, text) in INPUTS.items():
            setattr(self, name, 0.0)
            self.register_variable(Real(name, description=text, causality=Fmi2Causality.input, start=0.0))
        for name, getter in (("F_a", self.force), ("F_b", lambda: -self.force())):
            text = OUTPUTS[name][1]
            self.register_variable(Real(name, description=text, causality=Fmi2Causality.output, getter=getter))

    def do_step(self, current_time: float, step_size: float) -> bool:
        if not math.isfinite(self.force()):
            self.log("finite parameters and inputs are expected", Fmi2Status.error)
            return False
        return True

    def force(self) -> float:
        y, v = self.y_a - self.y_b - self.rest, self.v_a - self.v_b
        return float(-self.stiffness * y - self.damping * v - self.drag * abs(v) * v)

    def to_xml(self, *options: Any) -> Element:
        """The description, with what pythonfmu leaves out: units, initial unknowns, and that it can be rolled back."""
        root: Element = super().to_xml(*options)
        root.insert(1, definitions := Element("UnitDefinitions"))
        for name, powers in UNITS.items():
            SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", powers)
        for offered in root.iter("CoSimulation"):
            offered.attrib |= {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
        unit = {name: row[1] for name, row in PARAMETERS.items()} | {n: row[0] for n, row in (INPUTS | OUTPUTS).items()}
        variables = list(root.iter("ScalarVariable"))
        for variable in variables:
            variable[0].set("unit", unit[variable.attrib["name"]])
        (structure,) = root.iter("ModelStructure")
        initial = SubElement(structure, "InitialUnknowns")
        for index, variable in enumerate(variables, start=1):
            if variable.attrib["name"] in OUTPUTS:
                SubElement(initial, "Unknown", index=str(index))
        return root
