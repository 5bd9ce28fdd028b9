"""A partner FMU: a vessel that moves a cable's fairlead in the plane.

It follows sines or samples, or is a body that forces move: on springs and dampers that the cable pulls at, or floating
in waves (bodies.py, which lies beside it then). No rotation. SI, x right, y down; x and y are
displacements from the rest position. Everything that a kind needs stands in resources/vessel.json; beside pythonfmu
the host's Python needs scipy alone. Whatever raises here is fatal for the instance: pythonfmu 0.7 knows no milder
refusal but the discarded step, which FMPy's `simulate_fmu` takes for a run that ended well. It passes no input
derivatives on either. Built by `cablefmu.build_vessel`.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Fmi2Slave, Real
from scipy.interpolate import CubicSpline

AXES = ("x", "y")

Movement = tuple[float, float, float]
"""Displacement [m], velocity [m/s], acceleration [m/s2] along one axis."""
Outputs = dict[str, float]


def named(movements: Iterable[Movement]) -> Outputs:
    """Outputs of movements along x and y."""
    return {
        f"{order}{axis}": value
        for axis, movement in zip(AXES, movements, strict=True)
        for order, value in zip(("", "v", "a"), movement, strict=True)
    }


# --- motion that is given ---


def growth(time: float, ramp: float) -> Movement:
    """From 0 at time 0 to 1 at `ramp` by s^3 (10 - 15 s + 6 s^2), with its rates: smooth to the second derivative."""
    if ramp == 0.0:
        return 1.0, 0.0, 0.0
    s = min(max(time / ramp, 0.0), 1.0)
    rest = s * (1.0 - s)
    return s**3 * (10.0 + s * (6.0 * s - 15.0)), 30.0 * rest**2 / ramp, 60.0 * rest * (1.0 - 2.0 * s) / ramp**2


class Sines:
    """A sum of sines along each axis, each amplitude sin(2 pi frequency t + phase), that grows over the ramp."""

    def __init__(self, about: Mapping[str, Any], parameters: Mapping[str, float]) -> None:
        self.parameters = parameters
        self.count: Mapping[str, int] = about["sines"]

    def at(self, time: float, inputs: Mapping[str, float]) -> Outputs:
        r, dr, ddr = growth(time, self.parameters["ramp"])
        sums = [self.sum(axis, time) for axis in AXES]
        return named((r * q, dr * q + r * v, ddr * q + 2.0 * dr * v + r * a) for q, v, a in sums)

    def sum(self, axis: str, time: float) -> Movement:
        q = v = a = 0.0
        for k in range(1, self.count[axis] + 1):
            size, frequency, phase = (
                self.parameters[f"sine_{axis}[{k}].{name}"] for name in ("amplitude", "frequency", "phase")
            )
            rate = 2.0 * math.pi * frequency
            sine, cosine = math.sin(rate * time + phase), math.cos(rate * time + phase)
            q, v, a = q + size * sine, v + size * rate * cosine, a - size * rate**2 * sine
        return q, v, a

    def advance(self, time: float, step: float, inputs: Mapping[str, float]) -> None:
        """Nothing but time goes on."""

    def memory(self) -> list[Any]:
        return []

    def recall(self, memory: list[Any]) -> None:
        """There is nothing to remember."""


class Samples:
    """Cubic splines through samples: velocity and acceleration are those of the same curve."""

    def __init__(self, about: Mapping[str, Any], parameters: Mapping[str, float]) -> None:
        self.times = about["samples"]["time"]
        self.file: str = about["file"]
        self.spline = CubicSpline(self.times, np.transpose([about["samples"][axis] for axis in AXES]))

    def at(self, time: float, inputs: Mapping[str, float]) -> Outputs:
        first, last = self.times[0], self.times[-1]
        slack = drift(time, 0.0)
        if not first - slack <= time <= last + slack:
            raise ValueError(f"t = {time:.9g} s: the motion in {self.file} is known from {first:.9g} s to {last:.9g} s")
        inside = min(max(time, first), last)
        q, v, a = (self.spline(inside, order).tolist() for order in range(3))
        return named(zip(q, v, a, strict=True))

    def advance(self, time: float, step: float, inputs: Mapping[str, float]) -> None:
        """Nothing but time goes on, as far as there are samples."""
        self.at(time + step, inputs)

    def memory(self) -> list[Any]:
        return []

    def recall(self, memory: list[Any]) -> None:
        """There is nothing to remember."""


MOTIONS: dict[str, Any] = {"sines": Sines, "csv": Samples}
"""Kinds that are here; the others are in the module that resources/vessel.json names."""


# --- what the host sees ---


def drift(time: float, step: float) -> float:
    """Hosts that add up their steps drift by rounding; anything more is a mistake."""
    return 1e-9 * max(abs(time), step, 1e-3)


class Vessel(Fmi2Slave):  # type: ignore[misc]  # pythonfmu has no types
    """A vessel as a Co-Simulation slave; `resources` says which."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        text = Path(self.resources, "vessel.json").read_bytes()
        self.about: dict[str, Any] = json.loads(text)
        self.identity = hashlib.sha256(text).hexdigest()
        self.modelName = self.about["identifier"]  # names the library; the rest of the description is not made here
        self.parameters: dict[str, float] = {entry["name"]: entry["start"] for entry in self.listed("parameter")}
        self.inputs: dict[str, float] = {entry["name"]: entry["start"] for entry in self.listed("input")}
        self.least = {entry["name"]: entry["least"] for entry in self.listed("parameter")}
        self.time, self.stop_time, self.initialised = 0.0, math.inf, False
        self.motion = self.at_start()
        self.known: Outputs | None = None
        for reference, entry in enumerate(self.about["variables"]):
            name = entry["name"]
            real = Real(name, getter=partial(self.get, name), setter=partial(self.set, name))
            real.value_reference = reference
            self.vars[reference] = real

    def listed(self, causality: str) -> list[dict[str, Any]]:
        return [entry for entry in self.about["variables"] if entry["causality"] == causality]

    def at_start(self) -> Any:
        kinds = import_module(self.about["module"]).KINDS if "module" in self.about else MOTIONS
        return kinds[self.about["kind"]](self.about, self.parameters)

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        with self.freed_once():
            if not math.isfinite(start_time):
                raise ValueError(f"start time {start_time} s: a finite number is expected")
            self.motion.at(start_time, self.inputs)
            self.time, self.stop_time = start_time, math.inf if stop_time is None else stop_time
            self.known = None

    def exit_initialization_mode(self) -> None:
        self.initialised = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        with self.freed_once():
            self.check_step(current_time, step_size)
            self.motion.advance(current_time, step_size, self.inputs)
            self.time = current_time + step_size
            self.known = None
        return True

    def check_step(self, point: float, step: float) -> None:
        at, slack = f"doStep at t = {self.time:.9g} s:", drift(self.time, step)
        if not abs(point - self.time) <= slack:
            raise ValueError(f"{at} communication point {point} s is not where the last step ended")
        if not point < point + step < math.inf:
            raise ValueError(f"{at} communication step {step} s; a number above 0 that moves time on is expected")
        if point + step - self.stop_time > slack:
            raise ValueError(f"{at} communication step {step} s leads past the stop time, {self.stop_time} s")

    # --- variables ---

    def get_real(self, vrs: list[int]) -> list[float]:
        with self.freed_once():
            values: list[float] = super().get_real(vrs)
        return values

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        with self.freed_once():
            super().set_real(vrs, values)

    def get(self, name: str) -> float:
        """Value of a variable."""
        if name in self.parameters:
            return self.parameters[name]
        if name in self.inputs:
            return self.inputs[name]
        return self.now()[name]

    def now(self) -> Outputs:
        """All outputs; worked out anew after anything changed."""
        if self.known is None:
            found: Outputs = self.motion.at(self.time, self.inputs)
            if not all(math.isfinite(value) for value in found.values()):
                raise ValueError(f"at t = {self.time:.9g} s the vessel's motion is no finite number")
            self.known = found
        return self.known

    def set(self, name: str, value: float) -> None:
        """Set a parameter or an input.

        Raises
        ------
        ValueError
            If it cannot be set now, or not to this value.
        """
        expected = self.objection(name, value)
        if expected:
            raise ValueError(f"{name} = {value} at t = {self.time:.9g} s: {expected}")
        if name in self.inputs:
            self.inputs[name] = value
        else:
            self.parameters[name] = value
            self.motion = self.at_start()
        self.known = None

    def objection(self, name: str, value: float) -> str | None:
        """What is expected instead of this value, None if it is in order."""
        if name not in self.parameters and name not in self.inputs:
            return "it is calculated and cannot be set"
        if not math.isfinite(value):
            return "a finite number is expected"
        if name in self.inputs:
            return None
        if self.initialised:
            return "parameters are fixed once initialization has ended"
        if self.least[name] == "+0" and value <= 0.0:
            return "a number above 0 is expected"
        return "a number of 0 or more is expected" if self.least[name] == "0" and value < 0.0 else None

    # --- state: bytes from the start, so that a state and its serialised form are one ---

    def _get_fmu_state(self) -> bytes:
        state = {
            "vessel": self.identity, "time": self.time, "initialised": self.initialised, "parameters": self.parameters,
            "inputs": self.inputs, "memory": self.motion.memory(),
        }  # fmt: skip
        body = json.dumps(state).encode()  # every double to the last bit
        return hashlib.sha256(body).hexdigest().encode() + body

    def _set_fmu_state(self, state: bytes) -> None:
        with self.freed_once():
            digest, body = state[:64], state[64:]
            if hashlib.sha256(body).hexdigest().encode() != digest:
                raise ValueError("the state is damaged, or none of a vessel")
            held = json.loads(body)
            if held["vessel"] != self.identity:
                raise ValueError("the state is of another vessel")
            self.time, self.initialised, self.stop_time = held["time"], held["initialised"], math.inf
            self.parameters.update(held["parameters"])  # in place: the motion reads the same
            self.inputs.update(held["inputs"])
            self.motion.recall(held["memory"])
            self.known = None

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        return state  # looked at when it is put back: nothing could make an error here harmless

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
