"""Cables to be brought to rest, and what the dense reference model says of a state of rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.linalg import null_space

from cablefmu.cable import Cable, Floats, Terminal
from cablefmu.reference import Reference
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.matrices import stiffness_matrix
from cablefmu.reference.model import generalised_forces
from cablefmu.reference.vectors import gravity_vector
from tests.random_cables import KINDS, random_cable

__all__ = ["START_NAMES", "cable_of", "end_jacobian", "end_of", "held", "missing_forces", "start", "tangent_stiffness"]

START_NAMES = ("hanging", "inverted", "nearly inverted", "horizontal", "coil", "zigzag", "hairpins", "random")


def start(name: str, n: int) -> Floats:
    """q = (0, angles) of a start, shape (n + 1,)."""
    number = np.arange(n)
    angles = {
        "hanging": np.zeros(n),
        "inverted": np.full(n, np.pi),
        "nearly inverted": np.full(n, np.deg2rad(179.9)),
        "horizontal": np.full(n, np.pi / 2),
        "coil": 8.0 * np.pi * number / n,
        "zigzag": np.where(number % 2, 1.4, -1.4),
        "hairpins": np.where(number % 2, 3.1, -0.05),
        "random": np.random.default_rng(n).uniform(-np.pi, np.pi, n),
    }
    return np.append(0.0, angles[name])


def cable_of(kind: int, n: int, *, draw: int = 0, slack: float = 0.8) -> Cable:
    """A random cable of KINDS[kind]; a pin or an anchor of 1e15 kg at `slack` times its length from the top."""
    terminal, water, drag = KINDS[kind]
    rng = np.random.default_rng([n, kind, draw])
    cable = random_cable(rng, n, terminal, water, drag=drag)
    angle, reach = rng.uniform(-1.0, 1.0), slack * cable.links.length.sum()
    if terminal is Terminal.PIN:
        return replace(cable, rest_position=(float(reach * np.sin(angle)), float(reach * np.cos(angle))))
    return cable


def end_of(cable: Cable, q: Floats) -> Floats:
    """P_n [m]"""
    length = cable.links.length
    return np.array([length @ np.sin(q[1:]), q[0] + length @ np.cos(q[1:])])


def end_jacobian(cable: Cable, q: Floats) -> Floats:
    """dP_n/dq, shape (2, n + 1)."""
    length = cable.links.length
    return np.array([np.append(0.0, length * np.cos(q[1:])), np.append(1.0, -length * np.sin(q[1:]))])


def held(cable: Cable, q: Floats) -> Cable:
    """An anchor that is held by its mass alone stands still in statics: the same as a pin where it is at the start."""
    if cable.terminal is not Terminal.ANCHOR_MASS:
        return cable
    left = {name: value for name, value in cable.parameters.items() if name != "m_c"}
    x, y = end_of(cable, q)
    return replace(cable, terminal=Terminal.PIN, rest_position=(float(x), float(y)), parameters=left)


def missing_forces(cable: Cable, q: Floats, inputs: Mapping[str, float]) -> Floats:
    """K q + G - T at rest by the dense equations [3.8], shape (n + 1,) [N, N m]; without what a pin takes."""
    chain, motion = chain_of(cable), motion_of(q, np.zeros_like(q))
    return np.asarray(
        stiffness_matrix(chain) @ q + gravity_vector(chain, motion) - generalised_forces(chain, motion, inputs)
    )


def tangent_stiffness(cable: Cable, q: Floats, inputs: Mapping[str, float], *, step: float = 1e-5) -> Floats:
    """Derivative of the missing forces by central differences; of a pinned cable, in a basis of what its pin allows.

    What the pin gives, R, is a load that stays as it is while the cable moves a little, so its moments are part of what
    changes.
    """
    pinned = cable.terminal is Terminal.PIN
    through = Reference(cable).joint_forces(q, np.zeros_like(q), inputs)[-1] if pinned else np.zeros(2)

    def forces(at: Floats) -> Floats:
        return missing_forces(cable, at, inputs) + end_jacobian(cable, at).T @ through

    shift = step * np.eye(len(q))
    matrix = np.array([forces(q + by) - forces(q - by) for by in shift]) / (2.0 * step)
    basis = null_space(end_jacobian(cable, q)) if pinned else np.eye(len(q))
    return np.asarray(basis.T @ (0.5 * (matrix + matrix.T)) @ basis)
