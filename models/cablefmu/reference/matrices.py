"""The matrices I(x), C and K of I(x) x'' + C x' + K x + F(x, x') + G(x) = T [3.8], algorithms 5.1, 5.2."""

from __future__ import annotations

import numpy as np

from cablefmu.reference.chain import Array, Chain, Number, sum_below
from cablefmu.reference.kinematics import Motion

__all__ = ["damping_matrix", "inertia_matrix", "stiffness_matrix", "weights_of_pairs"]


def inertia_matrix(chain: Chain, motion: Motion) -> Array:
    """I(x) [5.1] as corrected by Appendix A, shape (coordinates, coordinates) [kg, kg m, kg m^2].

    ::

        I_11         = M + m_c + sum m
        I_1,j+1      = -mu_j l_j sin th_j
        I_i+1,j+1    = mu_max(i,j) l_i l_j cos(th_i - th_j)
        I_i+1,i+1    = (m_i/4 + sum_{k>i} m_k + m_c) l_i^2 + I_Ri
        I_xx         = I_11,   I_x1 = 0,   I_x,j+1 = mu_j l_j cos th_j        ours, of x_m

    Notes
    -----
    Errata of [5.1]: every inner sum but that of I_11 starts at k = 1, it runs over the links *below*
    link j - 1; the off-diagonal uses m_i where m_{j-1} is meant; the diagonal uses I_Ri for
    i = 2 ... n + 1 where I_R(i-1) is meant.
    """
    inertia = np.zeros((chain.n + 2, chain.n + 2), dtype=np.result_type(chain.length, motion.sin))
    inertia[0, 0] = inertia[-1, -1] = chain.floater_mass + chain.mass.sum() + chain.end_mass
    inertia[0, 1:-1] = inertia[1:-1, 0] = -chain.carried_mass * chain.length * motion.sin
    inertia[-1, 1:-1] = inertia[1:-1, -1] = chain.carried_mass * chain.length * motion.cos
    # cos(th_i - th_j) from products: n sines instead of n^2
    cos_difference = np.outer(motion.cos, motion.cos) + np.outer(motion.sin, motion.sin)
    inertia[1:-1, 1:-1] = weights_of_pairs(chain) * cos_difference
    below = sum_below(chain.mass) + chain.end_mass
    np.fill_diagonal(inertia[1:-1, 1:-1], (chain.mass / 4 + below) * chain.length**2 + chain.inertia)
    return inertia[chain.own, chain.own]


def damping_matrix(chain: Chain) -> Array:
    """C [5.2], shape (coordinates, coordinates) [N s/m, N m s/rad]: c_m alone, then the joints' tridiagonal.

    Notes
    -----
    Erratum of [5.2]: executed literally, its loop resets a(j,i) after setting it, so that C and K come
    out upper triangular. Both are symmetric (Appendix A).
    """
    return _top_and_joints(chain, chain.floater_damping, chain.damping, chain.surge_damping)


def stiffness_matrix(chain: Chain) -> Array:
    """K [5.2], shape (coordinates, coordinates) [N/m, N m/rad], likewise.

    Notes
    -----
    Erratum: the energies [3.2], [3.3], [3.17], [3.18], [3.32], [3.33] lack the joint springs that K has,
    k_1 th_1^2/2 + sum k_i (th_i - th_{i-1})^2/2.
    """
    return _top_and_joints(chain, chain.floater_stiffness, chain.stiffness, chain.surge_stiffness)


def weights_of_pairs(chain: Chain) -> Array:
    """mu_max(i,j) l_i l_j [kg m^2], shape (n, n): what two links' angles have in common."""
    index = np.arange(chain.n)
    lower = np.maximum.outer(index, index)
    weights: Array = chain.carried_mass[lower] * np.outer(chain.length, chain.length)
    return weights


def _top_and_joints(chain: Chain, heave: Number, joint: Array, surge: Number) -> Array:
    """Joint 1 acts on th_1, joint i on th_i - th_{i-1}: c_i + c_{i+1} and -c_{i+1}."""
    matrix = np.zeros((chain.n + 2, chain.n + 2), dtype=joint.dtype)
    matrix[0, 0], matrix[-1, -1] = heave, surge
    link = np.arange(1, chain.n + 1)
    matrix[link, link] = joint
    matrix[link[:-1], link[:-1]] += joint[1:]
    matrix[link[:-1], link[1:]] = matrix[link[1:], link[:-1]] = -joint[1:]
    return matrix[chain.own, chain.own]
