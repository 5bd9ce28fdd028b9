"""What acts at the lower port P_n and how it reaches the coordinates, algorithms 5.8 to 5.10.

Two rules. *Virtual work* is exact: Q_1 = F_y, Q_i+1 = l_i F . n_i, Q_x = F_x. The *projected* rule is the
dissertation's own [4.7-4.34, 5.8-5.10], kept here to measure how far it departs; it is not
conservative, and its torques on the links above the last reverse under compression.

Errata of [5.8]-[5.10], [4.9], [4.17], [4.35], [4.41], all settled by virtual work:

- F_m2 has no formula; the projected rule below reads it as -F, F the force on the terminal (with +F a
  pull to the right would move the load left);
- torques are taken about k = i x j, which points into the page when Y is down, while theta grows the
  other way;
- the whole vector F is scaled by cos(alpha) where its projection on the link is meant;
- no vertical force reaches floater 1;
- T_e(n+1) = tau_n is never assigned, and T_e(i+1) = tau_i overwrites tau_mi where [4.41] adds.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from cablefmu.reference.chain import Array, Chain, Number
from cablefmu.reference.kinematics import Motion, points, velocities

__all__ = ["TerminalRule", "departure", "projected", "terminal_force", "terminal_vector", "virtual_work"]

TerminalRule = Literal["virtual_work", "projected"]


def terminal_force(chain: Chain, motion: Motion, inputs: Mapping[str, Number]) -> Array:
    """F on the terminal besides its weight, shape (2,) [N]: inputs, spring-dampers, preload."""
    springs = chain.end_springs
    position, velocity = points(chain, motion)[-1], velocities(chain, motion)[-1]
    external = np.array([inputs.get("F_cx", 0.0), inputs.get("F_cy", 0.0) + inputs.get("u_m2", 0.0)])
    force: Array = (
        external + springs.preload - springs.stiffness * (position - springs.rest) - springs.damping * velocity
    )
    return force


def terminal_vector(chain: Chain, motion: Motion, force: Array, rule: TerminalRule) -> Array:
    """The terminal force's part of T, shape (coordinates,) [N, N m]."""
    return virtual_work(chain, motion, force) if rule == "virtual_work" else projected(chain, motion, force)


def virtual_work(chain: Chain, motion: Motion, force: Array) -> Array:
    """Q_1 = F_y, Q_i+1 = l_i F . n_i = l_i (F_x cos th_i - F_y sin th_i), Q_x = F_x, shape (coordinates,) [N, N m]."""
    return chain.rows(force[1], _torques(chain, motion, force), force[0])


def projected(chain: Chain, motion: Motion, force: Array) -> Array:
    """The dissertation's rule [5.8-5.10] with F_m2 = -F, shape (coordinates,) [N, N m].

    ::

        tau_n = l_n F . n_n
        tau_i = ca prod_{j=i+1}^{n-1} cos(th_{j+1} - th_j)  l_i F . n_i,   i < n
        ca    = F . e_n / |F|  (0 if F = 0),  nothing on floater 1
    """
    size = np.sum(force**2) ** 0.5
    cos_alpha = motion.along[-1] @ force / size if size else size
    cos_joint = motion.cos[1:] * motion.cos[:-1] + motion.sin[1:] * motion.sin[:-1]
    factor = np.ones_like(motion.theta)
    # the product is over the joints strictly below link i + 1, hence empty for the last two links
    factor[:-2] = np.cumprod(cos_joint[:0:-1])[::-1]
    factor[:-1] *= cos_alpha
    return chain.rows(0 * size, factor * _torques(chain, motion, force), 0 * size)


def departure(chain: Chain, motion: Motion, force: Array) -> Array:
    """Projected less virtual work, shape (coordinates,) [N, N m]: the print's error in each row of T."""
    difference: Array = projected(chain, motion, force) - virtual_work(chain, motion, force)
    return difference


def _torques(chain: Chain, motion: Motion, force: Array) -> Array:
    """l_i F . n_i, shape (n,) [N m]"""
    torques: Array = chain.length * (motion.across @ force)
    return torques
