"""What one looks at: motion of and force on the ports, joint forces, tensions, energy, and where the energy goes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cablefmu.cable import Top
from cablefmu.reference.chain import Array, Chain, Number
from cablefmu.reference.drag import drag_forces
from cablefmu.reference.kinematics import Motion, accelerations, centres, points, velocities
from cablefmu.reference.terminal import terminal_force

__all__ = [
    "effective_masses",
    "energy",
    "joint_forces",
    "kinetic_energy",
    "output_values",
    "potential_energy",
    "powers",
    "pulls",
]


def output_values(
    chain: Chain,
    motion: Motion,
    acceleration: Array,
    inputs: Mapping[str, Number],
    end_inertia_force: Array | None = None,
) -> dict[str, Any]:
    """Every output of the FMU but `effective_masses` by its name, SI; arguments as for `joint_forces`."""
    position, velocity = points(chain, motion)[-1], velocities(chain, motion)[-1]
    forces = joint_forces(chain, motion, acceleration, inputs, end_inertia_force)
    pull = pulls(motion, forces)
    return {
        **_port_values(chain, motion, forces),
        "x_c": position[0],
        "y_c": position[1],
        "vx_c": velocity[0],
        "vy_c": velocity[1],
        "tension_top": pull[0, 0],
        "tension_end": pull[-1, 1],
        "tension_max": pull.max(),
        "energy": energy(chain, motion),
    }


def effective_masses(
    chain: Chain, outputs_at: Callable[[Mapping[str, Number]], Mapping[str, Any]], inputs: Mapping[str, Number]
) -> dict[str, Any]:
    """-dF/da at every end whose motion is given: m_pxx, m_pxy, m_pyy [kg].

    Forces are affine in the accelerations, so that a change by 1 m/s^2 tells all.

    Parameters
    ----------
    outputs_at
        The other outputs under such inputs.
    """
    masses: dict[str, Any] = {}
    for end in [1] * (chain.top is Top.MOTION) + [2] * chain.end_is_driven:
        before = outputs_at(inputs)
        x, y = (outputs_at({**inputs, name: inputs.get(name, 0.0) + 1}) for name in (f"ax_{end}", f"ay_{end}"))
        masses[f"m_{end}xx"] = before[f"F_{end}x"] - x[f"F_{end}x"]
        masses[f"m_{end}xy"] = before[f"F_{end}x"] - y[f"F_{end}x"]
        masses[f"m_{end}yy"] = before[f"F_{end}y"] - y[f"F_{end}y"]
    return masses


def _port_values(chain: Chain, motion: Motion, forces: Array) -> dict[str, Any]:
    """The motion of floater 1, or what the cable does to those that move its ends: -R_1 at P_0, R_{n+1} at P_n [N].

    They get a force alone. The moment of joint 1's spring and damper ends in a body that does not turn.
    """
    values: dict[str, Any] = {}
    if chain.top is not Top.MOTION:
        values |= {"y_m1": motion.top.position[1], "v_m1": motion.top.velocity[1]}
    if chain.top is Top.FREE:
        values |= {"x_m1": motion.top.position[0], "vx_m1": motion.top.velocity[0]}
    if chain.top is Top.MOTION:
        values |= {"F_1x": -forces[0, 0], "F_1y": -forces[0, 1]}
    if chain.end_is_driven:
        values |= {"F_2x": forces[-1, 0], "F_2y": forces[-1, 1]}
    return values


def joint_forces(
    chain: Chain,
    motion: Motion,
    acceleration: Array,
    inputs: Mapping[str, Number],
    end_inertia_force: Array | None = None,
) -> Array:
    """R_1 ... R_{n+1}, the force from above on each link and, last, on the terminal, shape (n + 1, 2) [N].

    Newton's law, from the tip up: R_{n+1} = m_c P_n'' - W_c - F_c and
    R_i = R_{i+1} + m_i c_i'' - W_i - f_i, with weights W along +y and drag f_i. Give m_c P_n'' as
    `end_inertia_force` where it is known better than as a product of 8e8 kg with a rounded acceleration.
    An end that is held has neither mass nor weight; its multiplier stands there, and must be given.
    """
    if chain.pin is not None and end_inertia_force is None:
        raise ValueError("what pulls at a held end does not follow from the motion: end_inertia_force is needed")
    at_points = accelerations(chain, motion, acceleration)
    down = np.array([0, 1])
    inertia_force = chain.end_mass * at_points[-1] if end_inertia_force is None else end_inertia_force
    end = inertia_force - chain.end_wet_mass * chain.gravity * down - terminal_force(chain, motion, inputs)
    links = (
        chain.mass[:, None] * centres(at_points)
        - np.outer(chain.wet_mass * chain.gravity, down)
        - drag_forces(chain, motion)
    )
    return np.cumsum(np.vstack([links, end])[::-1], axis=0)[::-1]


def pulls(motion: Motion, forces: Array) -> Array:
    """-R_i . e_i and -R_{i+1} . e_i, the pull at the top and the lower end of link i, shape (n, 2) [N]."""
    along = motion.along
    return -np.stack([np.sum(forces[:-1] * along, axis=1), np.sum(forces[1:] * along, axis=1)], axis=1)


def energy(chain: Chain, motion: Motion) -> Number:
    """Kinetic and potential energy [J], without external forces; of what moves an end by a given motion nothing."""
    return kinetic_energy(chain, motion) + potential_energy(chain, motion)


def kinetic_energy(chain: Chain, motion: Motion) -> Number:
    """Of floater, links and terminal [J], from their own velocities rather than from I(x)."""
    at_points = velocities(chain, motion)
    links = chain.mass @ np.sum(centres(at_points) ** 2, axis=1) + chain.inertia @ motion.omega**2
    ports = chain.floater_mass * np.sum(motion.top.velocity**2) + chain.end_mass * np.sum(at_points[-1] ** 2)
    return (links + ports) / 2


def potential_energy(chain: Chain, motion: Motion) -> Number:
    """Of weights, springs and static loads [J].

    Weights count from Y = 0, downward lowering it; the terminal's springs and preload from its rest
    position, those of floater 1 from x_m = 0 and y_m = 0.
    """
    at_points = points(chain, motion)
    weights = chain.wet_mass @ centres(at_points)[:, 1] + chain.end_wet_mass * at_points[-1, 1]
    bend = motion.theta - np.concatenate([[0], motion.theta[:-1]])
    springs = chain.end_springs
    stretch = at_points[-1] - springs.rest
    surge, heave = motion.top.position
    floater = chain.floater_stiffness * heave**2 / 2 + chain.static_load * heave
    floater += chain.surge_stiffness * surge**2 / 2 + chain.static_pull * surge
    terminal = springs.stiffness @ stretch**2 / 2 - springs.preload @ stretch
    return floater + chain.stiffness @ bend**2 / 2 + terminal - chain.gravity * weights


def powers(chain: Chain, motion: Motion, inputs: Mapping[str, Number], forces: Array | None = None) -> dict[str, Any]:
    """What enters (+) and leaves (-) the energy [W]; their sum is dE/dt by virtual work.

    Keys: one per input that is a force, "F_1" and "F_2" where an end's motion is given, then "joints" (c_i),
    "floater" (c_m), "terminal" (its dampers), "drag". What moves an end does work against the force that its output
    shows: `forces`, those of `joint_forces`, must then be given. P_n's velocity is that of the state.
    """
    at_points = velocities(chain, motion)
    (surge_rate, heave_rate), end = motion.top.velocity, at_points[-1]
    moved = {"u_m1": heave_rate, "u_m1x": surge_rate, "u_m2": end[1], "F_cx": end[0], "F_cy": end[1]}
    bend_rate = motion.omega - np.concatenate([[0], motion.omega[:-1]])
    return {
        **{name: force * moved[name] for name, force in inputs.items() if name in moved},
        **_port_powers(chain, at_points, forces),
        "joints": -chain.damping @ bend_rate**2,
        "floater": -chain.floater_damping * heave_rate**2 - chain.surge_damping * surge_rate**2,
        "terminal": -chain.end_springs.damping @ end**2,
        "drag": np.sum(drag_forces(chain, motion) * centres(at_points)),
    }


def _port_powers(chain: Chain, at_points: Array, forces: Array | None) -> dict[str, Any]:
    """What those that move an end put into the cable [W]: -F_1 . P_0', -F_2 . P_n'."""
    driven = {"F_1": chain.top is Top.MOTION, "F_2": chain.end_is_driven}
    if forces is None:
        if any(driven.values()):
            raise ValueError("the power of a given motion does not follow from the motion: joint forces are needed")
        return {}
    flows = {"F_1": forces[0] @ at_points[0], "F_2": -forces[-1] @ at_points[-1]}
    return {name: flow for name, flow in flows.items() if driven[name]}
