"""The same dense equation in as many digits as one likes, for ends too heavy for doubles.

An end of 8e8 kg leaves a dense solution in doubles seven good digits (docs/numerics.md); here nothing is lost.
The formulas are the float reference's, the numbers mpmath's or numpy's long doubles.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np

from cablefmu.cable import Cable, Floats
from cablefmu.reference.chain import Array, Chain, Number, chain_of
from cablefmu.reference.heavy_end import bordered, is_heavy
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.matrices import damping_matrix, inertia_matrix, stiffness_matrix
from cablefmu.reference.model import generalised_forces
from cablefmu.reference.outputs import output_values
from cablefmu.reference.terminal import TerminalRule
from cablefmu.reference.vectors import gravity_vector, velocity_vector

__all__ = ["extended_acceleration", "extended_outputs", "long_double_acceleration", "long_double_outputs"]


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
        return _solve(chain, motion, forces, terminal_rule)[0]


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


def extended_outputs(
    cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float], *, digits: int = 50
) -> dict[str, Any]:
    """The outputs of `outputs.output_values` with `digits` decimal digits, as `mpmath.mpf`."""
    with mpmath.workdps(digits):
        chain, motion, forces = _exact(cable, q, v, inputs)
        acceleration, pin_force = _solve(chain, motion, forces, "virtual_work")
        return output_values(chain, motion, acceleration, forces, pin_force)


def _exact(cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float]) -> tuple[Chain, Motion, dict[str, Any]]:
    exact, sin, cos = (np.vectorize(f, otypes=[object]) for f in (mpmath.mpf, mpmath.sin, mpmath.cos))
    motion = motion_of(exact(q), exact(v), sin, cos)
    return chain_of(cable, mpmath.mpf), motion, {name: mpmath.mpf(value) for name, value in inputs.items()}


def _wide(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> tuple[Chain, Motion, dict[str, Any]]:
    def widened(values: Any) -> Array:
        array = np.asarray(values)
        return array.astype(np.result_type(array, np.longdouble))

    motion = motion_of(widened(q), widened(v))
    return chain_of(cable, np.longdouble), motion, {name: widened(value)[()] for name, value in inputs.items()}


def _equation(chain: Chain, motion: Motion, inputs: Mapping[str, Any], rule: TerminalRule) -> tuple[Array, Array]:
    """I and T - (C x' + K x + F + G), with a pin inside its border."""
    q = np.concatenate([[motion.heave], motion.theta])
    v = np.concatenate([[motion.heave_rate], motion.omega])
    T = generalised_forces(chain, motion, inputs, rule)
    F, G = velocity_vector(chain, motion), gravity_vector(chain, motion)
    inertia = inertia_matrix(chain, motion)
    right_side = T - (damping_matrix(chain) @ v + stiffness_matrix(chain) @ q + F + G)
    return (inertia, right_side) if chain.pin is None else bordered(chain, motion, inertia, right_side)


def _solve(chain: Chain, motion: Motion, inputs: Mapping[str, Any], rule: TerminalRule) -> tuple[Array, Array | None]:
    """x'', and the force on a pin if there is one."""
    matrix, right_side = _equation(chain, motion, inputs, rule)
    solution = mpmath.lu_solve(mpmath.matrix(matrix.tolist()), mpmath.matrix(right_side.tolist()))
    found = np.array(list(solution), dtype=object)
    return found[: chain.n + 1], None if chain.pin is None else found[chain.n + 1 :]


def _solve_wide(chain: Chain, motion: Motion, inputs: Mapping[str, Any]) -> tuple[Array, Array | None]:
    """x'', and m_c P_n'' or the force on a pin where it is an unknown."""
    outside = chain.pin is None and is_heavy(chain)
    light = replace(chain, end_mass=0 * chain.end_mass) if outside else chain
    matrix, right_side = _equation(light, motion, inputs, "virtual_work")
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
