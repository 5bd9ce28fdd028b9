"""A partner FMU: long-crested waves in the plane, as elevation and orbital motion at fixed points.

Whatever the theory, a sea repeats itself after some time T, and each of its outputs is a Fourier series

    sum over n of alpha_n cos(2 pi n t/T) + beta_n sin(2 pi n t/T)

with alpha_n + i beta_n turned by the phase of wave n: n times the parameter `phase` in a regular wave, which is its
harmonics, and by a hash of n and the parameter `seed` in an irregular one. Coefficients were found when the FMU was
built and lie in resources/series.npy, of shape (series, 2, waves); resources/waves.json says the rest.

Values depend on the time and on nothing that came before, and are made of +, -, *, / and rounding down alone, in an
order that is written down here, so they have the same bits in every instance, at every step size and on every machine.
SI, x right, y down, elevations positive up. Beside pythonfmu the host's Python needs numpy alone. Whatever raises here
is fatal for the instance: pythonfmu 0.7 knows no milder refusal but the discarded step, which FMPy's `simulate_fmu`
takes for a run that ended well. Built by `cablefmu.build_waves`.
"""

from __future__ import annotations

import ctypes
import hashlib
import io
import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pythonfmu import Fmi2Slave, Real

Floats = NDArray[np.float64]

# --- numbers with the same bits everywhere ---

# sin(r) = r + r^3 S(r^2), cos(r) = 1 - r^2/2 + r^4 C(r^2) on |r| <= pi/4: the polynomials of fmu_src/kernel/sincos.c.
S = (-0.16666666666666632, 0.008333333333322413, -0.0001984126982980784,
     2.7557313691923543e-06, -2.5050758115420524e-08, 1.5896795629940167e-10)  # fmt: skip
C = (0.0416666666666666, -0.0013888888888874125, 2.480158728948215e-05,
     -2.755731435231791e-07, 2.0875723270715568e-09, -1.1359647654546747e-11)  # fmt: skip


def horner(z: Floats, coefficients: tuple[float, ...]) -> Floats:
    value = np.zeros_like(z)
    for coefficient in reversed(coefficients):
        value = coefficient + z * value
    return value


def sincos(turns: Floats) -> tuple[Floats, Floats]:
    """Sine and cosine of angles in turns.

    numpy's own may differ in the last digit between processors. Turns and quarters are taken off without rounding.
    """
    quarters = 4.0 * (turns - np.floor(turns + 0.5))
    nearest = np.floor(quarters + 0.5)
    r = (quarters - nearest) * (0.5 * math.pi)
    z = r * r
    sine = r + r * z * horner(z, S)
    cosine = 1.0 - 0.5 * z + z * z * horner(z, C)
    odd = nearest % 2.0 == 1.0
    below, left = nearest % 4.0 >= 2.0, (nearest + 1.0) % 4.0 >= 2.0
    return (
        np.where(odd, cosine, sine) * np.where(below, -1.0, 1.0),
        np.where(odd, sine, cosine) * np.where(left, -1.0, 1.0),
    )


GOLDEN = 0x9E3779B97F4A7C15


def mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """The output function of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014)."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def scattered(seed: float, harmonics: Floats) -> Floats:
    """A number from 0 to 1 for every harmonic, by its own number and the seed: no generator that may change."""
    key = mixed(np.array([int(seed) + 1], np.uint64) * np.uint64(GOLDEN))
    spread = mixed(key + harmonics.astype(np.uint64) * np.uint64(GOLDEN)) >> np.uint64(11)
    return spread.astype(float) * 2.0**-53


def growth(time: float, ramp: float) -> tuple[float, float]:
    """From 0 at time 0 to 1 at `ramp` by s^3 (10 - 15 s + 6 s^2), with its rate: smooth to the second derivative."""
    if ramp == 0.0:
        return 1.0, 0.0
    s = min(max(time / ramp, 0.0), 1.0)
    rest = s * (1.0 - s)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0)), 30.0 * rest * rest / ramp


# --- the sea ---


class Series:
    """Sums of cosines and sines of n t/T turns, n = first, first + 1, ..."""

    def __init__(self, first: int, period: float, coefficients: Floats) -> None:
        self.period = period
        self.count = coefficients.shape[-1]
        self.harmonics = first + np.arange(self.count, dtype=float)
        self.coefficients = coefficients
        # n = first + a rows + b: cosines and sines of all n are products of those of first + a rows and of b.
        self.rows = math.isqrt(self.count - 1) + 1
        self.columns = -(-self.count // self.rows)
        coarse = first + self.rows * np.arange(self.columns, dtype=float)
        fine = np.arange(self.rows, dtype=float)
        self.factors = np.concatenate((coarse, fine))

    def turned(self, turns: Floats, size: float) -> list[tuple[Floats, Floats]]:
        """Coefficients alpha, beta of every series, turned and sized, in rows b and columns a."""
        sine, cosine = sincos(turns)
        return [
            (self.grid(size * (alpha * cosine - beta * sine)), self.grid(size * (beta * cosine + alpha * sine)))
            for alpha, beta in self.coefficients
        ]

    def grid(self, values: Floats) -> Floats:
        padded = np.zeros(self.columns * self.rows)
        padded[: self.count] = values
        return np.ascontiguousarray(padded.reshape(self.columns, self.rows).T)

    def waves_at(self, time: float) -> tuple[Floats, Floats]:
        """Cosines and sines of all harmonics, in rows b and columns a."""
        sine, cosine = sincos(self.factors * (time / self.period))
        (sine_a, sine_b), (cosine_a, cosine_b) = (np.split(values, [self.columns]) for values in (sine, cosine))
        sine_b, cosine_b = sine_b[:, None], cosine_b[:, None]
        return cosine_b * cosine_a - sine_b * sine_a, sine_b * cosine_a + cosine_b * sine_a

    def rates(self, pair: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
        """Coefficients of the time derivative."""
        omega = self.grid(self.harmonics * (2.0 * math.pi / self.period))
        return omega * pair[1], -omega * pair[0]


def total(pair: tuple[Floats, Floats], waves: tuple[Floats, Floats]) -> float:
    """The sum of a series: columns row by row, then exactly. A dot product would add in an order of its own."""
    return math.fsum(np.add.reduce(pair[0] * waves[0] + pair[1] * waves[1], axis=0).tolist())


# --- what the host sees ---


def drift(time: float, step: float) -> float:
    """Hosts that add up their steps drift by rounding; anything more is a mistake."""
    return 1e-9 * max(abs(time), step, 1e-3)


class Waves(Fmi2Slave):  # type: ignore[misc]  # pythonfmu has no types
    """A sea as a Co-Simulation slave; `resources` says which."""

    def __init__(self, **host: Any) -> None:
        super().__init__(**host)
        text, coefficients = (Path(self.resources, name).read_bytes() for name in ("waves.json", "series.npy"))
        self.about: dict[str, Any] = json.loads(text)
        self.identity = hashlib.sha256(text + coefficients).hexdigest()
        self.modelName = self.about["identifier"]  # names the library; the rest of the description is not made here
        self.built = {entry["name"]: entry["start"] for entry in self.listed("parameter")}
        self.parameters = self.built.copy()
        self.limits = {entry["name"]: (entry["least"], entry["most"]) for entry in self.listed("parameter")}
        self.outputs = {entry["name"]: entry for entry in self.listed("output")}
        self.time, self.stop_time, self.initialised = 0.0, math.inf, False
        read = np.load(io.BytesIO(coefficients), allow_pickle=False)
        self.series = Series(self.about["first"], self.about["period"], read)
        self.turned: list[tuple[Floats, Floats]] | None = None
        self.sloped: dict[int, tuple[Floats, Floats]] = {}
        self.waves: tuple[Floats, Floats] | None = None
        for reference, entry in enumerate(self.about["variables"]):
            name = entry["name"]
            real = Real(name, getter=partial(self.get, name), setter=partial(self.set, name))
            real.value_reference = reference
            self.vars[reference] = real

    def listed(self, causality: str) -> list[dict[str, Any]]:
        return [entry for entry in self.about["variables"] if entry["causality"] == causality]

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        with self.freed_once():
            if not math.isfinite(start_time):
                raise ValueError(f"start time {start_time} s: a finite number is expected")
            self.time, self.stop_time = start_time, math.inf if stop_time is None else stop_time
            self.waves = None

    def exit_initialization_mode(self) -> None:
        self.initialised = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        with self.freed_once():
            self.check_step(current_time, step_size)
            self.time = current_time + step_size
            self.waves = None
        return True

    def check_step(self, point: float, step: float) -> None:
        at, slack = f"doStep at t = {self.time:.9g} s:", drift(self.time, step)
        if not abs(point - self.time) <= slack:
            raise ValueError(f"{at} communication point {point} s is not where the last step ended")
        if not point < point + step < math.inf:
            raise ValueError(f"{at} communication step {step} s; a number above 0 that moves time on is expected")
        if point + step - self.stop_time > slack:
            raise ValueError(f"{at} communication step {step} s leads past the stop time, {self.stop_time} s")

    # --- variables: what nobody asks for is not worked out ---

    def forget(self) -> None:
        """What depends on parameters."""
        self.turned, self.sloped = None, {}

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
            return float(self.parameters[name])
        grown, growing = growth(self.time, self.parameters["ramp"])
        place, is_rate = self.outputs[name]["series"], self.outputs[name]["rate"]
        if grown == 0.0 and growing == 0.0:
            return 0.0
        if not is_rate:
            return grown * self.sum(place)
        value = grown * self.sum(place, rate=True)
        return value if growing == 0.0 else value + growing * self.sum(place)

    def sum(self, place: int, rate: bool = False) -> float:
        """Of one series at the present time, or of its time derivative."""
        if self.turned is None:
            self.turned = self.series.turned(self.turns(), self.size())
        if self.waves is None:
            self.waves = self.series.waves_at(self.time)
        if not rate:
            return total(self.turned[place], self.waves)
        if place not in self.sloped:
            self.sloped[place] = self.series.rates(self.turned[place])
        return total(self.sloped[place], self.waves)

    def turns(self) -> Floats:
        """By how many turns each wave is ahead."""
        if "seed" in self.parameters:
            return scattered(self.parameters["seed"], self.series.harmonics)
        ahead: float = self.parameters["phase"] / (2.0 * math.pi)
        return self.series.harmonics * ahead

    def size(self) -> float:
        """How many times as high the sea is as it was built: linear theory alone has a parameter for that."""
        name = self.about["height"]
        return self.parameters[name] / self.built[name] if name else 1.0

    def set(self, name: str, value: float) -> None:
        """Set a parameter.

        Raises
        ------
        ValueError
            If it cannot be set now, or not to this value.
        """
        expected = self.objection(name, value)
        if expected:
            raise ValueError(f"{name} = {value} at t = {self.time:.9g} s: {expected}")
        self.parameters[name] = value
        self.forget()

    def objection(self, name: str, value: float) -> str | None:
        """What is expected instead of this value, None if it is in order."""
        if name not in self.parameters:
            return "it is calculated and cannot be set"
        if self.initialised:
            return "parameters are fixed once initialization has ended"
        least, most = self.limits[name]
        if not least <= value <= most:
            return f"a number from {least:.9g} to {most:.9g} is expected"
        return "a whole number is expected" if name == "seed" and value != math.floor(value) else None

    # --- state: bytes from the start, so that a state and its serialised form are one ---

    def _get_fmu_state(self) -> bytes:
        state = {
            "waves": self.identity, "time": self.time, "initialised": self.initialised, "parameters": self.parameters
        }  # fmt: skip
        body = json.dumps(state).encode()  # every double to the last bit
        return hashlib.sha256(body).hexdigest().encode() + body

    def _set_fmu_state(self, state: bytes) -> None:
        with self.freed_once():
            digest, body = state[:64], state[64:]
            if hashlib.sha256(body).hexdigest().encode() != digest:
                raise ValueError("the state is damaged, or none of a sea")
            held = json.loads(body)
            if held.get("waves") != self.identity:
                raise ValueError("the state is of another sea")
            self.time, self.initialised, self.stop_time = held["time"], held["initialised"], math.inf
            if held["parameters"] != self.parameters:
                self.parameters = held["parameters"]
                self.forget()
            self.waves = None

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
