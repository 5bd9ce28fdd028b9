"""A mass on a spring and a damper: force in, motion out; exact for a force that goes linearly to its new value."""

from typing import Any

import numpy as np
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from scipy.linalg import expm

PARAMETERS = {"m": 1.0, "k": 0.0, "c": 0.0, "x_0": 0.0}


class Mass(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """m x'' + c x' + k x = F."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        for name, start in PARAMETERS.items():
            setattr(self, name, start)
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed))
        self.F = self.before = self.x = self.v = 0.0
        self.register_variable(Real("F", causality=Fmi2Causality.input))
        for name in ("x", "v"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        self.register_variable(Real("a", causality=Fmi2Causality.output, getter=self.acceleration))
        self.register_variable(Real("before", causality=Fmi2Causality.local))

    def acceleration(self) -> float:
        return float((self.F - self.c * self.v - self.k * self.x) / self.m)

    def enter_initialization_mode(self) -> None:
        self.x = self.x_0

    def exit_initialization_mode(self) -> None:
        self.before = self.F

    def do_step(self, current_time: float, step_size: float) -> bool:
        matrix = np.zeros((4, 4))  # of x, v, F and the slope of F
        matrix[0, 1], matrix[2, 3] = 1.0, 1.0
        matrix[1, :3] = np.array([-self.k, -self.c, 1.0]) / self.m
        start = [self.x, self.v, self.before, (self.F - self.before) / step_size]
        self.x, self.v = map(float, (expm(matrix * step_size) @ start)[:2])
        self.before = self.F
        return bool(np.isfinite(self.x))
