"""Linear filters made of damped oscillators side by side, which are stable whatever their numbers are.

Oscillator i has x' = w_i [[0, 1], [-1, -2 z_i]] x + [0, w_i] u, with w_i > 0 [rad/s] and 0 < z_i < 1.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.linalg import block_diag

from ..cable import Floats

__all__ = ["LARGEST_RATIO", "SMALLEST_RATIO", "responses", "state_space"]

SMALLEST_RATIO, LARGEST_RATIO = 0.15, 0.98
"""Of damping, z: sharper resonances are of irregular frequencies, not of a body; 1 would be a double pole."""


def responses(w: Floats, z: Floats, omega: Floats) -> npt.NDArray[np.complex128]:
    """Frequency response of every state, shape (k, 2 m), of m oscillators at k frequencies."""
    s = 1j * omega[:, None]
    below = s * s + 2.0 * z * w * s + w * w
    return np.stack([w * w / below, s * w / below], axis=-1).reshape(len(omega), -1)


def state_space(w: Floats, z: Floats) -> tuple[Floats, Floats]:
    """State matrix (2 m, 2 m) and input (2 m,) of m oscillators."""
    matrices = [np.array([[0.0, a], [-a, -2.0 * a * b]]) for a, b in zip(w, z, strict=True)]
    return np.asarray(block_diag(*matrices)), np.ravel([[0.0, a] for a in w])
