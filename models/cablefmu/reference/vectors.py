"""The vectors F(x, x') and G(x) of [3.8], algorithms 5.3 to 5.7, and what a top asks for whose motion is given."""

from __future__ import annotations

import numpy as np

from cablefmu.reference.chain import Array, Chain
from cablefmu.reference.kinematics import Motion
from cablefmu.reference.matrices import weights_of_pairs

__all__ = ["drive_vector", "gravity_vector", "velocity_vector"]


def velocity_vector(chain: Chain, motion: Motion) -> Array:
    """F(x, x') [5.3-5.5], shape (coordinates,) [N, N m]: what the turning links' centripetal pull does.

    ::

        F_1   = -sum_k mu_k l_k cos(th_k) th_k'^2
        F_i+1 = sum_{j != i} mu_max(i,j) l_i l_j sin(th_i - th_j) th_j'^2
        F_x   = -sum_k mu_k l_k sin(th_k) th_k'^2                          ours, of x_m
    """
    squares = motion.omega**2
    pull = chain.carried_mass * chain.length * squares
    sin_difference = np.outer(motion.sin, motion.cos) - np.outer(motion.cos, motion.sin)
    links = (weights_of_pairs(chain) * sin_difference) @ squares
    return chain.rows(-pull @ motion.cos, links, -pull @ motion.sin)


def gravity_vector(chain: Chain, motion: Motion) -> Array:
    """G(x) [5.6, 5.7], shape (coordinates,) [N, N m].

    ::

        G_1   = -(sum m^w + m_c^w) g + static_load
        G_i+1 = mu^w_i g l_i sin th_i
        G_x   = static_pull                                                ours, of x_m

    Notes
    -----
    [5.6] has G_1 = 0, Appendix A (A.1-A.3) has G_1 = -(sum m + m_c) g. Both hold, by what y_m = 0
    means: `static_load` is what the floater's buoyancy carries there. With the hanging cable's total
    submerged weight it gives [5.6], with 0 Appendix A.

    [5.7] has plain masses; in water only m^w carries weight. Its m_c g in all cases is an erratum, see
    `Chain.end_wet_mass`. So are the heights [2.8]: h_2 ... h_n and the first form of h_c count only
    l_i/2 (1 - cos th_i) for the links above; the whole link counts, as in [2.9].
    """
    heave = chain.static_load - (chain.wet_mass.sum() + chain.end_wet_mass) * chain.gravity
    links = chain.carried_wet_mass * chain.gravity * chain.length * motion.sin
    return chain.rows(heave, links, chain.static_pull)


def drive_vector(chain: Chain, motion: Motion) -> Array:
    """What the given acceleration a_0 of P_0 asks for, shape (coordinates,) [N, N m]; nothing of a floater.

    ::

        D_i+1 = I_i+1,1 a_0y + I_i+1,x a_0x = mu_i l_i n_i . a_0

    Rows 1 and x have none: both are unknowns, or neither is, or (a floater that heaves only) a_0 = 0.
    """
    links = chain.carried_mass * chain.length * (motion.across @ motion.top.acceleration)
    return chain.rows(0, links, 0)
