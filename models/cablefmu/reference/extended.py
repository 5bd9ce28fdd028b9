"""The same dense equation in as many digits as one likes, for ends too heavy for doubles.

An end of 8e8 kg leaves the accelerations of a 60 m chain about eight good digits in double precision,
whatever the algorithm; here nothing is lost. The formulas are the float reference's, the numbers mpmath's.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mpmath
import numpy as np

from cablefmu.cable import Cable, Floats
from cablefmu.reference.chain import Array, Chain, chain_of
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.matrices import damping_matrix, inertia_matrix, stiffness_matrix
from cablefmu.reference.model import generalised_forces
from cablefmu.reference.outputs import output_values
from cablefmu.reference.terminal import TerminalRule
from cablefmu.reference.vectors import gravity_vector, velocity_vector

__all__ = ["extended_acceleration", "extended_outputs"]


def extended_acceleration(
    cable: Cable,
    q: Floats,
    v: Floats,
    inputs: Mapping[str, float],
    *,
    digits: int = 50,
    terminal_rule: TerminalRule = "virtual_work",
) -> Array:
    """x'' from I x'' + C x' + K x + F + G = T with `digits` decimal digits.

    Doubles count as exact: q, v, inputs and parameters are taken to the last bit.

    Returns
    -------
    object array of `mpmath.mpf`, shape (n + 1,) [m/s^2, rad/s^2]
    """
    with mpmath.workdps(digits):
        chain, motion, forces = _exact(cable, q, v, inputs)
        return _solve(chain, motion, forces, terminal_rule)


def extended_outputs(
    cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float], *, digits: int = 50
) -> dict[str, Any]:
    """The outputs of `outputs.output_values` with `digits` decimal digits, as `mpmath.mpf`."""
    with mpmath.workdps(digits):
        chain, motion, forces = _exact(cable, q, v, inputs)
        acceleration = _solve(chain, motion, forces, "virtual_work")
        return output_values(chain, motion, acceleration, forces)


def _exact(cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float]) -> tuple[Chain, Motion, dict[str, Any]]:
    exact, sin, cos = (np.vectorize(f, otypes=[object]) for f in (mpmath.mpf, mpmath.sin, mpmath.cos))
    motion = motion_of(exact(q), exact(v), sin, cos)
    return chain_of(cable, mpmath.mpf), motion, {name: mpmath.mpf(value) for name, value in inputs.items()}


def _solve(chain: Chain, motion: Motion, inputs: Mapping[str, Any], rule: TerminalRule) -> Array:
    q = np.concatenate([[motion.heave], motion.theta])
    v = np.concatenate([[motion.heave_rate], motion.omega])
    T = generalised_forces(chain, motion, inputs, rule)
    F, G = velocity_vector(chain, motion), gravity_vector(chain, motion)
    right_side = T - (damping_matrix(chain) @ v + stiffness_matrix(chain) @ q + F + G)
    inertia = mpmath.matrix(inertia_matrix(chain, motion).tolist())
    return np.array(list(mpmath.lu_solve(inertia, mpmath.matrix(right_side.tolist()))), dtype=object)
