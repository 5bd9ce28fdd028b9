"""Initial shapes: the angles of the links at the start, and the rest shape between two ports.

The rest shape is the *discrete* catenary: n frictionless rigid links, each with its own weight, held at
(0, 0) and at `end`. Its links obey tan th_i = H / (V - weight above the middle of link i), where H and V
are the horizontal and vertical pull at the top joint [N]. Joint springs are left out, as they bend
a cable of this slenderness by little.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cablefmu.cable import Floats
from cablefmu.kernel import library

__all__ = ["END_TOLERANCE", "Catenary", "NoCatenaryError", "catenary", "end_point", "ending_at", "straight"]

END_TOLERANCE = 1e-9
"""How close P_n must come to the port [m]."""

_MAX_STEPS = 100
_REASONS = {
    1: "the ports are {chord:.6g} m apart, and the cable is {total:.6g} m long; it must be longer",
    2: "a cable without weight (in water: as dense as the water) has no rest shape between two ports",
    3: "no rest shape of these links joins the ports: the ports are nearly the cable's length apart,"
    " or too close together (or above each other) for links this long",
}
"""Status of the kernel's search [catenary.h] -> what is wrong."""


class NoCatenaryError(ValueError):
    """No rest shape of this cable joins the two ports; the message says why."""


@dataclass(frozen=True, slots=True)
class Catenary:
    """A rest shape between two ports, and what it pulls with.

    At its lower end the cable pulls the terminal with (-H, -(V - W)), W being the cable's weight.
    """

    angles: Floats
    """Link angles from the downward vertical [rad], shape (n,)"""
    horizontal: float
    """H, the same in every joint [N]"""
    vertical: float
    """V at the top joint, positive when the cable pulls the top port down [N]"""


def straight(n: int, angle: float) -> Floats:
    """All `n` links at one `angle` [rad]; 0 hangs down."""
    return np.full(n, angle)


def end_point(lengths: Floats, angles: Floats) -> tuple[float, float]:
    """Terminal point (x, y) of a chain from the origin [m]."""
    return float(np.sum(lengths * np.sin(angles))), float(np.sum(lengths * np.cos(angles)))


def ending_at(lengths: Floats, angles: Floats, end: tuple[float, float]) -> Floats:
    """The angles next to `angles` (smallest sum of squares) of a chain that ends at `end`, if that is near.

    Newton's method on the two equations; rounded angles become ones that meet the port to the last digits.
    """
    for _ in range(_MAX_STEPS):
        x, y = end_point(lengths, angles)
        miss = np.array([end[0] - x, end[1] - y])
        if np.hypot(*miss) <= 1e-15 * np.sum(lengths):
            break
        across = lengths * np.array([np.cos(angles), -np.sin(angles)])  # d(x, y)/d(angle)
        angles = angles + np.linalg.lstsq(across, miss, rcond=1e-9)[0]
    return angles


def catenary(lengths: Floats, weights: Floats, end: tuple[float, float]) -> Catenary:
    """Rest shape of n links between (0, 0) and `end`.

    Parameters
    ----------
    lengths
        l_i [m], shape (n,)
    weights
        Submerged weight of each link [N], shape (n,); negative for links that float.
    end
        (x, y) of the lower port [m], y downward.

    Raises
    ------
    NoCatenaryError
        If the ports are too far apart or too close together for these links, or the cable has no weight.

    RunError
        Where the package has no kernel for this machine.

    Notes
    -----
    The kernel's own [fmu_src/kernel/catenary.c]: an FMU whose number of links is a parameter finds the same to the bit.
    """
    total = float(np.sum(lengths))
    angles, pull = np.empty(len(lengths)), np.empty(2)
    status = library().kernel_catenary(
        len(lengths), np.ascontiguousarray(lengths), np.ascontiguousarray(weights), np.array(end, dtype=np.float64),
        angles, pull,
    )  # fmt: skip
    if status:
        raise NoCatenaryError(_REASONS[status].format(chord=float(np.hypot(*end)), total=total))
    return Catenary(angles, float(pull[0]), float(pull[1]))
