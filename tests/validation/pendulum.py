"""A link that swings far: the period by complete elliptic integrals."""

from __future__ import annotations

import ctypes

import numpy as np

from cablefmu.cable import Floats
from tests.kernel.library import Kernel
from tests.validation.cables import GRAVITY, links_of, load_cable
from tests.validation.checks import Check, Section
from tests.validation.motion import crossings

__all__ = ["half_periods", "sections"]

ELLIPTIC = {60.0: 1.685750354812596, 90.0: 1.854074677301372, 120.0: 2.156515647499643}
"""Amplitude [deg] -> K(m), m = sin^2 of half of it; A. and S., Table 17.1, m = 0.25, 0.5, 0.75."""
TOLERANCE = 1e-9
"""Of the ratio of periods: ten times the solver's tolerance of 1e-10, for what its steps add up to."""


def half_periods(library: ctypes.CDLL, degrees: float, count: int) -> Floats:
    """Times between crossings of the vertical over pi sqrt(J / (mu l g)), the half period of small swings."""
    length, mass, load, rotary = 3.0, 20.0, 35.0, 4.0
    links = links_of(1, length, mass)
    start = np.array([0.0, np.radians(degrees)])
    weight = (mass + load) * GRAVITY
    cable = load_cable(links, start, g=GRAVITY, m_c=load, I_Rc=rotary, static_load=weight)
    inertia = mass * length**2 / 3.0 + load * length**2 + rotary
    small = np.pi * np.sqrt(inertia / ((mass / 2.0 + load) * length * GRAVITY))

    def angle(q: Floats, v: Floats) -> tuple[float, float]:
        return float(q[1]), float(v[1])

    times = crossings(Kernel(library, cable), angle, small / 16.0, count + 1, tolerance=1e-10)
    return np.asarray(np.diff(times) / small)


def sections(library: ctypes.CDLL) -> list[Section]:
    checks = [
        Check(
            f"period from {degrees:g}° over that of small swings", "", 2.0 / np.pi * elliptic,
            float(half_periods(library, degrees, 4).mean()), TOLERANCE,
        )
        for degrees, elliptic in ELLIPTIC.items()
    ]  # fmt: skip
    return [
        Section(
            "Pendulum",
            "T / T_0 = (2/pi) K(sin²(theta_0/2)) with K from Abramowitz and Stegun, Table 17.1 (m = 1/4, "
            "1/2, 3/4). From 90° it is also Gauss's 1 / agm(1, 1/sqrt(2)).",
            "The same model: one rod with a load that has rotary inertia, T_0 = 2 pi sqrt(J/(mu l g)) by "
            "hand, mean of four half periods by the clock. The solver's local tolerance is 1e-10, and one "
            "order more is left for what its steps add up to. The floater of 1e15 kg yields by less than "
            "1e-12 of g.",
            tuple(checks),
        )
    ]
