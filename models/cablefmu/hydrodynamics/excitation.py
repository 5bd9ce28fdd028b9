"""The force of waves on a body that is held, as a state space with elevations as inputs.

The force answers to an elevation before it is there: waves reach the near side of a body first, and hydrodynamic
pressure runs ahead. No causal filter of the elevation at one place makes it; of the elevations at several places fore
and aft one does, whatever way the waves travel. What very long waves do is known without coefficients, and is met. A
body that is alike fore and aft is pushed along x by the differences of elevations at -a and a alone, and along y by
their sums. All filters share their oscillators.
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
LONG_WAVES = 10.0
"""Weight of what waves of no end do, which is known without coefficients."""
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
    task = _Task.of(body, points, axis)
    if not task.size or not len(task.signals):
        nothing = np.zeros(0)
        return Excitation(
            np.zeros((0, 0)), np.zeros((0, len(task.signals))), task.signals, nothing, 1.0 if task.size else 0.0
        )  # fmt: skip
    last = task.omega[-1]
    low = np.concatenate([np.full(OSCILLATORS, np.log(body.omega[0])), np.full(OSCILLATORS, SMALLEST_RATIO)])
    high = np.concatenate([np.full(OSCILLATORS, np.log(2.0 * last)), np.full(OSCILLATORS, LARGEST_RATIO)])
    spread = np.geomspace(last / 6.0, last, OSCILLATORS)
    best: Excitation | None = None
    for start in _STARTS:
        guess = np.concatenate([np.log(start * spread), np.full(OSCILLATORS, 0.6)])
        found = task.realised(least_squares(task.missed, guess, bounds=(low, high), max_nfev=100).x)
        if best is None or found.error < best.error:
            best = found
        if best.error < ENOUGH:
            break
    assert best is not None
    return best


@dataclass(frozen=True, eq=False)
class _Task:
    """What is to be met along one axis; p are log w_i and z_i of the oscillators."""

    omega: Floats
    """With 0 before the frequencies of the coefficients, shape (k,)."""
    arriving: Complex
    """Signals of waves of elevation 1 that travel to the right, shape (k, s)."""
    signals: Floats
    target: Complex
    """X by `size`, shape (k,)."""
    size: float
    """[N/m]"""

    @classmethod
    def of(cls, body: Hydrodynamics, points: Floats, axis: int) -> _Task:
        # Waves of no end lift the water as a whole: buoyancy answers up, where y is down.
        target = np.append(-body.stiffness[axis] + 0j, body.excitation[:, axis])
        wavenumber = np.append(0.0, body.wavenumber)
        signals, size = signals_of(points, axis), float(np.max(np.abs(target)))
        arriving = np.exp(-1j * wavenumber[:, None] * points) @ signals.T
        target = np.asarray(target / (size or 1.0), dtype=complex)
        return cls(np.append(0.0, body.omega), np.asarray(arriving, dtype=complex), signals, target, size)

    def gains(self, p: Floats) -> tuple[Floats, Floats]:
        """Best gains, shape (2 m s,), with these oscillators, and what is missed with them."""
        states = responses(np.exp(p[:OSCILLATORS]), p[OSCILLATORS:], self.omega)
        columns = (states[:, None, :] * self.arriving[:, :, None]).reshape(len(self.omega), -1)
        count, weight = columns.shape[1], np.ones((len(self.omega), 1))
        weight[0] = LONG_WAVES
        columns, wanted = weight * columns, weight[:, 0] * self.target
        matrix = np.vstack([columns.real, columns.imag, MODEST * np.eye(count)])
        aim = np.concatenate([wanted.real, wanted.imag, np.zeros(count)])
        found = np.linalg.lstsq(matrix, aim, rcond=None)[0]
        return found, matrix @ found - aim

    def missed(self, p: Floats) -> Floats:
        return self.gains(p)[1]

    def realised(self, p: Floats) -> Excitation:
        """Oscillators transposed, so that they share one output: g (s - A)^-1 b = b (s - A')^-1 g."""
        w, z = np.exp(p[:OSCILLATORS]), p[OSCILLATORS:]
        matrix, entry = state_space(w, z)
        elevations = self.gains(p)[0].reshape(len(self.signals), -1).T
        made = np.sum(responses(w, z, self.omega) @ elevations * self.arriving, axis=1)
        error = float(np.max(np.abs(made - self.target)))
        return Excitation(matrix.T, elevations, self.signals, entry * self.size, error)
