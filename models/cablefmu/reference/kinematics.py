"""Where the chain is and how it moves [2.10-2.17].

e_i = (sin th_i, cos th_i) points down link i, n_i = de_i/dth_i = (cos th_i, -sin th_i) across it. With
P_0 = (x_m, y_m) and P_i = P_{i-1} + l_i e_i, a link's centre is the mean of its two ends, and so are its
velocity and acceleration. Of P_0 a floater that only heaves keeps x_m = 0; where its motion is given, both
are inputs.

Erratum [2.17] (L2, L4): the print's inner sums run to n - 1 and end with l_n, which puts every centre
at the last link's; they run to i - 1 and end with l_i.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from cablefmu.cable import Top
from cablefmu.reference.chain import Array, Chain, Number

__all__ = ["Motion", "Port", "accelerations", "centres", "given_port", "motion_of", "points", "velocities"]

NOTHING: Mapping[str, Number] = MappingProxyType({})


@dataclass(frozen=True)
class Port:
    """How an end of the cable moves; arrays of shape (2,), x first."""

    position: Array
    """[m]"""
    velocity: Array
    """[m/s]"""
    acceleration: Array
    """[m/s^2]; of P_0 the part that is given, zero where it is an unknown"""


def given_port(port: int, inputs: Mapping[str, Number], rest: Array | tuple[float, float] = (0.0, 0.0)) -> Port:
    """The motion x_p ... ay_p that the inputs give to end `port`, 1 or 2; at `rest` [m] where they say nothing."""

    def pair(kind: str, x: Number, y: Number) -> Array:
        return np.array([inputs.get(f"{kind}x_{port}", x), inputs.get(f"{kind}y_{port}", y)])

    return Port(pair("", *rest), pair("v", 0.0, 0.0), pair("a", 0.0, 0.0))


@dataclass(frozen=True)
class Motion:
    """A state (q, v), and what is given besides, with the sines and cosines that every equation needs."""

    q: Array
    """The unknowns' positions [m, rad], shape (coordinates,)"""
    v: Array
    """dq/dt [m/s, rad/s], likewise"""
    top: Port
    """P_0 = (x_m, y_m)"""
    inputs: Mapping[str, Number]
    """Inputs by name, those that give an end's motion among them"""
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
    *,
    top: Top = Top.FLOATER,
    inputs: Mapping[str, Number] = NOTHING,
) -> Motion:
    """The motion at q and v = dq/dt, each of shape (coordinates,) [m, rad; m/s, rad/s].

    `inputs` are needed where they give an end's motion; those that are forces do no harm.
    """
    given = given_port(1, inputs)
    whole_q, whole_v = _whole(top, q, given.position), _whole(top, v, given.velocity)
    place, speed = (whole[[-1, 0]] for whole in (whole_q, whole_v))
    theta = whole_q[1:-1]
    port = Port(place, speed, given.acceleration)
    return Motion(q, v, port, inputs, theta, whole_v[1:-1], sin(theta), cos(theta))


def points(chain: Chain, motion: Motion) -> Array:
    """P_0 ... P_n [m], shape (n + 1, 2)."""
    return _from_top(motion.top.position, chain.length[:, None] * motion.along)


def velocities(chain: Chain, motion: Motion) -> Array:
    """Velocities of P_0 ... P_n [m/s], shape (n + 1, 2); P_i' = P_{i-1}' + l_i th_i' n_i."""
    return _from_top(motion.top.velocity, (chain.length * motion.omega)[:, None] * motion.across)


def accelerations(chain: Chain, motion: Motion, acceleration: Array) -> Array:
    """Accelerations of P_0 ... P_n [m/s^2], shape (n + 1, 2), at q'' = `acceleration` (coordinates,).

    P_i'' = P_{i-1}'' + l_i (th_i'' n_i - th_i'^2 e_i)
    """
    whole = _whole(chain.top, acceleration, motion.top.acceleration)
    across = (chain.length * whole[1:-1])[:, None] * motion.across
    along = (chain.length * motion.omega**2)[:, None] * motion.along
    return _from_top(whole[[-1, 0]], across - along)


def centres(at_points: Array) -> Array:
    """Position, velocity or acceleration of the links' centres from that of the points, shape (n, 2)."""
    return (at_points[:-1] + at_points[1:]) / 2


def _whole(top: Top, own: Array, given: Array) -> Array:
    """(y_m, theta, x_m), shape (n + 2,), from the unknowns among them and what is `given` for P_0, shape (2,)."""
    above, behind = (given[[1]] if top is Top.MOTION else own[:0]), (own[:0] if top is Top.FREE else given[[0]])
    return np.concatenate([above, own, behind])


def _from_top(top: Array, steps: Array) -> Array:
    """Sum down the chain from P_0."""
    return np.cumsum(np.vstack([top, steps]), axis=0)
