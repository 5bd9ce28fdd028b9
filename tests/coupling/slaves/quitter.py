"""What gives up in the middle of a run, or says what is no number."""

import math
from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status


class Quitter(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """Fails in the step that reaches `fails_at`; its output is NaN from `nan_at` on."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        self.fails_at = self.nan_at = 1e9
        self.u = self.y = 0.0
        for name in ("fails_at", "nan_at"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed))
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, current_time: float, step_size: float) -> bool:
        end = current_time + step_size
        self.y = math.nan if end >= self.nan_at else 0.0
        if end >= self.fails_at:
            self.log("the line has parted", Fmi2Status.error)
            return False
        return True
