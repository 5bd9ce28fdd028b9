"""Normal drag of the links, "proportional to the square of the relative velocity" [Table 6.1]."""

from __future__ import annotations

import numpy as np

from cablefmu.reference.chain import Array, Chain, sum_below
from cablefmu.reference.kinematics import Motion, centres, velocities

__all__ = ["drag_forces", "drag_vector"]


def drag_forces(chain: Chain, motion: Motion) -> Array:
    """f_i = -c_v |v_n| v_n n_i at each link's centre, v_n = n_i . c_i', shape (n, 2) [N]; still water."""
    normal_velocity = np.sum(motion.across * centres(velocities(chain, motion)), axis=1)
    magnitude = -chain.drag * _size(normal_velocity) * normal_velocity
    forces: Array = magnitude[:, None] * motion.across
    return forces


def drag_vector(chain: Chain, motion: Motion) -> Array:
    """The drag's part of T by virtual work, shape (coordinates,) [N, N m].

    A force at centre k moves with the floater, with the half of link k and with every link above it:
    Q_1 = sum f_y, Q_i+1 = l_i n_i . (f_i/2 + sum_{k>i} f_k) and Q_x = sum f_x.
    """
    forces = drag_forces(chain, motion)
    felt = forces / 2 + sum_below(forces)
    links = chain.length * np.sum(motion.across * felt, axis=1)
    return chain.rows(forces[:, 1].sum(), links, forces[:, 0].sum())


def _size(numbers: Array) -> Array:
    """|v|, for complex numbers not their modulus but +-v: so a derivative by complex step passes through."""
    return np.where(numbers.real < 0, -numbers, numbers) if np.iscomplexobj(numbers) else abs(numbers)
