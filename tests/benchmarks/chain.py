"""The chain that everybody gets: the Table 6.1 cable with a 60 kg load below a heaving 6 t floater, in air, its
joints without springs and dampers (what rigid-body libraries have), in a state that differs from link to link.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

__all__ = ["Chain", "chain"]

GRAVITY, LENGTH, RADIUS, DENSITY = 9.81, 240.0, 0.01, 7850.0
FLOATER, LOAD = 6000.0, 60.0


@dataclass(frozen=True)
class Chain:
    """Numbers and state; plain lists, so that an interpreter without cablefmu can take them."""

    n: int
    length: float
    mass: float
    inertia: float
    theta: list[float]
    omega: list[float]
    gravity: float = GRAVITY
    floater: float = FLOATER
    load: float = LOAD


def chain(n: int) -> Chain:
    """`n` links; angles about 45 degrees, rates up to 0.1 rad/s, by a formula that needs no seed."""
    length = LENGTH / n
    mass = math.pi * RADIUS**2 * length * DENSITY
    link = np.arange(1, n + 1)
    theta, omega = math.pi / 4 + 0.1 * np.sin(0.7 * link), 0.1 * np.cos(1.3 * link)
    return Chain(n, length, mass, mass * length**2 / 12.0, theta.tolist(), omega.tolist())
