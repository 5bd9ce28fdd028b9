"""The cable's numbers as the equations of chapters 2 to 5 name them.

Everything that the dissertation's three practical situations differ in is here a number that may be
zero, so that one set of equations serves every terminal. It is written for a top that is free both ways,
with the coordinates (y_m, theta_1 ... theta_n, x_m); where the top is guided or its motion given, the
unknowns are the part of these that is left, `Chain.own`. The arrays hold any kind of number that
knows + - * / and abs: floats, mpmath's `mpf` (see `extended`), sympy's symbols (see the tests).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablefmu.cable import Cable, Drag, Terminal, Top

__all__ = ["Array", "Chain", "EndSprings", "Number", "chain_of", "sum_below"]

Array = NDArray[Any]
"""Array of floats, or of objects that compute like them."""
Number = Any
"""A float, or an object that computes like one."""


@dataclass(frozen=True)
class EndSprings:
    """Spring-dampers at P_n, horizontal first; F = preload - stiffness (P - rest) - damping P'."""

    stiffness: Array
    """(k_H, k_V) [N/m]"""
    damping: Array
    """(c_H, c_V) [N s/m]"""
    rest: Array
    """(x_0, y_0) [m]"""
    preload: Array
    """(static_pull_2, -static_load_2) [N]: what holds the cable's rest shape"""


@dataclass(frozen=True)
class Chain:
    """Links, floater and terminal; arrays of shape (n,), link 1 first."""

    length: Array
    """l_i [m]"""
    mass: Array
    """m_i [kg]"""
    wet_mass: Array
    """m_i^w = m_i - rho_w V_i, the mass that carries weight [kg]"""
    inertia: Array
    """I_Ri about the link's centre [kg m^2]. The last one includes I_Rc: Table 6.2 gives I_Rc but no
    equation of the print uses it (erratum); the load turns with the last link."""
    stiffness: Array
    """k_i of the joint at the top of link i [N m/rad]"""
    damping: Array
    """c_i of the joint at the top of link i [N m s/rad]"""
    drag: Array
    """c_v,i of f = -c_v |v_n| v_n n [N s^2/m^2]"""
    gravity: Number
    """g [m/s^2]"""
    floater_mass: Number
    """M [kg]"""
    floater_stiffness: Number
    """k_m [N/m] (the print's Tables 6.2 to 6.5 say N m/rad: erratum)"""
    floater_damping: Number
    """c_m [N s/m] (the print says N m s/rad: erratum)"""
    static_load: Number
    """What floater 1's buoyancy carries at y_m = 0 besides its own weight, upwards [N]"""
    end_mass: Number
    """m_c, or M_2 of a second floater; 0 of a pin [kg]"""
    end_wet_mass: Number
    """m_c^w = m_c - rho_w V_c; 0 for the neutral anchor mass and for a second floater [kg]. [5.7] keeps
    m_c g in all cases (erratum): the second floater would sag by M_2 g / k_m2V = 49 m."""
    end_springs: EndSprings
    pin: Array | None = None
    """Where P_n is held [m], shape (2,), by a pin or, where its given motion says nothing else, by that; None for
    every other terminal"""
    end_is_driven: bool = False
    """Whether P_n follows a given motion, x_2 ... ay_2"""
    top: Top = Top.FLOATER
    """Which of P_0's coordinates are unknowns, and which are given"""
    surge_stiffness: Number = 0.0
    """k_mH of a free floater 1 about x_m = 0 [N/m]"""
    surge_damping: Number = 0.0
    """c_mH of a free floater 1 [N s/m]"""
    static_pull: Number = 0.0
    """What a free floater 1's mooring carries at x_m = 0, towards -x [N]"""

    @property
    def n(self) -> int:
        """Number of links."""
        return len(self.length)

    @property
    def own(self) -> slice:
        """Which of (y_m, theta, x_m) are unknowns: without x_m under a floater that heaves only, and without either
        where the top's motion is given."""
        return {Top.FLOATER: slice(0, -1), Top.FREE: slice(None), Top.MOTION: slice(1, -1)}[self.top]

    @property
    def coordinates(self) -> int:
        """Number of unknowns."""
        return len(range(self.n + 2)[self.own])

    def rows(self, heave: Number, links: Array, surge: Number) -> Array:
        """What belongs to y_m, theta and x_m as one vector, without the rows that are not unknowns."""
        vector: Array = np.concatenate([[heave], links, [surge]])[self.own]
        return vector

    @cached_property
    def carried_mass(self) -> Array:
        """mu_j = m_j/2 + sum_{k>j} m_k + m_c [kg], shape (n,)"""
        carried: Array = self.mass / 2 + sum_below(self.mass) + self.end_mass
        return carried

    @cached_property
    def carried_wet_mass(self) -> Array:
        """mu^w_j = m^w_j/2 + sum_{k>j} m^w_k + m_c^w [kg], shape (n,)"""
        carried: Array = self.wet_mass / 2 + sum_below(self.wet_mass) + self.end_wet_mass
        return carried


def sum_below(values: Array) -> Array:
    """Sum over the links below each: s_i = sum_{k>i} values_k, shape as `values` (links first)."""
    inclusive = np.cumsum(values[::-1], axis=0)[::-1]
    return np.concatenate([inclusive[1:], values[:1] * 0])


def chain_of(cable: Cable, number: Callable[[float], Number] = float) -> Chain:
    """The chain of a cable, with every number turned into `number`'s kind before any arithmetic.

    Parameters
    ----------
    cable
        The cable; its parameters win over the arrays that they override.
    number
        Constructor of the numbers, `float` or `mpmath.mpf`.
    """
    links, given = cable.links, cable.parameters

    def parameter(name: str, default: float = 0.0) -> Number:
        return number(given.get(name, default))

    def array(values: Any) -> Array:
        return np.array([number(float(value)) for value in values])

    def overridden(name: str, values: Array) -> Array:
        return array([given[name]] * cable.n if name in given else values)

    mass, volume, inertia = array(links.mass), array(links.volume), array(links.inertia)
    inertia[-1] += parameter("I_Rc")
    rho_w = parameter("rho_w")
    end_mass = parameter("M_2" if cable.terminal is Terminal.FLOATER else "m_c")
    floater = cable.terminal is Terminal.FLOATER
    return Chain(
        length=array(links.length),
        mass=mass,
        wet_mass=mass - rho_w * volume,
        inertia=inertia,
        stiffness=overridden("k_joint", links.joint_stiffness),
        damping=overridden("c_joint", links.joint_damping),
        drag=_drag(cable, rho_w, overridden("Cd", links.drag), array(links.drag_area)),
        gravity=parameter("g"),
        floater_mass=parameter("M_1"),
        floater_stiffness=parameter("k_m1"),
        floater_damping=parameter("c_m1"),
        static_load=parameter("static_load"),
        end_mass=end_mass,
        end_wet_mass=_end_wet_mass(cable, rho_w, end_mass, parameter),
        end_springs=EndSprings(
            stiffness=np.array([parameter("k_m2H"), parameter("k_m2V")])
            if floater
            else np.array([parameter("k_cH"), parameter("k_cV")]),
            damping=np.array([parameter("c_m2H"), parameter("c_m2V")])
            if floater
            else np.array([parameter("c_cH"), parameter("c_cV")]),
            rest=array(cable.rest_position),
            preload=np.array([parameter("static_pull_2"), -parameter("static_load_2")]),
        ),
        pin=array(cable.rest_position) if cable.terminal in (Terminal.PIN, Terminal.MOTION) else None,
        end_is_driven=cable.terminal is Terminal.MOTION,
        top=cable.top,
        surge_stiffness=parameter("k_m1H"),
        surge_damping=parameter("c_m1H"),
        static_pull=parameter("static_pull"),
    )


def _drag(cable: Cable, rho_w: Number, coefficient: Array, area: Array) -> Array:
    """c_v of each link: 1/2 rho_w Cd D l, or as it stands [Table 6.1]."""
    by_kind: dict[Drag, Array] = {
        Drag.COEFFICIENT: rho_w * coefficient * area / 2,
        Drag.PER_LINK: coefficient,
        Drag.NONE: coefficient * 0,
    }
    return by_kind[cable.drag]


def _end_wet_mass(cable: Cable, rho_w: Number, end_mass: Number, parameter: Callable[[str], Number]) -> Number:
    """m_c - rho_w V_c, or 0 where the terminal floats or is neutrally buoyant [2.2.2]."""
    if cable.terminal in (Terminal.ANCHOR_MASS, Terminal.FLOATER):
        return end_mass * 0
    if "rho_c" in cable.parameters:
        return end_mass * (1 - rho_w / parameter("rho_c"))
    return end_mass - rho_w * parameter("V_c")
