"""Bodies that forces move, as linear systems: part of the vessel FMU (vessel.py), which loads it.

A body on springs and dampers, a body that floats in waves and radiates them, or such a body held, on which waves
press. All are linear, so a communication step is the exact exponential of their matrix, with every input a polynomial
within the step: there is no step size to tune. SI, x right, y down; elevations up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.linalg import expm

AXES = ("x", "y")

Outputs = dict[str, float]
Course = tuple[float, float, float]
"""An input at a step's beginning and its first two time derivatives, constant from there."""


def at_end(course: Course, step: float) -> float:
    """What an input with these derivatives at the beginning of a step is at its end."""
    return course[0] + step * (course[1] + step / 2.0 * course[2])


class Courses:
    """How inputs go on within a step: by derivatives that are inputs too, or by what they were before."""

    def __init__(self, names: list[str], extrapolation: int | str) -> None:
        self.names, self.extrapolation = names, extrapolation
        # Inputs at the beginnings of the last steps, the latest first: time, and one value for each.
        self.past: list[list[float]] = []

    def within(self, time: float, inputs: Mapping[str, float]) -> dict[str, Course]:
        """Of every input, in the step that begins now."""
        return {name: self.course(place, time, inputs) for place, name in enumerate(self.names)}

    def course(self, place: int, time: float, inputs: Mapping[str, float]) -> Course:
        name = self.names[place]
        now = inputs[name]
        if self.extrapolation == "given":
            return now, inputs[f"der({name})"], inputs[f"der({name},2)"]
        # Newton's divided differences through now and what there is of the past: the first step holds.
        known = [(time, now), *((entry[0], entry[1 + place]) for entry in self.past)]
        slopes = [(f1 - f0) / (t1 - t0) for (t1, f1), (t0, f0) in pairwise(known)]
        if len(slopes) < 2:
            return now, slopes[0] if slopes else 0.0, 0.0
        bend = (slopes[0] - slopes[1]) / (known[0][0] - known[2][0])
        return now, slopes[0] + bend * (known[0][0] - known[1][0]), 2.0 * bend

    def passed(self, time: float, step: float, courses: Mapping[str, Course], inputs: dict[str, float]) -> None:
        """The step is done: outputs at its end are those of the inputs there, where their way was given."""
        if self.extrapolation == "given":
            inputs |= {name: at_end(course, step) for name, course in courses.items()}
        kept = self.extrapolation if isinstance(self.extrapolation, int) else 0
        self.past = [[time, *(course[0] for course in courses.values())], *self.past][:kept]


def checked(time: float, values: list[float]) -> None:
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"doStep at t = {time:.9g} s: the step leads to no finite number; the force is too large")


# --- a body on springs and dampers ---


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


class Body:
    """A mass on a spring and a damper along each axis, without coupling between the axes."""

    def __init__(self, about: Mapping[str, Any], parameters: Mapping[str, float]) -> None:
        self.parameters = parameters
        self.courses = Courses([f"F_{axis}" for axis in AXES], about["extrapolation"])
        self.place = [[parameters[f"{axis}_0"], parameters[f"v{axis}_0"]] for axis in AXES]

    def of(self, axis: str, *names: str) -> list[float]:
        return [self.parameters[f"{name}_{axis}"] for name in names]

    def at(self, time: float, inputs: Mapping[str, float]) -> Outputs:
        outputs: Outputs = {}
        for axis, (q, v) in zip(AXES, self.place, strict=True):
            m, c, k, external, static_load = self.of(axis, "m", "c", "k", "external", "static_load")
            pull = inputs[f"F_{axis}"] + external - static_load
            outputs |= {axis: q, f"v{axis}": v, f"a{axis}": (pull - k * q - c * v) / m}
        return outputs

    def advance(self, time: float, step: float, inputs: dict[str, float]) -> None:
        courses = self.courses.within(time, inputs)
        moved = [self.moved(place, step, courses[f"F_{axis}"]) for place, axis in enumerate(AXES)]
        checked(time, [value for both in moved for value in both])
        self.place = moved
        self.courses.passed(time, step, courses, inputs)

    def moved(self, place: int, step: float, force: Course) -> list[float]:
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
        return [self.place, self.courses.past]

    def recall(self, memory: list[Any]) -> None:
        self.place, self.courses.past = memory


# --- bodies in waves ---


class Linear:
    """z' = matrix z + entry u, with every u a parabola within a step."""

    def __init__(self, matrix: Any, entry: Any) -> None:
        self.matrix, self.entry = matrix, entry
        self.propagator = lru_cache(maxsize=64)(self.propagated)

    def propagated(self, step: float) -> Any:
        """What a step makes of z, u, u' h and u'' h^2 one below the other: time is counted in steps h."""
        states, inputs = self.entry.shape
        whole = np.zeros((states + 3 * inputs, states + 3 * inputs))
        whole[:states, :states], whole[:states, states : states + inputs] = self.matrix * step, self.entry * step
        held = np.arange(states, states + 2 * inputs)
        whole[held, held + inputs] = 1.0
        with np.errstate(all="ignore"):  # what is not finite is refused
            return np.ascontiguousarray(expm(whole)[:states]) if np.all(np.isfinite(whole)) else whole[:states] * np.inf

    def advanced(self, state: list[float], courses: list[Course], step: float) -> list[float]:
        """The state at the step's end."""
        now, first, second = zip(*courses, strict=True) if courses else ((), (), ())
        before = np.array([*state, *now, *(step * rate for rate in first), *(step * step * bend for bend in second)])
        with np.errstate(all="ignore"):
            after: list[float] = (self.propagator(step) @ before).tolist()
        return after


def filters(about: Mapping[str, Any], axis: str) -> tuple[Any, ...]:
    """The excitation along an axis: matrix, entry of the signals, signals of the elevations, output."""
    held = about["excitation"][axis]
    output = np.array(held["output"])
    signals = np.array(held["signals"]).reshape(-1, about["points"])
    return (
        np.array(held["matrix"]).reshape(len(output), len(output)),
        np.array(held["elevations"]).reshape(len(output), len(signals)), signals, output,
    )  # fmt: skip


def elevations_of(about: Mapping[str, Any]) -> list[str]:
    return [f"elevation[{k}]" for k in range(1, about["points"] + 1)]


def combined(signals: Any, courses: list[Course]) -> list[Course]:
    """Sums and differences of elevations, with their derivatives."""
    return [(f, df, ddf) for f, df, ddf in (signals @ np.array(courses).reshape(-1, 3)).tolist()]


class Held:
    """A body that does not move: elevations in, the force of waves out."""

    def __init__(self, about: Mapping[str, Any], parameters: Mapping[str, float]) -> None:
        self.elevations = elevations_of(about)
        self.courses = Courses(self.elevations, about["extrapolation"])
        axes = [filters(about, axis) for axis in AXES]
        self.systems = [Linear(matrix, entry) for matrix, entry, _, _ in axes]
        self.signals, self.outputs = [axis[2] for axis in axes], [axis[3] for axis in axes]
        self.states = [[0.0] * len(output) for output in self.outputs]

    def at(self, time: float, inputs: Mapping[str, float]) -> Outputs:
        return {f"F_wave_{axis}": float(self.outputs[i] @ self.states[i]) for i, axis in enumerate(AXES)}

    def advance(self, time: float, step: float, inputs: dict[str, float]) -> None:
        courses = self.courses.within(time, inputs)
        waves = [courses[name] for name in self.elevations]
        states = [
            system.advanced(state, combined(signals, waves), step)
            for system, signals, state in zip(self.systems, self.signals, self.states, strict=True)
        ]
        checked(time, [value for state in states for value in state])
        self.states = states
        self.courses.passed(time, step, courses, inputs)

    def memory(self) -> list[Any]:
        return [self.states, self.courses.past]

    def recall(self, memory: list[Any]) -> None:
        self.states, self.courses.past = memory


class Floating:
    """(m + A) q'' + c q' + (k + hydrostatic) q = F + F_wave - r + external - static_load along each axis.

    A is the added mass at infinite frequency, r the memory of radiated waves, F_wave the force of the waves: both are
    filters beside q and q' in one system. Its states are forces by the mass m + A.
    """

    def __init__(self, about: Mapping[str, Any], parameters: Mapping[str, float]) -> None:
        self.parameters = parameters
        self.elevations = elevations_of(about)
        self.courses = Courses([*(f"F_{axis}" for axis in AXES), *self.elevations], about["extrapolation"])
        self.masses = [parameters["mass"] + about["added_mass"][axis] for axis in AXES]
        self.systems: list[Linear] = []
        self.signals: list[Any] = []
        self.rows: list[Any] = []
        """What makes the acceleration of the state."""
        self.outputs: list[Any] = []
        """What makes the force of waves of the state."""
        self.states: list[list[float]] = []
        for axis, mass in zip(AXES, self.masses, strict=True):
            self.add(about, axis, mass)

    def add(self, about: Mapping[str, Any], axis: str, mass: float) -> None:
        """The system of one axis: q, q', memory, excitation, pulled by one force and the elevations' signals."""
        wave_matrix, wave_entry, signals, wave_output = filters(about, axis)
        held = about["radiation"][axis]
        output = np.array(held["output"])
        n, e = len(output), len(wave_output)
        matrix, entry = np.zeros((2 + n + e, 2 + n + e)), np.zeros((2 + n + e, 1 + len(signals)))
        spring = about["hydrostatic"][axis] + self.parameters[f"k_{axis}"]
        matrix[0, 1] = 1.0
        matrix[1] = [-spring / mass, -self.parameters[f"c_{axis}"] / mass, *-output, *wave_output]
        matrix[2 : 2 + n, 1] = np.array(held["velocity"]) / mass
        matrix[2 : 2 + n, 2 : 2 + n] = np.array(held["matrix"]).reshape(n, n)
        matrix[2 + n :, 2 + n :] = wave_matrix
        entry[1, 0], entry[2 + n :, 1:] = 1.0 / mass, wave_entry / mass
        self.systems.append(Linear(matrix, entry))
        self.signals.append(signals)
        self.outputs.append(np.concatenate([np.zeros(2 + n), wave_output]) * mass)
        self.rows.append(matrix[1])
        self.states.append([self.parameters[f"{axis}_0"], self.parameters[f"v{axis}_0"]] + [0.0] * (n + e))

    def constant(self, axis: str) -> float:
        return self.parameters[f"external_{axis}"] - self.parameters[f"static_load_{axis}"]

    def at(self, time: float, inputs: Mapping[str, float]) -> Outputs:
        outputs: Outputs = {}
        for i, axis in enumerate(AXES):
            state, pull = self.states[i], inputs[f"F_{axis}"] + self.constant(axis)
            with np.errstate(all="ignore"):
                outputs |= {
                    axis: state[0], f"v{axis}": state[1],
                    f"a{axis}": float(self.rows[i] @ state) + pull / self.masses[i],
                    f"F_wave_{axis}": float(self.outputs[i] @ state),
                }  # fmt: skip
        return outputs

    def advance(self, time: float, step: float, inputs: dict[str, float]) -> None:
        courses = self.courses.within(time, inputs)
        waves = [courses[name] for name in self.elevations]
        states = []
        for i, axis in enumerate(AXES):
            force = courses[f"F_{axis}"]
            pull = (force[0] + self.constant(axis), force[1], force[2])
            states.append(self.systems[i].advanced(self.states[i], [pull, *combined(self.signals[i], waves)], step))
        checked(time, [value for state in states for value in state])
        self.states = states
        self.courses.passed(time, step, courses, inputs)

    def memory(self) -> list[Any]:
        return [self.states, self.courses.past]

    def recall(self, memory: list[Any]) -> None:
        self.states, self.courses.past = memory


KINDS = {"body": Body, "floating": Floating, "excitation": Held}
