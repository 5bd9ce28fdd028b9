"""A position controller: PI, from where the load is to the force of its thruster. SI, x to the right."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class PositionController(Fmi2Slave):
    """F = gain (e + integral of e / integral_time), e = set_point - x, within the thruster's limit."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.set_point, self.gain, self.integral_time, self.limit = 15.0, 200.0, 20.0, 1000.0
        self.x, self.F, self.integral = 0.0, 0.0, 0.0
        for name in ("set_point", "gain", "integral_time", "limit"):
            fixed = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
            self.register_variable(Real(name, start=getattr(self, name), **fixed))
        self.register_variable(Real("x", causality=Fmi2Causality.input, start=0.0))
        self.register_variable(Real("F", causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        self.update(0.0)

    def do_step(self, current_time, step_size):
        self.update(step_size)
        return True

    def update(self, step_size):
        error = self.set_point - self.x
        integral = self.integral + error * step_size / self.integral_time
        force = self.gain * (error + integral)
        if abs(force) <= self.limit:  # the integral waits while the thruster can do no more
            self.integral = integral
        self.F = min(max(force, -self.limit), self.limit)
