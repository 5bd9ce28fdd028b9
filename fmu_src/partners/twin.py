"""The twin FMU: a scene's cable computed by the dense reference model, to compare the native FMU with.

It shares the scene, the names and the value references with the native FMU, and nothing that computes: the
dissertation's matrices [3.8] under scipy's DOP853, in the Python of the host, which must have the same
version of `cablefmu` installed. It is for checking, not for work: each right-hand side is O(n^3).

Forces are held over a communication step, as pythonfmu passes no input derivatives on, and so is the acceleration of
a motion that is given; velocity and place follow it. Whatever raises here
is fatal for the instance (pythonfmu knows no milder refusal); a step that cannot be done is discarded.
SI, x right, y down. Built by `cablefmu.build_twin`.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Fmi2Slave, Real
from pythonfmu.enums import Fmi2Status

from cablefmu.cable import Floats
from cablefmu.errors import CableError
from cablefmu.fmu.description import model_identifier
from cablefmu.fmu.table import table
from cablefmu.fmu.twin import scene_of_twin, twin_variables
from cablefmu.fmu.variables import Kind, Variable
from cablefmu.reference import Reference, integrate
from cablefmu.scene_inputs import FOLLOWING

# As the native FMU bounds what a host asks for.
LEAST_TOLERANCE, MOST_TOLERANCE = 1e-13, 0.1


def inputs_ahead(held: dict[str, float], ahead: float) -> dict[str, float]:
    """Inputs so many seconds after they were set: of a motion with its acceleration held, x = x + v t + a t^2/2."""
    moved = dict(held)
    for acceleration, (place, order) in FOLLOWING.items():
        if order == 2 and acceleration in held:
            a, v = held[acceleration], held[f"v{place}"]
            moved[f"v{place}"] = v + a * ahead
            moved[place] = held[place] + (v + 0.5 * a * ahead) * ahead
    return moved


class Twin(Fmi2Slave):  # type: ignore[misc]  # pythonfmu has no types
    """A cable as a Co-Simulation slave; `resources` holds its scene."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        scene = scene_of_twin(Path(self.resources))
        self.modelName = model_identifier(scene.name)  # names the library; the rest of the description is not made here
        self.cable = scene.cable
        self.parameters = dict(scene.cable.parameters)
        self.inputs = {name: scene.cable.input_start.get(name, 0.0) for name in scene.cable.inputs}
        # With the heave's place also where there is none: indices of variables count it.
        self.state = self.cable.padded(np.concatenate([scene.cable.position, scene.cable.velocity]))
        self.tolerance = scene.tolerance
        self.initialised = False
        self.known: tuple[Floats, dict[str, float]] | None = None
        for variable in twin_variables(scene):
            real = Real(variable.name, getter=partial(self.get, variable), setter=partial(self.set, variable))
            real.value_reference = variable.reference
            self.vars[variable.reference] = real

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """The host's tolerance, if it gives one and pythonfmu (from 0.7) passes it on; else the scene's."""
        if tolerance is None:
            return
        with self.freed_once():
            if not (math.isfinite(tolerance) and tolerance > 0.0):
                raise ValueError(f"tolerance {tolerance}: a number above 0 is expected")
            self.tolerance = min(max(tolerance, LEAST_TOLERANCE), MOST_TOLERANCE)

    def exit_initialization_mode(self) -> None:
        self.initialised = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Integrate over the step; False (the step is discarded, the state stays) if that cannot be done."""
        span, held = (current_time, current_time + step_size), dict(self.inputs)
        if not span[0] < span[1] < math.inf:
            self.log(f"doStep: communication step {step_size} s; a number above 0 is expected", Fmi2Status.error)
            return False
        try:
            with np.errstate(all="ignore"):  # what is not finite is refused
                motion = integrate(
                    self.model(), lambda t: inputs_ahead(held, t - current_time), span,
                    rtol=self.tolerance, atol=self.tolerance,
                )  # fmt: skip
        except (CableError, ArithmeticError, np.linalg.LinAlgError, ValueError) as error:
            self.log(f"doStep at t = {current_time:g} s: {error}", Fmi2Status.error)
            return False
        self.state = self.cable.padded(np.concatenate([motion.q[-1], motion.v[-1]]))
        self.inputs = inputs_ahead(held, step_size)
        self.known = None
        return True

    def get_real(self, vrs: list[int]) -> list[float]:
        with self.freed_once():
            values: list[float] = super().get_real(vrs)
        return values

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        with self.freed_once():
            super().set_real(vrs, values)

    @contextmanager
    def freed_once(self) -> Iterator[None]:
        """An error here must not end the host's process.

        When a call raises, pythonfmu gives up its references to class, instance and messages, and does so
        again when the host frees the instance (0.7.0). One more of each makes that right.
        """
        try:
            yield
        except Exception:
            for held in (type(self), self, self.log_queue):
                ctypes.pythonapi.Py_IncRef(ctypes.py_object(held))
            raise

    def model(self) -> Reference:
        """The reference model of the cable as it is now, starting in the present state."""
        q, v = np.split(self.cable.unpadded(self.state), 2)
        return Reference(replace(self.cable, parameters=self.parameters, position=q, velocity=v))

    def derivative_and_outputs(self) -> tuple[Floats, dict[str, float]]:
        """Of the present state, inputs and parameters; computed anew after any of them changed."""
        if self.known is None:
            model = self.model()
            q, v = model.cable.position, model.cable.velocity
            with np.errstate(all="ignore"):  # what is not finite is refused below
                rates = self.cable.padded(np.concatenate([v, model.acceleration(q, v, self.inputs)]))
                outputs = model.outputs(q, v, self.inputs)
            if not (np.all(np.isfinite(rates)) and np.all(np.isfinite(list(outputs.values())))):
                raise FloatingPointError("an output is not a finite number; the motion is too violent")
            self.known = rates, outputs
        return self.known

    def get(self, variable: Variable) -> float:
        """Value of a variable."""
        match variable.kind:
            case Kind.PARAMETER:
                return self.parameters[variable.name]
            case Kind.INPUT:
                return self.inputs[variable.name]
            case Kind.STATE:
                return float(self.state[variable.index])
            case Kind.DERIVATIVE:
                return float(self.derivative_and_outputs()[0][variable.index])
            case _:
                return self.derivative_and_outputs()[1][variable.name]

    def set(self, variable: Variable, value: float) -> None:
        """Set a parameter, an input or a start value.

        Raises
        ------
        ValueError
            If it cannot be set now, or not to this value.
        """
        expected = self.objection(variable, value)
        if expected:
            raise ValueError(f"{variable.name} = {value}: {expected}")
        match variable.kind:
            case Kind.PARAMETER:
                self.parameters[variable.name] = value
            case Kind.INPUT:
                self.inputs[variable.name] = value
            case _:
                self.state[variable.index] = value
        self.known = None

    def objection(self, variable: Variable, value: float) -> str | None:
        """What is expected instead of this value, None if it is in order."""
        if variable.kind not in (Kind.PARAMETER, Kind.INPUT, Kind.STATE):
            return "it is calculated and cannot be set"
        if not math.isfinite(value):
            return "a finite number is expected"
        if variable.kind is not Kind.INPUT and self.initialised:
            return "parameters and start values are fixed once initialization has ended"
        least = table().parameters[variable.name].least if variable.kind is Kind.PARAMETER else "-inf"
        if least == "+0" and value <= 0.0:
            return "a number above 0 is expected"
        return "a number of 0 or more is expected" if least == "0" and value < 0.0 else None
