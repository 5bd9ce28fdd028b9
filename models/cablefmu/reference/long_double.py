"""The dense equation in numpy's long doubles: three digits more than doubles on x86, quick for hundreds of links."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from cablefmu.cable import Cable
from cablefmu.reference.chain import Array, Chain, Number, chain_of
from cablefmu.reference.heavy_end import is_heavy
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.model import equation
from cablefmu.reference.outputs import effective_masses, output_values

__all__ = ["long_double_acceleration", "long_double_outputs"]


def long_double_acceleration(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> Array:
    """x'' in numpy's long double: three more digits than a double on x86, and quick enough for hundreds of links.

    An end that outweighs the cable stands outside the matrix (see `heavy_end`). Complex numbers pass through, as in
    `Reference.acceleration`.

    Returns
    -------
    array of `numpy.longdouble` or `numpy.clongdouble`, shape (coordinates,) [m/s^2, rad/s^2]
    """
    chain, motion, forces = _wide(cable, q, v, inputs)
    return _solve_wide(chain, motion, forces)[0]


def long_double_outputs(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> dict[str, Any]:
    """The outputs of `Reference.outputs` in long double, likewise."""

    def values(given: Mapping[str, Number]) -> dict[str, Any]:
        chain, motion, forces = _wide(cable, q, v, given)
        acceleration, end_force = _solve_wide(chain, motion, forces)
        return output_values(chain, motion, acceleration, forces, end_force)

    return values(inputs) | effective_masses(chain_of(cable, np.longdouble), values, inputs)


def _wide(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Number]) -> tuple[Chain, Motion, dict[str, Any]]:
    def widened(values: Any) -> Array:
        array = np.asarray(values)
        return array.astype(np.result_type(array, np.longdouble))

    given = {name: widened(value)[()] for name, value in inputs.items()}
    return chain_of(cable, np.longdouble), motion_of(widened(q), widened(v), top=cable.top, inputs=given), given


def _solve_wide(chain: Chain, motion: Motion, inputs: Mapping[str, Any]) -> tuple[Array, Array | None]:
    """x'', and m_c P_n'' or the force on what holds P_n where it is an unknown."""
    outside = chain.pin is not None or is_heavy(chain)
    found = _eliminated(*equation(chain, motion, inputs, outside=outside))
    return found[: chain.coordinates], found[chain.coordinates :] if outside else None


def _eliminated(matrix: Array, right_side: Array) -> Array:
    """Gauss without pivoting, which neither a positive definite matrix needs nor a border behind it, whose Schur
    complement -J I^-1 J^T - 1/m_c is negative definite; LAPACK has no long double."""
    A, b = np.column_stack([matrix, right_side]), np.empty_like(right_side)
    for k in range(len(b)):
        A[k + 1 :, k:] -= np.outer(A[k + 1 :, k] / A[k, k], A[k, k:])
    for k in reversed(range(len(b))):
        b[k] = (A[k, -1] - A[k, k + 1 : -1] @ b[k + 1 :]) / A[k, k]
    return b
