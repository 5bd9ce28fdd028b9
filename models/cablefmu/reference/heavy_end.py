"""The same equation with the end's inertia taken out of the matrix, for ends of 8e8 kg in doubles and for pins.

m_c stands in almost every element of I(x) and hides the cable behind it: a seabed anchor of 8e8 kg costs
nine of a double's sixteen digits, and an adaptive integrator then chases the rounding noise. Written
as I = I_0 + m_c J^T J, with P_n' = J v and I_0 the cable without its end, the inertia force
lambda = m_c P_n'' becomes an unknown of its own:

::

    [ I_0    J^T    ] [ x''    ]   [ right side with m_c = 0 in F ]
    [ J   -1/m_c    ] [ lambda ] = [ -J' v - a_0                  ]

a_0 is the acceleration of P_0 where that is given, else 0. Nothing in it grows with m_c. It is the print's [3.8], only
bordered: eliminating lambda gives it back. With 0 for 1/m_c it is the equation of a cable whose end a pin or a given
motion holds, lambda being the multiplier of the constraint; to the right side of its lower half the acceleration is
added that `pin` prescribes.
"""

from __future__ import annotations

import numpy as np

from cablefmu.reference.chain import Array, Chain
from cablefmu.reference.kinematics import Motion
from cablefmu.reference.pin import pin_acceleration

__all__ = ["HEAVY", "bordered", "is_heavy"]

HEAVY = 1e3
"""End mass over the mass of all links from which the border is worth having."""


def is_heavy(chain: Chain) -> bool:
    """Whether the end outweighs the cable by `HEAVY`."""
    return bool(chain.end_mass > HEAVY * chain.mass.sum())


def bordered(chain: Chain, motion: Motion, light_inertia: Array, light_right_side: Array) -> tuple[Array, Array]:
    """Matrix and right side with lambda as an unknown, shapes (m + 2, m + 2) and (m + 2,).

    Parameters
    ----------
    chain, motion
        The chain with its end mass or its pin, and its motion.
    light_inertia, light_right_side
        I(x), shape (m, m) with m = `chain.coordinates`, and T - (C x' + K x + F + G + D), shape (m,), with m_c = 0 in
        I, F and D; its weight stays in G.
    """
    jacobian = _end_jacobian(chain, motion)
    without = motion.top.acceleration - (chain.length * motion.omega**2) @ motion.along  # P_n'' at x'' = 0
    if chain.pin is None:
        yielding, given = np.eye(2) / chain.end_mass, 0 * without
    else:
        yielding, given = np.zeros((2, 2)), pin_acceleration(chain, motion, chain.pin)
    matrix = np.block([[light_inertia, jacobian.T], [jacobian, -yielding]])
    return matrix, np.concatenate([light_right_side, given - without])


def _end_jacobian(chain: Chain, motion: Motion) -> Array:
    """J of P_n' = J v, shape (2, m): (0, 1) for the heave, l_i n_i for link i, (1, 0) for the surge."""
    heave, surge = np.array([0.0, 1.0]), np.array([1.0, 0.0])
    return np.column_stack([heave, (chain.length[:, None] * motion.across).T, surge])[:, chain.own]
