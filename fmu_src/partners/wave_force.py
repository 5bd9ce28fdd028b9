"""A partner FMU: the vertical force of a long-crested regular wave on floater 1, as a scripted sine.

Not hydrodynamics: no potential flow, no wave kinematics, nothing that depends on the floater's motion. It is
the plainest thing that drives a cable's input `u_m1` from outside. SI, x right, y down.
"""

import math
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

UNITS = {"N": {"kg": "1", "m": "1", "s": "-2"}, "s": {"s": "1"}, "rad": {"rad": "1"}}
PARAMETERS = {  # name: start, unit, description
    "amplitude": (10_000.0, "N", "Amplitude of the force"),
    "period": (8.0, "s", "Period of the wave, above 0"),
    "phase": (0.0, "rad", "Phase at time 0"),
    "ramp": (0.0, "s", "Time from 0 in which the force grows from nothing, as (1 - cos)/2; 0: at once"),
}


class WaveForce(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """force(t) = amplitude * growth(t) * sin(2 pi t / period + phase) [N], positive down."""

    description = "Vertical force of a regular wave on floater 1, a scripted sine; SI, x right, y down"

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        self.time = 0.0
        fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        for name, (start, _, text) in PARAMETERS.items():
            setattr(self, name, start)
            self.register_variable(Real(name, description=text, **fixed))
        text = "Vertical force on floater 1, positive down; x right, y down"
        self.register_variable(Real("force", description=text, causality=Fmi2Causality.output, getter=self.force_now))

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        self.time = start_time

    def do_step(self, current_time: float, step_size: float) -> bool:
        self.time = current_time + step_size
        if not self.in_order():
            self.log("finite parameters, period above 0 and ramp not below 0 are expected", Fmi2Status.error)
        return self.in_order()

    def in_order(self) -> bool:
        finite = all(math.isfinite(getattr(self, name)) for name in PARAMETERS)
        return finite and self.period > 0.0 and self.ramp >= 0.0

    def force_now(self) -> float:
        if not self.in_order():  # an exception would be fatal to the host; the next step fails, with a message
            return 0.0
        growth = 0.5 - 0.5 * math.cos(math.pi * min(max(self.time, 0.0) / self.ramp, 1.0)) if self.ramp else 1.0
        return float(self.amplitude * growth * math.sin(2.0 * math.pi * self.time / self.period + self.phase))

    def to_xml(self, *options: Any) -> Element:
        """The description, with what pythonfmu leaves out: units, and the output among the initial unknowns."""
        root: Element = super().to_xml(*options)
        root.insert(1, definitions := Element("UnitDefinitions"))
        for name, powers in UNITS.items():
            SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", powers)
        variables = list(root.iter("ScalarVariable"))
        for variable in variables:
            variable[0].set("unit", PARAMETERS.get(variable.attrib["name"], (0.0, "N"))[1])
        (structure,) = root.iter("ModelStructure")
        SubElement(SubElement(structure, "InitialUnknowns"), "Unknown", index=str(len(variables)))
        return root
