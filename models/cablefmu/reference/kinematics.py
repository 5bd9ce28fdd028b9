"""Where the chain is and how it moves [2.10-2.17].

e_i = (sin th_i, cos th_i) points down link i, n_i = de_i/dth_i = (cos th_i, -sin th_i) across it. With
P_0 = (0, y_m) and P_i = P_{i-1} + l_i e_i, a link's centre is the mean of its two ends, and so are its
velocity and acceleration.

Erratum [2.17] (L2, L4): the print's inner sums run to n - 1 and end with l_n, which puts every centre
at the last link's; they run to i - 1 and end with l_i.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cablefmu.reference.chain import Array, Chain, Number

__all__ = ["Motion", "accelerations", "centres", "motion_of", "points", "velocities"]


@dataclass(frozen=True)
class Motion:
    """A state (q, v) with the sines and cosines that every equation needs."""

    heave: Number
    """y_m [m]"""
    heave_rate: Number
    """y_m' [m/s]"""
    theta: Array
    """th_i [rad], shape (n,)"""
    omega: Array
    """th_i' [rad/s], shape (n,)"""
    sin: Array
    """sin th_i, shape (n,)"""
    cos: Array
    """cos th_i, shape (n,)"""

    @property
    def along(self) -> Array:
        """e_i, shape (n, 2)"""
        return np.stack([self.sin, self.cos], axis=1)

    @property
    def across(self) -> Array:
        """n_i, shape (n, 2)"""
        return np.stack([self.cos, -self.sin], axis=1)


def motion_of(
    q: Array,
    v: Array,
    sin: Callable[[Array], Array] = np.sin,
    cos: Callable[[Array], Array] = np.cos,
) -> Motion:
    """The motion at q = (y_m, theta) and v = dq/dt, each of shape (n + 1,) [m, rad; m/s, rad/s]."""
    return Motion(q[0], v[0], q[1:], v[1:], sin(q[1:]), cos(q[1:]))


def points(chain: Chain, motion: Motion) -> Array:
    """P_0 ... P_n [m], shape (n + 1, 2)."""
    return _from_top(motion.heave, chain.length[:, None] * motion.along)


def velocities(chain: Chain, motion: Motion) -> Array:
    """Velocities of P_0 ... P_n [m/s], shape (n + 1, 2); P_i' = P_{i-1}' + l_i th_i' n_i."""
    return _from_top(motion.heave_rate, (chain.length * motion.omega)[:, None] * motion.across)


def accelerations(chain: Chain, motion: Motion, acceleration: Array) -> Array:
    """Accelerations of P_0 ... P_n [m/s^2], shape (n + 1, 2), at q'' = `acceleration` (n + 1,).

    P_i'' = P_{i-1}'' + l_i (th_i'' n_i - th_i'^2 e_i)
    """
    across = (chain.length * acceleration[1:])[:, None] * motion.across
    along = (chain.length * motion.omega**2)[:, None] * motion.along
    return _from_top(acceleration[0], across - along)


def centres(at_points: Array) -> Array:
    """Position, velocity or acceleration of the links' centres from that of the points, shape (n, 2)."""
    return (at_points[:-1] + at_points[1:]) / 2


def _from_top(vertical: Number, steps: Array) -> Array:
    """Sum down the chain from P_0, which moves vertically only."""
    return np.cumsum(np.vstack([np.array([0 * vertical, vertical]), steps]), axis=0)
