"""The cable as numbers: what a scene says once its texts, units and shapes are worked out.

A `Cable` is the one hand-over between a scene file and everything that computes: the FMU's
resource file is written from it, the dense reference model reads it, and no two of them share code.

Frame: planar, x to the right, **y downward**, origin at the rest position of the top joint, gravity
along +y. SI units, angles in radians from the downward vertical, positive towards +x.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

__all__ = ["PORT_OUTPUTS", "Cable", "Drag", "Floats", "Initial", "Links", "SolverChoice", "Terminal", "Top", "Whole"]

Floats = NDArray[np.float64]


class Top(StrEnum):
    """What holds the upper end of the cable, the point P_0."""

    FLOATER = "floater"
    """A floater that heaves: force u_m1 in, motion out."""
    FREE = "free"
    """A floater that heaves and surges: forces u_m1 and u_m1x in, motion out."""
    MOTION = "motion"
    """P_0 follows a given motion, the vessel's, which owns the mass: motion in, force F_1 on the vessel out."""


class Terminal(StrEnum):
    """What hangs at the lower end of the cable, the point P_n."""

    LOAD = "load"
    """Point mass with its own submerged weight, external force (F_cx, F_cy)."""
    ANCHOR_MASS = "anchor-mass"
    """A huge, neutrally buoyant mass: no weight, no force input."""
    ANCHOR_SPRING = "anchor-spring"
    """A mass with submerged weight on a spring-damper pair about the rest position."""
    FLOATER = "floater"
    """A second floater: weightless at rest, spring-dampers about the rest position, force u_m2."""
    PIN = "pin"
    """An anchor that cannot move: P_n is held at its position exactly, by whatever force that takes."""
    MOTION = "motion"
    """P_n follows a given motion, that of another vessel: motion in, force F_2 on that vessel out."""


class Drag(StrEnum):
    """How a scene gives the normal drag f = -c |v_n| v_n n at each link's centre."""

    NONE = "none"
    """No water."""
    COEFFICIENT = "coefficient"
    """c = 1/2 rho_w Cd D l, from the drag coefficient Cd [-] of each link."""
    PER_LINK = "per-link"
    """c given as it stands, c_v [N s^2/m^2] of each link [Table 6.1]."""


class SolverChoice(StrEnum):
    """Which integrator a Co-Simulation FMU uses."""

    AUTOMATIC = "automatic"
    """Whichever is cheaper, decided during the run from measured stiffness and cost."""
    EXPLICIT = "explicit"
    IMPLICIT = "implicit"


class Initial(StrEnum):
    """What a run starts from."""

    SHAPE = "shape"
    """The start shape as it stands."""
    EQUILIBRIUM = "equilibrium"
    """The stable equilibrium under the inputs of the start, found from the start shape at initialisation."""


_HEAVE, _SURGE = ("y_m1", "v_m1"), ("x_m1", "vx_m1")
_OF_PORT = ("F_{}x", "F_{}y", "m_{}xx", "m_{}xy", "m_{}yy")
PORT_OUTPUTS = {end: tuple(name.format(end) for name in _OF_PORT) for end in (1, 2)}
"""What the cable does to the vessel at either end, and the mass of it that the vessel feels."""


@dataclass(frozen=True, slots=True)
class Links:
    """Per-link arrays, all of shape (n,), link 1 (at the top) first. Links may differ in every one."""

    length: Floats
    """l_i [m]"""
    mass: Floats
    """m_i [kg]"""
    inertia: Floats
    """I_Ri, about the link's own centre [kg m^2]; the terminal's I_Rc is *not* included here."""
    volume: Floats
    """Displaced volume [m^3]; in water the submerged weight is (m_i - rho_w V_i) g."""
    joint_stiffness: Floats
    """k_i of the joint at the top of link i [N m/rad]"""
    joint_damping: Floats
    """c_i of the joint at the top of link i [N m s/rad]"""
    drag_area: Floats
    """D_i l_i, the area that Cd refers to [m^2]; zeros unless drag is by coefficient."""
    drag: Floats
    """Cd_i [-] for `Drag.COEFFICIENT`, c_v,i [N s^2/m^2] for `Drag.PER_LINK`, zeros in air."""

    def __len__(self) -> int:
        return len(self.length)


@dataclass(frozen=True, slots=True)
class Cable:
    """One cable between its two ports, ready to compute.

    Notes
    -----
    `parameters` holds exactly the scalars that the scene's FMU exposes, under their FMI names, SI:

    ==================================== ============================================================
    present                              names
    ==================================== ============================================================
    always                               ``g``
    top floater or free                  ``M_1``, ``k_m1``, ``c_m1``, ``static_load``
    top free                             ``k_m1H``, ``c_m1H``, ``static_pull``
    water                                ``rho_w``
    ... drag by one common coefficient   ``Cd`` (overrides `links.drag`)
    joints all equal, not zero           ``k_joint``, ``c_joint`` (override the arrays; each by itself)
    load                                 ``m_c``; ``I_Rc`` if not zero; in water ``rho_c`` or ``V_c``
    anchor-mass                          ``m_c``
    pin, motion (either end)             none
    anchor-spring                        ``m_c``; in water ``rho_c`` or ``V_c``; ``k_cH``, ``c_cH``,
                                         ``k_cV``, ``c_cV``, ``static_load_2``, ``static_pull_2``
    floater                              ``M_2`` (in m_c's place), ``k_m2V``, ``c_m2V``, ``k_m2H``,
                                         ``c_m2H``, ``static_load_2``, ``static_pull_2``
    ==================================== ============================================================

    A parameter wins over an array that it overrides, so that ``replace(cable, parameters=...)`` is
    the same cable with that value. `static_load` [N] acts upwards on floater 1, `static_pull` [N]
    towards -x if it is free: it is pulled with F_x = -static_pull - k_m1H x_m - c_m1H vx_m, and the
    terminal's springs pull that with F_x = static_pull_2 - k_H (x_c - x_0) - c_H vx_c and
    F_y = -static_load_2 - k_V (y_c - y_0) - c_V vy_c, (x_0, y_0) being `rest_position`.
    Submerged mass of the terminal: load and anchor-spring m_c - rho_w V_c, where V_c = m_c / rho_c
    if a density is given (in air m_c); anchor-mass and floater 0.
    """

    name: str
    links: Links
    terminal: Terminal
    drag: Drag
    parameters: dict[str, float]
    inputs: tuple[str, ...]
    """Names of the inputs that exist, in the order u_m1, u_m2, F_cx, F_cy, u_m1x [N], and of each end p = 1, 2 whose
    motion is given x_p, y_p [m], vx_p, vy_p [m/s], ax_p, ay_p [m/s^2]."""
    position: Floats
    """Start of q, shape (coordinates,) [m, rad]: (y_m, theta_1 ... theta_n) under a floater that heaves, and behind
    these x_m if it is free; (theta_1 ... theta_n) where the top's motion is given."""
    velocity: Floats
    """Start of dq/dt, likewise [m/s, rad/s]"""
    rest_position: tuple[float, float] = (0.0, 0.0)
    """(x_0, y_0) of the terminal's springs, where a pin holds it, or where a given motion has it at rest [m];
    (0, 0) where there is none of them."""
    input_start: dict[str, float] = field(default_factory=dict)
    """Value of each input at the start [N, m, m/s, m/s^2]; where it is not named 0, of x_2 and y_2 `rest_position`."""
    solver: SolverChoice = SolverChoice.AUTOMATIC
    initial: Initial = Initial.SHAPE
    top: Top = Top.FLOATER

    @property
    def n(self) -> int:
        """Number of links."""
        return len(self.links)

    @property
    def coordinates(self) -> int:
        """Number of coordinates in q: the angles, and what a floater at the top adds."""
        return self.n + {Top.FLOATER: 1, Top.FREE: 2, Top.MOTION: 0}[self.top]

    @property
    def absent_outputs(self) -> frozenset[str]:
        """Names of the outputs that such a cable does not have, whatever its scene drops."""
        of_top = {
            Top.FLOATER: (*_SURGE, *PORT_OUTPUTS[1]),
            Top.FREE: PORT_OUTPUTS[1],
            Top.MOTION: (*_HEAVE, *_SURGE),
        }[self.top]
        return frozenset((*of_top, *(PORT_OUTPUTS[2] if self.terminal is not Terminal.MOTION else ())))

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """What the entries of q are called in the FMU."""
        heave = ("y_m1",) if self.top is not Top.MOTION else ()
        surge = ("x_m1",) if self.top is Top.FREE else ()
        return (*heave, *(f"theta[{i}]" for i in range(1, self.n + 1)), *surge)

    def angles_in(self, q: Floats) -> Floats:
        """The link angles of such a vector, shape (n,) [rad]."""
        first = 0 if self.top is Top.MOTION else 1
        return q[first : first + self.n]

    @property
    def start_of_top(self) -> tuple[float, float]:
        """(x, y) of P_0 at the start [m]."""
        if self.top is Top.MOTION:
            return self.input_start.get("x_1", 0.0), self.input_start.get("y_1", 0.0)
        return (float(self.position[-1]) if self.top is Top.FREE else 0.0), float(self.position[0])

    def padded(self, vector: Floats) -> Floats:
        """`vector`, as long as q or as (q, dq/dt), as the kernel has it: a zero for the heave where q has none."""
        if self.top is not Top.MOTION:
            return vector
        halves = np.split(vector, len(vector) // self.coordinates)
        return np.concatenate([[0.0, *half] for half in halves])

    def unpadded(self, vector: Floats) -> Floats:
        """The inverse of `padded`."""
        if self.top is not Top.MOTION:
            return vector
        halves = np.split(vector, len(vector) // (self.coordinates + 1))
        return np.concatenate([half[1:] for half in halves])

    @property
    def in_water(self) -> bool:
        """Whether the cable is submerged (buoyancy and drag)."""
        return "rho_w" in self.parameters


@dataclass(frozen=True, slots=True)
class Whole:
    """A uniform cable before it is divided into links: what it is and how it starts, whatever their number."""

    parameters: dict[str, float]
    """By their FMI names, SI: ``L``, ``D``, ``rho_cable``; ``EI`` where joints follow from it, ``theta_start`` where
    the cable starts straight, and not in the rest shape between its ports."""
    preloads: tuple[str, ...]
    """Parameters of the `Cable` that follow from the rest shape, and so from the number of links."""
    place: tuple[float, float]
    """(x, y) of the lower port [m]; (0, 0) for a load, which has none."""

    def rest_of(self, cable: Cable) -> Cable:
        """The cable without the parameters that follow from the whole and the number of links."""
        follow = {*self.preloads, *(("k_joint",) if "EI" in self.parameters else ())}
        kept = {name: value for name, value in cable.parameters.items() if name not in follow}
        return replace(cable, parameters=kept, rest_position=self.place)
