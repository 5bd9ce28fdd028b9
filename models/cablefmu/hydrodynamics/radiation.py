"""The memory of radiated waves as a state space: stable and passive by construction.

Cummins: the force of radiated waves is -(A_infinity q'' + int K(t - s) q'(s) ds), with K(j w) = B(w) + j w (A(w) -
A_infinity). Radiation only takes energy away: Re K = B >= 0, and nothing at frequency 0. A filter W that is stable
and has W(0) = 0 is fitted, with

    K(s) + K(-s) = W(s) W(-s),   so that   Re K(j w) = |W(j w)|^2 / 2   and   K(0) = 0,

whatever its numbers are. With W = C (s - A)^-1 B and A P + P A' + B B' = 0, K = C (s - A)^-1 P C'.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_continuous_lyapunov
from scipy.optimize import least_squares

from ..cable import Floats
from .blocks import LARGEST_RATIO, SMALLEST_RATIO, state_space

__all__ = ["Radiation", "fit_radiation"]

ENOUGH = 0.005
"""Error of a fit that needs no more states, of the curve's largest value."""
MOST_OSCILLATORS = 5
_STARTS = 3
_WIDEST = 30.0
"""Oscillators lie at most this factor beyond the frequencies that are known."""

Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Radiation:
    """r' = matrix r + velocity q', force = -output r."""

    matrix: Floats
    """Shape (n, n) [1/s]."""
    velocity: Floats
    """Shape (n,) [N/m]."""
    output: Floats
    """Shape (n,), of length 1."""
    error: float
    """Largest |K - fit| of all frequencies, of the largest |K|."""

    def response(self, omega: Floats) -> Complex:
        """K(j omega), shape (k,) [N s/m]."""
        identity = np.eye(len(self.output))
        return np.array([self.output @ np.linalg.solve(1j * w * identity - self.matrix, self.velocity) for w in omega])


def fit_radiation(omega: Floats, memory: Complex) -> Radiation:
    """Fit K along one axis, with as few states as are enough.

    Parameters
    ----------
    omega
        Angular frequencies, shape (k,) [rad/s].
    memory
        K(j omega), shape (k,) [N s/m].
    """
    size = float(np.max(np.abs(memory)))
    if size == 0.0:
        return Radiation(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 0.0)
    best: Radiation | None = None
    for count in range(1, MOST_OSCILLATORS + 1):
        for start in range(_STARTS):
            found = _fitted(omega, memory, size, count, start)
            if best is None or found.error < best.error:
                best = found
            if best.error < ENOUGH:
                return best
    assert best is not None
    return best


def _fitted(omega: Floats, memory: Complex, size: float, count: int, start: int) -> Radiation:
    peak = omega[np.argmax(memory.real)]

    def unpack(p: Floats) -> tuple[Floats, Floats, Floats]:
        """Frequencies, damping ratios, and output of W with W(0) = 0."""
        place = np.append(p[2 * count : 3 * count - 1], -np.sum(p[2 * count : 3 * count - 1]))
        return np.exp(p[:count]), p[count : 2 * count], np.stack([place, p[3 * count - 1 :]], axis=-1).ravel()

    def missed(p: Floats) -> Floats:
        off = _causal_part(*unpack(p), omega) - memory / size
        return np.concatenate([off.real, off.imag])

    rng = np.random.default_rng(start)
    w = peak * np.geomspace(0.5, 2.0, count) if count > 1 else np.array([peak])
    guess = np.concatenate([np.log(w), np.full(count, 0.4), 0.5 * rng.normal(size=2 * count - 1)])
    low = np.concatenate([
        np.full(count, np.log(omega[0] / _WIDEST)), np.full(count, SMALLEST_RATIO), np.full(2 * count - 1, -np.inf)
    ])  # fmt: skip
    high = np.concatenate([
        np.full(count, np.log(omega[-1] * _WIDEST)), np.full(count, LARGEST_RATIO), np.full(2 * count - 1, np.inf)
    ])  # fmt: skip
    w, z, output = unpack(least_squares(missed, guess, bounds=(low, high), max_nfev=300).x)
    return _realised(w, z, output * np.sqrt(size), omega, memory)


def _causal_part(w: Floats, z: Floats, output: Floats, omega: Floats) -> Complex:
    """K(j omega) by partial fractions: with W = sum r_i/(s - p_i), K = sum r_i W(-p_i)/(s - p_i)."""
    turned = w * np.sqrt(1.0 - z * z)
    above = -z * w + 1j * turned
    place, rate = output[::2], output[1::2]
    poles = np.concatenate([above, above.conj()])
    residue = (w * w * place + w * rate * above) / (2j * turned)
    residues = np.concatenate([residue, residue.conj()])
    opposite = np.sum(residues / (-poles[:, None] - poles), axis=1)  # W(-p_i)
    return np.asarray((residues * opposite / (1j * omega[:, None] - poles)).sum(axis=1))


def _realised(w: Floats, z: Floats, output: Floats, omega: Floats, memory: Complex) -> Radiation:
    matrix, entry = state_space(w, z)
    gramian = solve_continuous_lyapunov(matrix, -np.outer(entry, entry))
    length = float(np.linalg.norm(output))
    made = Radiation(matrix, gramian @ output * length, output / length, 0.0)
    error = np.max(np.abs(made.response(omega) - memory)) / np.max(np.abs(memory))
    return replace(made, error=float(error))
