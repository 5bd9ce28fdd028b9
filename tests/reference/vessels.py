"""Motions that vessels give to the ends of a cable, and cables that follow them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cablefmu.cable import Cable, Terminal, Top
from cablefmu.reference.chain import chain_of
from cablefmu.shapes import end_point
from tests.random_cables import random_cable

__all__ = ["Way", "given", "slack", "swaying", "towed", "without_first_joint"]

Way = Callable[[float], dict[str, float]]
"""Inputs that give an end's motion, over time [s]"""


def swaying(port: int, rest: tuple[float, float] = (0.0, 0.0)) -> Way:
    """A vessel that goes round an ellipse of 0.8 m by 1.2 m in 4 s, starting with the crest."""

    def motion(t: float) -> dict[str, float]:
        w = 0.5 * np.pi
        x, y = 0.4 * np.sin(w * t), 0.6 * np.cos(w * t)
        vx, vy = 0.4 * w * np.cos(w * t), -0.6 * w * np.sin(w * t)
        values = rest[0] + x, rest[1] + y, vx, vy, -w * w * x, -w * w * y
        return {f"{name}_{port}": float(v) for name, v in zip(("x", "y", "vx", "vy", "ax", "ay"), values, strict=True)}

    return motion


def given(port: int, place: Any, velocity: Any, acceleration: Any) -> dict[str, Any]:
    """Inputs that give an end's motion."""
    kinds = {"": place, "v": velocity, "a": acceleration}
    return {f"{kind}{axis}_{port}": value[i] for kind, value in kinds.items() for i, axis in enumerate("xy")}


def towed(n: int, terminal: Terminal, water: bool, seed: int, **changes: float) -> Cable:
    """A random cable whose top's motion is given."""
    cable = random_cable(np.random.default_rng([n, seed]), n, terminal, water, top=Top.MOTION)
    return replace(cable, parameters=cable.parameters | changes)


def slack(cable: Cable) -> Cable:
    """The same cable in an arc, whose end is some 0.2 m off its place and does not move as that does."""
    arc = np.linspace(-0.3, 1.4, cable.n)
    top = int(cable.top is not Top.MOTION)
    position = cable.position.copy()
    position[top : top + cable.n] = arc
    x, y = end_point(cable.links.length, arc)
    return replace(cable, position=position, rest_position=(x - 0.15, y + 0.1))


def without_first_joint(cable: Cable) -> Cable:
    """The cable hinged at the top; nothing else in it knows which way is down but weights."""
    parameters = {name: value for name, value in cable.parameters.items() if name not in ("k_joint", "c_joint")}
    chain = chain_of(cable)
    stiffness, damping = (np.append(0.0, values[1:]) for values in (chain.stiffness, chain.damping))
    links = replace(cable.links, joint_stiffness=stiffness, joint_damping=damping)
    return replace(cable, parameters=parameters, links=links)
