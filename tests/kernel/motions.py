"""What tests of motions share: places and speeds from the angles, forces as waves, one way to write a scene."""

from __future__ import annotations

import math

import numpy as np

from cablefmu.cable import Cable, Floats, SolverChoice, Terminal
from cablefmu.scene import Scene
from cablefmu.signals import Constant, Sine, Steps
from tests.kernel.library import Run, Wave

__all__ = ["SOLVERS", "make_scene", "places", "speeds", "state", "waves_of", "work"]

SOLVERS = tuple(SolverChoice)


def state(run: Run) -> Floats:
    """(q, v)"""
    return np.concatenate([run.q, run.v])


def places(cable: Cable, q: Floats) -> Floats:
    """P_0 ... P_n from heave and angles alone, shape (n + 1, 2) [m]."""
    length, theta = cable.links.length, q[1:]
    x, y = np.cumsum(length * np.sin(theta)), np.cumsum(length * np.cos(theta))
    return np.stack([np.append(0.0, x), q[0] + np.append(0.0, y)], axis=1)


def speeds(cable: Cable, q: Floats, v: Floats) -> Floats:
    """Of P_0 ... P_n, shape (n + 1,) [m/s]."""
    swing, theta = cable.links.length * v[1:], q[1:]
    x, y = np.cumsum(swing * np.cos(theta)), np.cumsum(-swing * np.sin(theta))
    return np.asarray(np.hypot(np.append(0.0, x), v[0] + np.append(0.0, y)), dtype=float)


def waves_of(scene: Scene) -> dict[str, Wave]:
    """The scene's forces, those of its start where they are constant or jump, or a sine from t = 0 on."""
    waves: dict[str, Wave] = {}
    for name, signal in scene.signals.items():
        if isinstance(signal, (Constant, Steps)):
            waves[name] = (signal(0.0), 0.0, 0.0)
        else:
            assert isinstance(signal, Sine) and signal.phase == 0.0 and signal.start is None
            waves[name] = (signal.offset, signal.amplitude, 2.0 * math.pi * signal.frequency)
    return waves


def work(run: Run) -> float:
    """What a run cost, in attempts of the explicit method, whatever the machine: an attempt is six right-hand sides.

    An implicit attempt counts four times. Right-hand sides beyond those of attempts were for starts and for looks at
    stiffness: one each, and a look costs no more than an attempt, as which it counts.
    """
    count = run.counters
    attempts, implicit = count["steps"] + count["rejected"], count["jacobians"]
    own = 6.0 * (attempts - implicit) + 8.0 * implicit
    return attempts + 3.0 * implicit + max(count["rhs"] - own, 0.0)


_TERMINALS = {
    Terminal.LOAD: 'kind = "load"\nmass = 60.0\nvolume = 1e-9',
    Terminal.ANCHOR_MASS: 'kind = "anchor-mass"\nmass = 8e8',
    Terminal.ANCHOR_SPRING: """kind = "anchor-spring"
mass = 60.0
volume = 1e-9
stiffness_horizontal = 120e3
damping_horizontal = 7920.0
stiffness_vertical = 120e3
damping_vertical = 7920.0""",
    Terminal.FLOATER: """kind = "floater"
mass = 6000.0
stiffness_horizontal = 1200.0
damping_horizontal = 237.6
stiffness_vertical = 1200.0
damping_vertical = 237.6""",
    Terminal.PIN: 'kind = "pin"',
}


def make_scene(
    terminal: Terminal,
    links: int,
    *,
    length: float = 240.0,
    diameter: float = 0.02,
    bending: float = 628.3,
    damping: float = 2.8,
    angle: float | None = None,
    end: tuple[float, float] = (0.5, 0.8),
    water: bool = True,
) -> Scene:
    """A steel cable between a floater of 6 t and a terminal, written as a scene's text.

    Parameters
    ----------
    length, diameter
        Of the cable [m].
    bending
        EI of the beam that its joints stand for [N m^2].
    damping
        Of a joint [N m s/rad].
    angle
        Of all links at the start [rad]; None for the discrete catenary, from (0, 0) to the terminal.
    end
        Where the terminal is then, as shares of the length; so is the rest position of its springs.
    """
    placed = terminal is not Terminal.LOAD
    position = f"position = [{end[0] * length!r}, {end[1] * length!r}]"
    shape = 'kind = "catenary"' if angle is None else f'kind = "straight"\nangle = {angle!r}'
    return Scene.from_text(
        f"""format = 1
description = "A cable to be tested"
[cable]
links = {links}
length = {length!r}
diameter = {diameter!r}
density = 7850.0
joint_stiffness = {links * bending / length!r}
joint_damping = {damping!r}
{"[water]" if water else ""}
{"Cd = 1.2" if water else ""}
[top]
kind = "floater"
mass = 6000.0
stiffness = 1200.0
damping = 237.6
[terminal]
{_TERMINALS[terminal] if water else _TERMINALS[terminal].replace("volume = 1e-9", "")}
{position if placed else ""}
[shape]
{shape}
[run]
stop_time = 10.0
""",
        name="tested",
    )
