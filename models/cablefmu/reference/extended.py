"""The same dense equation in as many digits as one likes, for ends too heavy for doubles.

An end of 8e8 kg leaves a dense solution in doubles seven good digits (docs/numerics.md); here nothing is lost.
The formulas are the float reference's, the numbers mpmath's; for numpy's long doubles see `long_double`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mpmath
import numpy as np

from cablefmu.cable import Cable, Floats
from cablefmu.reference.chain import Array, Chain, chain_of
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.long_double import long_double_acceleration, long_double_outputs
from cablefmu.reference.model import equation
from cablefmu.reference.outputs import effective_masses, output_values
from cablefmu.reference.terminal import TerminalRule

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
    """x'' from I x'' + C x' + K x + F + G + D = T with `digits` decimal digits.

    Doubles count as exact: q, v, inputs and parameters are taken to the last bit.

    Returns
    -------
    object array of `mpmath.mpf`, shape (coordinates,) [m/s^2, rad/s^2]
    """
    with mpmath.workdps(digits):
        chain, motion, forces = _exact(cable, q, v, inputs)
        return _solve(chain, motion, forces, terminal_rule)[0]


def extended_outputs(
    cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float], *, digits: int = 50
) -> dict[str, Any]:
    """The outputs of `Reference.outputs` with `digits` decimal digits, as `mpmath.mpf`."""

    def values(given: Mapping[str, float]) -> dict[str, Any]:
        chain, motion, forces = _exact(cable, q, v, given)
        acceleration, pin_force = _solve(chain, motion, forces, "virtual_work")
        return output_values(chain, motion, acceleration, forces, pin_force)

    with mpmath.workdps(digits):
        return values(inputs) | effective_masses(chain_of(cable, mpmath.mpf), values, inputs)


def _exact(cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float]) -> tuple[Chain, Motion, dict[str, Any]]:
    exact, sin, cos = (np.vectorize(f, otypes=[object]) for f in (mpmath.mpf, mpmath.sin, mpmath.cos))
    given = {name: mpmath.mpf(value) for name, value in inputs.items()}
    motion = motion_of(exact(q), exact(v), sin, cos, top=cable.top, inputs=given)
    return chain_of(cable, mpmath.mpf), motion, given


def _solve(chain: Chain, motion: Motion, inputs: Mapping[str, Any], rule: TerminalRule) -> tuple[Array, Array | None]:
    """x'', and the force on what holds P_n, if it is held."""
    held = chain.pin is not None
    matrix, right_side = equation(chain, motion, inputs, rule, outside=held)
    solution = mpmath.lu_solve(mpmath.matrix(matrix.tolist()), mpmath.matrix(right_side.tolist()))
    found = np.array(list(solution), dtype=object)
    return found[: chain.coordinates], found[chain.coordinates :] if held else None
