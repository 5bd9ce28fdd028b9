"""The force of waves on a body that is held, as a state space with elevations as inputs.

The force answers to an elevation before it is there: waves reach the near side of a body first, and hydrodynamic
pressure runs ahead. No causal filter of the elevation at one place makes it; of the elevations at several places fore
and aft one does, whatever way the waves travel. A body that is alike fore and aft is pushed along x by the differences
of elevations at -a and a alone, and along y by their sums. All filters share their oscillators.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from ..cable import Floats
from .blocks import LARGEST_RATIO, SMALLEST_RATIO, responses, state_space
from .database import Hydrodynamics

__all__ = ["Excitation", "fit_excitation"]

OSCILLATORS = 4
MODEST = 1e-3
"""Weight of the filters' gains against their errors: without it they would take small differences of huge forces."""
ENOUGH = 0.005
"""Error of a fit that is not tried again from another start."""
_STARTS = (0.6, 0.4, 0.9)

Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Excitation:
    """e' = matrix e + elevations (signals u), force = output e, u being the elevations at the points."""

    matrix: Floats
    """Shape (n, n) [1/s]."""
    elevations: Floats
    """Shape (n, s)."""
    signals: Floats
    """Differences or sums of elevations, shape (s, points)."""
    output: Floats
    """Shape (n,) [N/m]."""
    error: float
    """Largest |X - fit| of all frequencies, of the largest |X|."""

    def response(self, omega: Floats, elevations: Complex) -> Complex:
        """Force in waves whose elevations at the points are these, shape (k, points), as amplitudes [N], shape (k,)."""
        identity, entries = np.eye(len(self.output)), self.elevations @ self.signals
        return np.array([
            self.output @ np.linalg.solve(1j * w * identity - self.matrix, entries @ row)
            for w, row in zip(omega, elevations, strict=True)
        ])  # fmt: skip


def signals_of(points: Floats, axis: int) -> Floats:
    """What moves a body along an axis: differences (0, x) or sums (1, y) of elevations fore and aft."""
    count = len(points)
    rows = []
    for k in range((count + 1) // 2):
        row = np.zeros(count)
        if k == count - 1 - k:
            row[k] = float(axis)
        else:
            row[k], row[count - 1 - k] = 1.0, 1.0 if axis else -1.0
        if np.any(row):
            rows.append(row)
    return np.array(rows).reshape(-1, count)


def fit_excitation(body: Hydrodynamics, points: Floats, axis: int) -> Excitation:
    """Fit the excitation along x (axis 0) or y (axis 1) to elevations at points, symmetric about 0 and rising [m]."""
    omega, target = body.omega, body.excitation[:, axis]
    size = float(np.max(np.abs(target)))
    signals = signals_of(points, axis)
    arriving = np.exp(-1j * body.wavenumber[:, None] * points) @ signals.T
    if size == 0.0 or not len(signals):
        return Excitation(
            np.zeros((0, 0)), np.zeros((0, len(signals))), signals, np.zeros(0), 1.0 if size else 0.0
        )  # fmt: skip

    def gains(p: Floats) -> tuple[Floats, Floats]:
        """Best gains (2 m s,) with these oscillators, and what is missed with them."""
        states = responses(np.exp(p[:OSCILLATORS]), p[OSCILLATORS:], omega)
        columns = (states[:, None, :] * arriving[:, :, None]).reshape(len(omega), -1)
        matrix = np.vstack([columns.real, columns.imag, MODEST * np.eye(columns.shape[1])])
        wanted = np.concatenate([target.real, target.imag, np.zeros(columns.shape[1])]) / size
        found = np.linalg.lstsq(matrix, wanted, rcond=None)[0]
        return found, matrix @ found - wanted

    def missed(p: Floats) -> Floats:
        return gains(p)[1]

    low = np.concatenate([np.full(OSCILLATORS, np.log(omega[0])), np.full(OSCILLATORS, SMALLEST_RATIO)])
    high = np.concatenate([np.full(OSCILLATORS, np.log(2.0 * omega[-1])), np.full(OSCILLATORS, LARGEST_RATIO)])
    spread = np.log(np.geomspace(omega[-1] / 6.0, omega[-1], OSCILLATORS))
    best: Excitation | None = None
    for start in _STARTS:
        guess = np.concatenate([spread + np.log(start), np.full(OSCILLATORS, 0.6)])
        p = least_squares(missed, guess, bounds=(low, high), max_nfev=100).x
        found = _realised(p, gains(p)[0], size, signals, omega, arriving, target)
        if best is None or found.error < best.error:
            best = found
        if best.error < ENOUGH:
            break
    assert best is not None
    return best


def _realised(
    p: Floats, gains: Floats, size: float, signals: Floats, omega: Floats, arriving: Complex, target: Complex
) -> Excitation:
    """Oscillators transposed, so that they share one output: g (s - A)^-1 b = b (s - A')^-1 g."""
    matrix, entry = state_space(np.exp(p[:OSCILLATORS]), p[OSCILLATORS:])
    elevations = gains.reshape(len(signals), -1).T
    made = responses(np.exp(p[:OSCILLATORS]), p[OSCILLATORS:], omega) @ elevations * size
    error = np.max(np.abs(np.sum(made * arriving, axis=1) - target)) / size
    return Excitation(matrix.T, elevations, signals, entry * size, float(error))
