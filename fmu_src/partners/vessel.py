"""A partner FMU: a vessel that moves a cable's fairlead in the plane.

It follows sines or samples, or is a rigid body on springs and dampers that the cable pulls at. Each axis is on
its own: m q'' + c q' + k q = F(t) + external - static_load is linear, so a communication step is the exact
exponential of its matrix, with F a polynomial within the step, and there is no step size to tune.

Not hydrodynamics: no waves, no added mass that depends on frequency, no rotation. SI, x right, y down; x and y are
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
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Fmi2Slave, Real
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

AXES = ("x", "y")

Movement = tuple[float, float, float]
"""Displacement [m], velocity [m/s], acceleration [m/s2] along one axis."""


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

    def at(self, time: float, inputs: Mapping[str, float]) -> list[Movement]:
        r, dr, ddr = growth(time, self.parameters["ramp"])
        sums = [self.sum(axis, time) for axis in AXES]
        return [(r * q, dr * q + r * v, ddr * q + 2.0 * dr * v + r * a) for q, v, a in sums]

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

    def at(self, time: float, inputs: Mapping[str, float]) -> list[Movement]:
        first, last = self.times[0], self.times[-1]
        slack = drift(time, 0.0)
        if not first - slack <= time <= last + slack:
            raise ValueError(f"t = {time:.9g} s: the motion in {self.file} is known from {first:.9g} s to {last:.9g} s")
        inside = min(max(time, first), last)
        q, v, a = (self.spline(inside, order).tolist() for order in range(3))
        return list(zip(q, v, a, strict=True))

    def advance(self, time: float, step: float, inputs: Mapping[str, float]) -> None:
        """Nothing but time goes on, as far as there are samples."""
        self.at(time + step, inputs)

    def memory(self) -> list[Any]:
        return []

    def recall(self, memory: list[Any]) -> None:
        """There is nothing to remember."""


# --- a body that is pulled at ---


@lru_cache(maxsize=256)
def propagator(stiffness: float, damping: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """What one step makes of (q, w, G, G', G''), as rows for q and w.

    Time is counted in steps h, so that numbers of any size agree: w = v h, G = f h^2/m and its derivatives with
    respect to t/h, stiffness = k h^2/m, damping = c h/m. Then q' = w, w' = G - stiffness q - damping w, and G''' = 0.
    """
    matrix = np.diag([1.0, 1.0, 1.0, 1.0], 1)
    matrix[1, :2] = -stiffness, -damping
    with np.errstate(all="ignore"):  # what is not finite is refused
        rows = expm(matrix)[:2].tolist()
    return tuple(rows[0]), tuple(rows[1])


def at_end(force: tuple[float, float, float], step: float) -> float:
    """What a force with these derivatives at the beginning of a step is at its end."""
    return force[0] + step * (force[1] + step / 2.0 * force[2])


class Body:
    """A mass on a spring and a damper along each axis, without coupling between the axes."""

    def __init__(self, about: Mapping[str, Any], parameters: Mapping[str, float]) -> None:
        self.parameters = parameters
        self.extrapolation: int | str = about["extrapolation"]
        self.place = [[parameters[f"{axis}_0"], parameters[f"v{axis}_0"]] for axis in AXES]
        # Forces at the beginnings of the last steps, the latest first: time, force along x, along y.
        self.past: list[list[float]] = []

    def of(self, axis: str, *names: str) -> list[float]:
        return [self.parameters[f"{name}_{axis}"] for name in names]

    def at(self, time: float, inputs: Mapping[str, float]) -> list[Movement]:
        moving = []
        for axis, (q, v) in zip(AXES, self.place, strict=True):
            m, c, k, external, static_load = self.of(axis, "m", "c", "k", "external", "static_load")
            moving.append((q, v, (inputs[f"F_{axis}"] + external - static_load - k * q - c * v) / m))
        return moving

    def advance(self, time: float, step: float, inputs: dict[str, float]) -> None:
        forces = [self.force(place, time, inputs) for place in range(len(AXES))]
        moved = [self.moved(place, step, force) for place, force in enumerate(forces)]
        if not all(math.isfinite(value) for both in moved for value in both):
            raise ValueError(f"doStep at t = {time:.9g} s: the step leads to no finite number; the force is too large")
        if self.extrapolation == "given":  # acceleration at the end is that of the force there
            inputs |= {f"F_{axis}": at_end(force, step) for axis, force in zip(AXES, forces, strict=True)}
        kept = self.extrapolation if isinstance(self.extrapolation, int) else 0
        self.place, self.past = moved, [[time, *(force[0] for force in forces)], *self.past][:kept]

    def force(self, place: int, time: float, inputs: Mapping[str, float]) -> tuple[float, float, float]:
        """The cable's force at the step's beginning and its first two time derivatives, constant from there."""
        axis = AXES[place]
        now = inputs[f"F_{axis}"]
        if self.extrapolation == "given":
            return now, inputs[f"der(F_{axis})"], inputs[f"der(F_{axis},2)"]
        # Newton's divided differences through now and what there is of the past: the first step holds.
        known = [(time, now), *((entry[0], entry[1 + place]) for entry in self.past)]
        slopes = [(f1 - f0) / (t1 - t0) for (t1, f1), (t0, f0) in pairwise(known)]
        if len(slopes) < 2:
            return now, slopes[0] if slopes else 0.0, 0.0
        bend = (slopes[0] - slopes[1]) / (known[0][0] - known[2][0])
        return now, slopes[0] + bend * (known[0][0] - known[1][0]), 2.0 * bend

    def moved(self, place: int, step: float, force: tuple[float, float, float]) -> list[float]:
        """Displacement and velocity at the step's end."""
        m, c, k, external, static_load = self.of(AXES[place], "m", "c", "k", "external", "static_load")
        q, v = self.place[place]
        h, hh = step, step * step
        stiffness, damping = k * hh / m, c * h / m
        if not (math.isfinite(stiffness) and math.isfinite(damping)):
            return [math.inf, math.inf]
        total = force[0] + external - static_load
        scaled = (q, v * h, total * hh / m, force[1] * hh * h / m, force[2] * hh * hh / m)
        q, w = (
            sum(factor * value for factor, value in zip(row, scaled, strict=True))
            for row in propagator(stiffness, damping)
        )
        return [q, w / h]

    def memory(self) -> list[Any]:
        return [self.place, self.past]

    def recall(self, memory: list[Any]) -> None:
        self.place, self.past = memory


MOTIONS: dict[str, type[Sines] | type[Samples] | type[Body]] = {"sines": Sines, "csv": Samples, "body": Body}


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
        self.known: list[Movement] | None = None
        for reference, entry in enumerate(self.about["variables"]):
            name = entry["name"]
            real = Real(name, getter=partial(self.get, name), setter=partial(self.set, name))
            real.value_reference = reference
            self.vars[reference] = real

    def listed(self, causality: str) -> list[dict[str, Any]]:
        return [entry for entry in self.about["variables"] if entry["causality"] == causality]

    def at_start(self) -> Sines | Samples | Body:
        return MOTIONS[self.about["kind"]](self.about, self.parameters)

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
        order = {"v": 1, "a": 2}.get(name[0], 0)
        return self.moving()[AXES.index(name[-1])][order]

    def moving(self) -> list[Movement]:
        """The fairlead's movement now; worked out anew after anything changed."""
        if self.known is None:
            found = self.motion.at(self.time, self.inputs)
            if not all(math.isfinite(value) for movement in found for value in movement):
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
