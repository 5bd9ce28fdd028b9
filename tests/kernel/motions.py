"""What tests of motions share: places and speeds from the angles, forces as waves, one way to write a scene."""

from __future__ import annotations

import math

import numpy as np

from cablefmu.cable import Cable, Floats, SolverChoice, Terminal, Top
from cablefmu.scene import Scene
from cablefmu.signals import Constant, Derivative, Sine, Steps
from tests.kernel.library import Run, Wave

__all__ = ["SOLVERS", "make_scene", "places", "speeds", "state", "waves_of", "work"]

SOLVERS = tuple(SolverChoice)


def state(run: Run) -> Floats:
    """(q, v)"""
    return np.concatenate([run.q, run.v])


def places(cable: Cable, q: Floats) -> Floats:
    """P_0 ... P_n from q alone, shape (n + 1, 2) [m]; from P_0 where that is given."""
    length, theta = cable.links.length, cable.angles_in(q)
    x, y = np.cumsum(length * np.sin(theta)), np.cumsum(length * np.cos(theta))
    return _top(cable, q) + np.stack([np.append(0.0, x), np.append(0.0, y)], axis=1)


def _top(cable: Cable, q: Floats) -> Floats:
    """(x, y) of the floater, in q or its rate."""
    surge = q[-1] if cable.top is Top.FREE else 0.0
    return np.array([surge, 0.0 if cable.top is Top.MOTION else q[0]])


def speeds(cable: Cable, q: Floats, v: Floats) -> Floats:
    """Of P_0 ... P_n, shape (n + 1,) [m/s]; against P_0 where that is given."""
    swing, theta = cable.links.length * cable.angles_in(v), cable.angles_in(q)
    x, y = np.cumsum(swing * np.cos(theta)), np.cumsum(-swing * np.sin(theta))
    top = _top(cable, v)
    return np.asarray(np.hypot(top[0] + np.append(0.0, x), top[1] + np.append(0.0, y)), dtype=float)


def waves_of(scene: Scene) -> dict[str, Wave]:
    """The scene's inputs, those of its start where they are constant or jump, or a sine and its derivatives."""
    waves: dict[str, Wave] = {}
    for name, signal in scene.signals.items():
        if isinstance(signal, (Constant, Steps)):
            waves[name] = (signal(0.0), 0.0, 0.0)
            continue
        of, order = (signal.of, signal.order) if isinstance(signal, Derivative) else (signal, 0)
        assert isinstance(of, Sine) and of.start is None
        pulsation = 2.0 * math.pi * of.frequency
        phase = of.phase + order * math.pi / 2.0  # each derivative is a quarter turn ahead
        waves[name] = (0.0 if order else of.offset, of.amplitude * pulsation**order, pulsation, phase)
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
