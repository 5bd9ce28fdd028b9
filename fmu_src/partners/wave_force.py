"""A partner FMU: the vertical force of a long-crested regular wave on floater 1, as a scripted sine.

Not hydrodynamics: no potential flow, no wave kinematics, no dependence on the floater's motion. It is the
plainest thing that drives `u_m1` of a cable's FMU from outside. Built by `pythonfmu`, which has no unit
attributes: units stand in the descriptions. SI, x right, y down.
"""

import math
from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {
    "amplitude": (10_000.0, "Amplitude of the force [N]"),
    "period": (8.0, "Period of the wave, above 0 [s]"),
    "phase": (0.0, "Phase at time 0 [rad]"),
    "ramp": (0.0, "Time over which the force grows from nothing as (1 - cos)/2; 0: at once [s]"),
}


class WaveForce(Fmi2Slave):
    """force(t) = amplitude * growth(t) * sin(2 pi t / period + phase) [N], positive down."""

    description = "Vertical force of a regular wave on floater 1, a scripted sine; SI, x right, y down"

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        self.time = 0.0
        for name, (value, text) in PARAMETERS.items():
            setattr(self, name, value)
            fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
            self.register_variable(Real(name, description=text, **fixed))
        text = "Vertical force on floater 1, positive down [N]; x right, y down"
        self.register_variable(Real("force", causality=Fmi2Causality.output, description=text, getter=self.force_now))

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        self.time = start_time

    def exit_initialization_mode(self) -> None:
        values = {name: getattr(self, name) for name in PARAMETERS}
        if not (all(map(math.isfinite, values.values())) and self.period > 0.0 and self.ramp >= 0.0):
            raise ValueError(f"{values}: finite numbers, period above 0 and ramp not below 0 are expected")

    def do_step(self, current_time: float, step_size: float) -> bool:
        self.time = current_time + step_size
        return True

    def force_now(self) -> float:
        growth = 0.5 - 0.5 * math.cos(math.pi * min(self.time / self.ramp, 1.0)) if self.ramp > 0.0 else 1.0
        return self.amplitude * growth * math.sin(2.0 * math.pi * self.time / self.period + self.phase)
