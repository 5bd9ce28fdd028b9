"""Initial shapes: the angles of the links at the start, and the rest shape between two ports.

The rest shape is the *discrete* catenary: n frictionless rigid links, each with its own weight, held at
(0, 0) and at `end`. Its links obey tan th_i = H / (V - weight above the middle of link i), where H and V
are the horizontal and vertical pull at the top joint [N]. Joint springs are left out, as they bend
a cable of this slenderness by little.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablefmu.cable import Floats

__all__ = ["END_TOLERANCE", "Catenary", "NoCatenaryError", "catenary", "end_point", "ending_at", "straight"]

END_TOLERANCE = 1e-9
"""How close P_n must come to the port [m]."""

_MAX_STEPS = 100
_SHORTEST_STEP = 1e-10
_LARGEST_STEP = 1e20
# Newton crawls along the kinks of links that carry next to nothing, so these are sharpened step by step.
_ROUNDINGS = (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0)
# Share of the decrease that the slope promises that a step must bring (the usual choice).
_ARMIJO = 1e-4


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

    Notes
    -----
    With the pull (H, V - W_i) in link i, of size T_i, the ports' distance is the gradient of the convex
    function sum l_i T_i. So (H, V) minimises phi = sum l_i T_i - H x - V y, which grows in every direction
    if the ports are closer than the cable is long: Newton with a step control finds it from any start.
    phi has a kink where a link carries nothing, and if that is the minimum, these links do not fit.
    """
    total = float(np.sum(lengths))
    chord = float(np.hypot(*end))
    if chord >= total:
        raise NoCatenaryError(
            f"the ports are {chord:.6g} m apart, and the cable is {total:.6g} m long; it must be longer"
        )
    scale = float(np.sum(np.abs(weights)))
    if scale == 0.0:
        raise NoCatenaryError(
            "a cable without weight (in water: as dense as the water) has no rest shape between two ports"
        )
    span = np.asarray(end, dtype=np.float64) / total
    above = (np.cumsum(weights) - weights / 2.0) / scale
    pull = _pull(lengths / total, above, span)
    angles = np.arctan2(pull[0], pull[1] - above)
    x, y = end_point(lengths, angles)
    if not np.hypot(x - end[0], y - end[1]) <= END_TOLERANCE:
        raise NoCatenaryError(
            "no rest shape of these links joins the ports: the ports are nearly the cable's length apart,"
            " or too close together (or above each other) for links this long"
        )
    return Catenary(angles, float(pull[0] * scale), float(pull[1] * scale))


def _pull(lengths: Floats, above: Floats, span: Floats) -> Floats:
    """Minimise phi over (H, V), all in units of the cable's length and weight; see `catenary`."""
    # The pull of a slack cable: half the weight at each port, and as much sideways.
    pull = np.array([np.copysign(0.5, span[0]), 0.5 * (above[0] + above[-1])])
    for rounding in _ROUNDINGS:
        pull = _newton(pull, lengths, above, span, rounding)
    return pull


def _newton(pull: Floats, lengths: Floats, above: Floats, span: Floats, rounding: float) -> Floats:
    """Minimise phi with its kinks rounded off, T = sqrt(H^2 + (V - W)^2 + rounding^2), from `pull` on."""

    def look(pull: Floats) -> tuple[float, Floats, Floats]:
        """Value of phi, its gradient (how far the end misses the port) and Hessian at a pull."""
        direction = np.array([np.full_like(above, pull[0]), pull[1] - above])
        size = np.maximum(np.hypot(np.hypot(*direction), rounding), np.finfo(float).tiny)
        unit, weight = direction / size, lengths / size
        # T'' = (1 - u u^T) / T with u = direction / T, written so that nothing cancels.
        cross = -float(np.sum(weight * unit[0] * unit[1]))
        round_part = (rounding / size) ** 2
        hessian = np.array(
            [
                [np.sum(weight * (unit[1] ** 2 + round_part)), cross],
                [cross, np.sum(weight * (unit[0] ** 2 + round_part))],
            ]
        )
        return float(lengths @ size - pull @ span), unit @ lengths - span, hessian

    value, miss, hessian = look(pull)
    for _ in range(_MAX_STEPS):
        try:
            step = -np.linalg.solve(hessian, miss)
        except np.linalg.LinAlgError:
            break
        if not _size(step) < _LARGEST_STEP:
            break
        reach = 1.0
        while reach > _SHORTEST_STEP:
            trial = look(pull + reach * step)
            # Near the minimum phi is flat to rounding, and the miss alone tells a good step.
            if trial[0] < value + _ARMIJO * reach * float(miss @ step) or _size(trial[1]) < 0.5 * _size(miss):
                break
            reach *= 0.5
        else:
            break
        pull = pull + reach * step
        value, miss, hessian = trial
    return pull


def _size(vector: NDArray[Any]) -> float:
    return float(np.hypot(vector[0], vector[1]))
