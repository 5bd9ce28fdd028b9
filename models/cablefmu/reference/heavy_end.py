"""The same equation with the end's inertia taken out of the matrix, for ends of 8e8 kg in doubles and for pins.

m_c stands in almost every element of I(x) and hides the cable behind it: a seabed anchor of 8e8 kg costs
nine of a double's sixteen digits, and an adaptive integrator then chases the rounding noise. Written
as I = I_0 + m_c J^T J, with P_n' = J v and I_0 the cable without its end, the inertia force
lambda = m_c P_n'' becomes an unknown of its own:

::

    [ I_0    J^T    ] [ x''    ]   [ right side with m_c = 0 in F ]
    [ J   -1/m_c    ] [ lambda ] = [ -J' v                        ]

Nothing in it grows with m_c. It is the print's [3.8], only bordered: eliminating lambda gives it back. With 0 for 1/m_c
it is the equation of a cable on a pin, lambda being the multiplier of the constraint; to the right side of its lower
half the acceleration is added that `pin` prescribes.
"""

from __future__ import annotations

import numpy as np

from cablefmu.reference.chain import Array, Chain, Number
from cablefmu.reference.kinematics import Motion
from cablefmu.reference.pin import pin_acceleration

__all__ = ["HEAVY", "bordered", "is_heavy", "solve_bordered"]

HEAVY = 1e3
"""End mass over the mass of all links from which the border is worth having."""


def is_heavy(chain: Chain) -> bool:
    """Whether the end outweighs the cable by `HEAVY`."""
    return bool(chain.end_mass > HEAVY * chain.mass.sum())


def bordered(chain: Chain, motion: Motion, light_inertia: Array, light_right_side: Array) -> tuple[Array, Array]:
    """Matrix and right side with lambda as an unknown, shapes (n + 3, n + 3) and (n + 3,).

    Parameters
    ----------
    chain, motion
        The chain with its end mass or its pin, and its motion.
    light_inertia, light_right_side
        I(x), shape (n + 1, n + 1), and T - (C x' + K x + F + G), shape (n + 1,), with m_c = 0 in I and F;
        its weight stays in G.
    """
    jacobian = _end_jacobian(chain, motion)
    centripetal = -(chain.length * motion.omega**2) @ motion.along
    if chain.pin is None:
        yielding, given = np.eye(2) / chain.end_mass, 0 * centripetal
    else:
        yielding, given = np.zeros((2, 2)), pin_acceleration(chain, motion, chain.pin)
    matrix = np.block([[light_inertia, jacobian.T], [jacobian, -yielding]])
    return matrix, np.concatenate([light_right_side, given - centripetal])


def solve_bordered(chain: Chain, motion: Motion, light_inertia: Array, light_right_side: Array) -> tuple[Array, Array]:
    """Accelerations and the end's inertia force, in doubles; arguments as for `bordered`.

    Returns
    -------
    x'', shape (n + 1,) [m/s^2, rad/s^2], and lambda = m_c P_n'', of a pin the force on it, shape (2,) [N]
    """
    solution = np.linalg.solve(*bordered(chain, motion, light_inertia, light_right_side))
    return solution[: chain.n + 1], solution[chain.n + 1 :]


def _end_jacobian(chain: Chain, motion: Motion) -> Array:
    """J of P_n' = J v, shape (2, n + 1): (0, 1) for the heave, l_i n_i for link i."""
    heave: list[Number] = [0.0, 1.0]
    return np.column_stack([heave, (chain.length[:, None] * motion.across).T])
