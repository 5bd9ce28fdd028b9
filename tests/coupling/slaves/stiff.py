"""Takes steps of one length and cannot go back: so says its description."""

from typing import Any

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Stiff(Fmi2Slave):  # type: ignore[misc]  # pythonfmu is untyped
    """Takes u, says nothing."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        self.u = 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))

    def do_step(self, current_time: float, step_size: float) -> bool:
        return True
