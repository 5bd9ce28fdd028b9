"""The pin, a holonomic constraint on P_n, and what keeps it where it is; likewise an end whose motion is given.

Its force is the multiplier of the border that `heavy_end` puts around the equation, with nothing behind it that
gives way. Differentiated twice, the constraint P_n = P_pin prescribes P_n'' = 0. This is all that x'' can obey:
a host that integrates the FMU in Model Exchange drifts off P_pin by what the errors at its own tolerance add up to,
and nothing would bring it back. So P_n'' is not 0 but brings P_n back without swinging (J. Baumgarte, Comput. Methods
Appl. Mech. Eng. 1 (1972) 1-16):

::

    P_n'' = -2 w V_n - w^2 (P_n - P_pin)       so that P_n - P_pin = (a + b t) exp(-w t) whatever the cable does

It does nothing to a motion that keeps the constraint. A given motion (p_2, v_2, a_2) of P_n is a pin that moves, and
brings back a state that disagrees with it likewise:

::

    P_n'' = a_2 - 2 w (V_n - v_2) - w^2 (P_n - p_2)
"""

from __future__ import annotations

from cablefmu.reference.chain import Array, Chain
from cablefmu.reference.kinematics import Motion, given_port, points, velocities

__all__ = ["PIN_RATE", "pin_acceleration"]

PIN_RATE = 10.0
"""w [1/s], a constant of the model: slow beside the cable, so that it makes nothing stiff; fast beside drift."""


def pin_acceleration(chain: Chain, motion: Motion, pin: Array) -> Array:
    """P_n'' at a pin at `pin` [m], or where the inputs give P_n's motion, shape (2,) [m/s^2]."""
    given = given_port(2, motion.inputs, pin)
    drift, slip = points(chain, motion)[-1] - given.position, velocities(chain, motion)[-1] - given.velocity
    acceleration: Array = given.acceleration - 2 * PIN_RATE * slip - PIN_RATE**2 * drift
    return acceleration
