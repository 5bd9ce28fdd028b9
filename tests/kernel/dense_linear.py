"""The linearised chain as a dense matrix, by complex step of the reference's equation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from cablefmu.cable import Cable, Floats
from cablefmu.reference.chain import Array, chain_of
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.model import equation

__all__ = ["BORDERED", "DenseLinear"]

STEP = np.longdouble(1e-30)
BORDERED = 1e2
"""End mass over the mass of all links from which the kernel has the force through the end as an unknown."""


@dataclass(frozen=True)
class DenseLinear:
    """w_q ID_q + w_v ID_v + w_a ID_a about a motion; with the border of `heavy_end` behind a heavy end or a pin.

    The border's rows are P_n'' = lambda/m_c, of a pin P_n'' = -2 w V_n - w^2 (P_n - P_pin), linearised likewise.
    """

    cable: Cable
    matrix: Array
    """In long double, shape (m, m) with m coordinates, or (m + 2, m + 2) with a border"""

    @classmethod
    def about(
        cls, cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float], weights: tuple[float, float, float]
    ) -> DenseLinear:
        """Linearised about the motion that the equation gives at (q, v)."""
        half, has_border = cable.coordinates, is_bordered(cable)
        wide_q, wide_v = q.astype(np.longdouble), v.astype(np.longdouble)
        inertia, right_side = _equation(cable, wide_q, wide_v, inputs)
        size = half + 2 * has_border
        a = np.zeros(size, dtype=np.longdouble)
        _refine(inertia, right_side, a)
        columns = []
        for one in np.eye(half):
            step_q, step_v, step_a = (1j * STEP * np.longdouble(weight) * one for weight in weights)
            inertia_there, right_side_there = _equation(cable, wide_q + step_q, wide_v + step_v, inputs)
            there = a + np.concatenate([step_a, np.zeros(size - half)])
            columns.append((inertia_there @ there - right_side_there).imag / STEP)
        return cls(cable, np.column_stack([*columns, inertia[:, half:]]))

    @property
    def has_border(self) -> bool:
        """Whether the force through the end is an unknown."""
        return len(self.matrix) > self.cable.coordinates

    def solved(self, force: Floats, end: Floats) -> Floats:
        """change of L change = force, the relation at a border being off by `end`, shape (m,)."""
        right_side = np.concatenate([force, end]) if self.has_border else force
        found = np.zeros(len(right_side), dtype=np.longdouble)
        _refine(self.matrix, right_side.astype(np.longdouble), found)
        return found[: self.cable.coordinates].astype(float)

    def free(self) -> Floats:
        """The matrix of what is left to move: projected to the changes that leave P_n where a pin holds it."""
        half = self.cable.coordinates
        inner = self.matrix[:half, :half].astype(float)
        if not self.has_border:
            return inner
        basis = scipy.linalg.null_space(self.matrix[:half, half:].T.astype(float))
        projected: Floats = basis.T @ inner @ basis
        return projected


def is_bordered(cable: Cable) -> bool:
    """Whether the kernel borders this cable's end."""
    chain = chain_of(cable)
    return chain.pin is not None or bool(chain.end_mass > BORDERED * chain.mass.sum())


def _equation(cable: Cable, q: Array, v: Array, inputs: Mapping[str, Any]) -> tuple[Array, Array]:
    """I and T - (C x' + K x + F + G + D), within the border if there is one."""
    motion = motion_of(q, v, top=cable.top, inputs=inputs)
    return equation(chain_of(cable, np.longdouble), motion, inputs, outside=is_bordered(cable))


def _refine(matrix: Array, right_side: Array, solution: Array) -> None:
    """Solve by factors in doubles and residuals in long double until nothing improves."""
    scale = 1 / np.abs(matrix).max(axis=1)
    factor = scipy.linalg.lu_factor((scale[:, None] * matrix).astype(float))
    for _ in range(6):
        residual = scale * (right_side - matrix @ solution)
        solution += scipy.linalg.lu_solve(factor, residual.astype(float))
