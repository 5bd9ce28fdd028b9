"""The waves that a sea is made of: harmonics of one repetition time, with wave numbers, heights and orbital speeds.

Every sea here is a sum over n of waves of the frequency n/T: a regular wave of the period T has its harmonics, which
travel with it, and an irregular sea repeats itself after T. Linear theory is in this module; nonlinear waves are those
of `raschii`, spectra those of `wavespectra`. With y down from the still water level, water depth d and theta =
k x - 2 pi n t/T for waves to +x, wave n has the elevation e cos(theta) and, below, the velocities

    u cosh(k (d - y))/cosh(k d) cos(theta) to the right,  u sinh(k (d - y))/cosh(k d) sin(theta) up.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from scipy.optimize import newton

from cablefmu.cable import Floats
from cablefmu.errors import OptionError
from cablefmu.scene_mistakes import Mistake, MistakeFoundError

__all__ = ["Train", "airy", "breaking_height", "irregular", "nonlinear", "profiles", "wave_number"]

LOWEST, HIGHEST = 0.5, 6.0
"""Band of an irregular sea, in peak frequencies: outside lie 1e-9 and 1e-3 of the energy of Pierson and Moskowitz'
spectrum, exp(-1.25 r^-4) of it below r peak frequencies."""

FEWEST_PEAKS = 20
MOST_WAVES = 100_000

_DEEP = 5.0
"""Depth in wave lengths from which tanh(k d) is 1 to the last digit; raschii's sums overflow beyond some 20."""
_SAMPLES = 64
"""Along a wave; more than twice the highest harmonic, so that they hold all of it."""


@dataclass(frozen=True, eq=False)
class Train:
    """Waves n = first, first + 1, ... of frequencies n/period, all arrays of their number."""

    period: float
    """After which everything repeats itself [s]."""
    first: int
    k: Floats
    """Wave numbers [1/m]"""
    elevation: Floats
    """Amplitudes of the surface [m]"""
    speed: Floats
    """Amplitudes of the horizontal velocity at the still water level [m/s]"""
    depth: float
    """[m], infinite in deep water"""
    reach: float
    """How far above the still water level the theory has velocities [m]: 0 for linear theory"""
    limit: float
    """About the height from which on such waves break [m]"""

    @property
    def omega(self) -> Floats:
        """Angular frequencies [rad/s]."""
        return 2.0 * math.pi / self.period * (self.first + np.arange(len(self.k), dtype=float))


def profiles(k: Floats, y: float, depth: float) -> tuple[Floats, Floats]:
    """cosh(k (d - y))/cosh(k d) and sinh(k (d - y))/cosh(k d), without overflow."""
    down, reflected = np.exp(-k * y), np.exp(-k * (2.0 * depth - y))
    whole = 1.0 + np.exp(-2.0 * k * depth)
    return (down + reflected) / whole, (down - reflected) / whole


def wave_number(omega: Floats, depth: float, gravity: float) -> Floats:
    """k of omega^2 = g k tanh(k d), linear theory's dispersion [1/m].

    With q = k d: q tanh q = omega^2 d/g, by Newton's method from Eckart's approximation (5 % off at most).
    """
    deep = omega**2 / gravity
    if math.isinf(depth):
        return deep
    wanted = deep * depth
    guess = wanted / np.sqrt(np.tanh(wanted))

    def excess(q: Floats) -> Floats:
        return q * np.tanh(q) - wanted

    def slope(q: Floats) -> Floats:
        return np.tanh(q) + q * (1.0 - np.tanh(q) ** 2)

    return np.asarray(newton(excess, guess, slope, tol=1e-14, rtol=1e-14, maxiter=50), dtype=float) / depth


def breaking_height(k: float, depth: float) -> float:
    """Height of the steepest wave of this length [m]: 0.142 tanh(k d) of it (Miche 1944)."""
    return 0.142 * math.tanh(k * depth) * 2.0 * math.pi / k


def airy(height: float, period: float | None, length: float | None, depth: float, gravity: float) -> Train:
    """One wave of linear theory, of a period [s] or a length [m].

    Raises
    ------
    MistakeFoundError
        If it would break.
    """
    if length is not None:
        k = 2.0 * math.pi / length
        period = 2.0 * math.pi / math.sqrt(gravity * k * math.tanh(k * depth))
    else:
        assert period is not None
        k = float(wave_number(np.array([2.0 * math.pi / period]), depth, gravity)[0])
    limit = breaking_height(k, depth)
    _check_height("height", height, limit, k)
    speed = math.pi * height / period / math.tanh(k * depth)
    return Train(period, 1, np.array([k]), np.array([height / 2.0]), np.array([speed]), depth, 0.0, limit)


def _check_height(key: str, height: float, limit: float, k: float) -> None:
    if height > limit:
        length = 2.0 * math.pi / k
        raise MistakeFoundError(
            Mistake(
                key,
                f"waves {length:.4g} m long break from {limit:.4g} m on; a lower or a longer one is expected",
                height,
            )
        )


# --- regular waves that are not linear ---


def nonlinear(
    theory: Literal["Stokes", "Fenton"], height: float, period: float | None, length: float | None, depth: float,
    gravity: float, order: int,
) -> Train:  # fmt: skip
    """One wave of Stokes' expansion or of the stream function, of a period [s] or a length [m]; no mean current.

    raschii's own evaluation is sampled along the wave: its harmonics are those samples' discrete Fourier transform.

    Raises
    ------
    MistakeFoundError
        If there is no such wave, or this theory does not find it.
    OptionError
        If raschii is not installed.
    """
    _need("raschii", "nonlinear waves")
    import raschii

    def of_length(length: float) -> Any:
        water = min(depth, _DEEP * length)
        try:
            with np.errstate(all="ignore"):  # what comes of it is looked at
                if theory == "Stokes":
                    return raschii.StokesWave(height, water, length, N=order, g=gravity)
                # Undamped Newton steps converge to the last digits, or not at all.
                return raschii.FentonWave(height, water, length, N=order, g=gravity, relax=1.0)
        except (raschii.RaschiiError, ArithmeticError, ValueError):  # whatever its formulas end in
            raise _not_found(theory, height, length, depth) from None

    if length is None:
        assert period is not None
        linear = 2.0 * math.pi / float(wave_number(np.array([2.0 * math.pi / period]), depth, gravity)[0])
        try:
            length = _length_of(lambda tried: float(of_length(tried).period), period, linear)
        except (RuntimeError, MistakeFoundError):  # secants lead nowhere, or to where there are no waves
            raise _not_found(theory, height, linear, depth) from None
    k = 2.0 * math.pi / length
    limit = breaking_height(k, depth)
    _check_height("height", height, limit, k)
    wave = of_length(length)
    x = length * np.arange(_SAMPLES) / _SAMPLES
    surface = np.asarray(wave.surface_elevation(x, 0.0, include_depth=False))
    half = surface[: _SAMPLES // 2 + 1]
    if not (np.isfinite(surface).all() and (np.diff(half) < 0.0).all()):
        raise _not_found(theory, height, length, depth)
    along = np.asarray(wave.velocity(x, np.full(_SAMPLES, wave.depth), 0.0, all_points_wet=True))[:, 0]
    elevation, speed = (_harmonics(values, order) for values in (surface, along))
    harmonics = np.arange(1, order + 1, dtype=float)
    own = period if period is not None else float(wave.period)
    return Train(own, 1, k * harmonics, elevation, speed, depth, float(half[0]), limit)


def _harmonics(values: Floats, order: int) -> Floats:
    """Amplitudes of the cosines in samples along one wave."""
    return np.asarray(2.0 / len(values) * np.fft.rfft(values).real[1 : order + 1], dtype=float)


def _length_of(period_of: Callable[[float], float], period: float, linear: float) -> float:
    """The length whose wave has this period [m].

    Nonlinear waves are up to a quarter longer than linear ones: secants from there, as shorter ones might break.
    """
    start, tolerance = 1.2 * linear, 1e-9 * linear
    return float(newton(lambda tried: period_of(tried) - period, start, x1=1.1 * linear, tol=tolerance, maxiter=50))


def _not_found(theory: str, height: float, length: float, depth: float) -> MistakeFoundError:
    limit = breaking_height(2.0 * math.pi / length, depth)
    text = (
        f"{theory} waves of this height and {length:.4g} m length are not found; they break from about {limit:.4g} m on"
    )
    if depth < 0.1 * length:
        more = 'kind = "fenton" with a high order finds most' if theory == "Stokes" else "a higher order finds more"
        text += f", and in water so shallow {more}"
    return MistakeFoundError(Mistake("height", text, height))


# --- irregular seas ---


def irregular(
    significant_height: float,
    peak_period: float,
    peakedness: float | None,
    duration: float,
    depth: float,
    gravity: float,
) -> Train:
    """A sea under a spectrum, at all multiples of 1/duration in its band.

    Amplitudes are sqrt(2 S df), not random ones: only phases differ between seas. They are scaled so that the band
    holds all the energy, and so the significant height is exact.

    Raises
    ------
    MistakeFoundError
        If waves of that height and the peak period would break, or the duration is too short or too long.
    OptionError
        If wavespectra is not installed.
    """
    _need("wavespectra", "irregular seas")
    from wavespectra.construct.frequency import jonswap, pierson_moskowitz

    peaks = duration / peak_period
    most = math.floor(MOST_WAVES / (HIGHEST - LOWEST))
    if not FEWEST_PEAKS <= peaks <= most:
        text = f"{FEWEST_PEAKS} to {most} peak periods of {peak_period:g} s are expected"
        raise MistakeFoundError(Mistake("duration", text, duration))
    peak = 1.0 / peak_period
    at_peak = float(wave_number(np.array([2.0 * math.pi * peak]), depth, gravity)[0])
    limit = breaking_height(at_peak, depth)
    _check_height("significant_height", significant_height, limit, at_peak)
    n = np.arange(math.ceil(LOWEST * peaks), math.floor(HIGHEST * peaks) + 1)
    frequencies = n / duration
    if peakedness is None:
        spectrum = pierson_moskowitz(frequencies, peak)
    else:
        spectrum = jonswap(frequencies, peak, gamma=peakedness)
    amplitudes = np.sqrt(np.asarray(spectrum.values, dtype=float))
    amplitudes *= significant_height / 4.0 / math.sqrt(float(np.sum(amplitudes**2)) / 2.0)
    omega = 2.0 * math.pi * frequencies
    k = wave_number(omega, depth, gravity)
    speed = amplitudes * omega / np.tanh(k * depth)
    return Train(duration, int(n[0]), k, amplitudes, speed, depth, 0.0, limit)


def _need(library: str, what: str) -> None:
    if importlib.util.find_spec(library) is None:
        raise OptionError(f"{what} need {library}: pip install 'cablefmu[waves]'")
