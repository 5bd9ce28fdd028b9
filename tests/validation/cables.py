"""Cables of textbook problems, as the kernel takes them.

Three limits stand in for what the model does not have:

* A **fixed top** is a floater of `FIXED` kg on no spring. Its vertical acceleration is at most the largest pull
  that is not balanced over `FIXED`, which adds to g: below 1e-10 m/s^2 for the 1e5 N of the heaviest case here.
  Small motions about the vertical do not move it at all, as I_1,j+1 ~ sin th_j [5.1].
* A **free end** is a load of `NOTHING` kg (a mass must be above 0). It changes squared frequencies by about its
  share of what moves, some n NOTHING over the cable's mass: below 1e-11 here.
* A **floater that is not there** has `NOTHING` kg likewise, no spring and no static load.
"""

from __future__ import annotations

import numpy as np

from cablefmu.cable import Cable, Drag, Floats, Links, Terminal

__all__ = [
    "FIXED",
    "GRAVITY",
    "NOTHING",
    "cantilever",
    "hanging_chain",
    "links_of",
    "load_cable",
    "sinking_cable",
]

GRAVITY = 9.81
"""[m/s^2]"""
FIXED = 1e15
"""Mass of a floater that does not move [kg]"""
NOTHING = 1e-12
"""Mass of a load or floater that is not there [kg]"""


def links_of(
    n: int, length: float, mass: float, *, inertia: float = 1.0 / 12.0, volume: float = 0.0, area: float = 0.0,
    stiffness: Floats | None = None, drag: float = 0.0,
) -> Links:  # fmt: skip
    """n equal links of a cable, its `length` [m], `mass` [kg], `volume` [m^3] and drag `area` [m^2] shared among them.

    Parameters
    ----------
    inertia
        I_Ri over m_i l_i^2: 1/12 for a rod, 1/4 for a dumbbell, whose mass sits at its two ends.
    stiffness
        k_i [N m/rad], shape (n,); none unless given.
    drag
        Cd [-]
    """
    each = np.ones(n)
    return Links(
        length=each * length / n,
        mass=each * mass / n,
        inertia=each * inertia * (mass / n) * (length / n) ** 2,
        volume=each * volume / n,
        joint_stiffness=0.0 * each if stiffness is None else stiffness,
        joint_damping=0.0 * each,
        drag_area=each * area / n,
        drag=each * drag,
    )


def load_cable(links: Links, position: Floats, **parameters: float) -> Cable:
    """A cable with a load; without `parameters` a fixed top, a free end, no gravity, no water."""
    wet = "rho_w" in parameters
    plain = {"g": 0.0, "M_1": FIXED, "k_m1": 0.0, "c_m1": 0.0, "static_load": 0.0, "m_c": NOTHING}
    return Cable(
        name="validation",
        links=links,
        terminal=Terminal.LOAD,
        drag=Drag.COEFFICIENT if wet else Drag.NONE,
        parameters=plain | ({"V_c": 0.0} if wet else {}) | parameters,
        inputs=("u_m1", "F_cx", "F_cy"),
        position=position,
        velocity=np.zeros(len(links) + 1),
    )


def hanging_chain(n: int, *, ratio: float = 0.0, dumbbells: bool = False) -> Cable:
    """A limp chain of 12 m and 30 kg at rest below a fixed point, in air.

    Parameters
    ----------
    ratio
        Load over the chain's own mass.
    dumbbells
        The mass of each link at its two ends in place of a rod's.
    """
    length, mass = 12.0, 30.0
    return load_cable(
        links_of(n, length, mass, inertia=0.25 if dumbbells else 1.0 / 12.0),
        np.zeros(n + 1),
        g=GRAVITY,
        m_c=max(ratio * mass, NOTHING),
        static_load=(1.0 + ratio) * mass * GRAVITY,
    )


def cantilever(n: int, length: float, bending_stiffness: float, *, wall: float) -> Cable:
    """A weightless elastic beam, clamped at the top, straight down when unloaded.

    Joints are EI/l; the first, at the wall, `wall` EI/l: 2 is half a link's compliance, 1 a whole link's.
    """
    stiffness = np.full(n, bending_stiffness * n / length)
    stiffness[0] *= wall
    return load_cable(links_of(n, length, 10.0, stiffness=stiffness), np.zeros(n + 1))


def sinking_cable(n: int, *, angle: float = np.pi / 2, **parameters: float) -> Cable:
    """A straight submerged steel cable, 240 m long and 2 cm thick, Cd = 1 [Table 6.1], free at both ends."""
    length, diameter = 240.0, 0.02
    section = np.pi * diameter**2 / 4
    links = links_of(n, length, 7850.0 * section * length, volume=section * length, area=diameter * length, drag=1.0)
    position = np.concatenate([[0.0], np.full(n, angle)])
    return load_cable(links, position, **({"g": GRAVITY, "rho_w": 1000.0, "M_1": NOTHING} | parameters))
