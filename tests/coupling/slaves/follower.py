"""A mass on a spring and a damper: motion in, the force that moving it takes, the other way round, out."""

from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {"m": 1.0, "k": 0.0, "c": 0.0}


class Follower(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """F = -(m a + c v + k x), at once."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        for name, start in PARAMETERS.items():
            setattr(self, name, start)
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed))
        for name in ("x", "v", "a"):
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("F", causality=Fmi2Causality.output, getter=self.force))

    def force(self) -> float:
        return float(-self.m * self.a - self.c * self.v - self.k * self.x)

    def do_step(self, current_time: float, step_size: float) -> bool:
        return True
