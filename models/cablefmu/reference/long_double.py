"""The dense equation in numpy's long doubles: three digits more than doubles on x86, quick for hundreds of links."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cablefmu.cable import Cable
from cablefmu.reference.chain import Array, Chain, Number, chain_of
from cablefmu.reference.heavy_end import bordered, is_heavy
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.matrices import damping_matrix, inertia_matrix, stiffness_matrix
from cablefmu.reference.model import generalised_forces
from cablefmu.reference.outputs import output_values
from cablefmu.reference.terminal import TerminalRule
from cablefmu.reference.vectors import gravity_vector, velocity_vector

__all__ = ["equation", "long_double_acceleration", "long_double_outputs"]


def long_double_acceleration(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> Array:
    """x'' in numpy's long double: three more digits than a double on x86, and quick enough for hundreds of links.

    An end that outweighs the cable stands outside the matrix (see `heavy_end`). Complex numbers pass through, as in
    `Reference.acceleration`.

    Returns
    -------
    array of `numpy.longdouble` or `numpy.clongdouble`, shape (n + 1,) [m/s^2, rad/s^2]
    """
    chain, motion, forces = _wide(cable, q, v, inputs)
    return _solve_wide(chain, motion, forces)[0]


def long_double_outputs(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> dict[str, Any]:
    """The outputs of `outputs.output_values` in long double, likewise."""
    chain, motion, forces = _wide(cable, q, v, inputs)
    acceleration, end_force = _solve_wide(chain, motion, forces)
    return output_values(chain, motion, acceleration, forces, end_force)


def equation(chain: Chain, motion: Motion, inputs: Mapping[str, Any], rule: TerminalRule) -> tuple[Array, Array]:
    """I and T - (C x' + K x + F + G), with a pin inside its border."""
    q = np.concatenate([[motion.heave], motion.theta])
    v = np.concatenate([[motion.heave_rate], motion.omega])
    T = generalised_forces(chain, motion, inputs, rule)
    F, G = velocity_vector(chain, motion), gravity_vector(chain, motion)
    inertia = inertia_matrix(chain, motion)
    right_side = T - (damping_matrix(chain) @ v + stiffness_matrix(chain) @ q + F + G)
    return (inertia, right_side) if chain.pin is None else bordered(chain, motion, inertia, right_side)


def _wide(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> tuple[Chain, Motion, dict[str, Any]]:
    def widened(values: Any) -> Array:
        array = np.asarray(values)
        return array.astype(np.result_type(array, np.longdouble))

    motion = motion_of(widened(q), widened(v))
    return chain_of(cable, np.longdouble), motion, {name: widened(value)[()] for name, value in inputs.items()}


def _solve_wide(chain: Chain, motion: Motion, inputs: Mapping[str, Any]) -> tuple[Array, Array | None]:
    """x'', and m_c P_n'' or the force on a pin where it is an unknown."""
    outside = chain.pin is None and is_heavy(chain)
    light = replace(chain, end_mass=0 * chain.end_mass) if outside else chain
    matrix, right_side = equation(light, motion, inputs, "virtual_work")
    if outside:
        matrix, right_side = bordered(chain, motion, matrix, right_side)
    found = _eliminated(matrix, right_side)
    return found[: chain.n + 1], found[chain.n + 1 :] if len(found) > chain.n + 1 else None


def _eliminated(matrix: Array, right_side: Array) -> Array:
    """Gauss without pivoting, which neither a positive definite matrix needs nor a border behind it, whose Schur
    complement -J I^-1 J^T - 1/m_c is negative definite; LAPACK has no long double."""
    A, b = np.column_stack([matrix, right_side]), np.empty_like(right_side)
    for k in range(len(b)):
        A[k + 1 :, k:] -= np.outer(A[k + 1 :, k] / A[k, k], A[k, k:])
    for k in reversed(range(len(b))):
        b[k] = (A[k, -1] - A[k, k + 1 : -1] @ b[k + 1 :]) / A[k, k]
    return b
