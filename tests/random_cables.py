"""Random but physical cables, states and inputs, for checks that must hold for every cable."""

from __future__ import annotations

import numpy as np

from cablefmu.cable import Cable, Drag, Floats, Links, Terminal, Top

__all__ = ["KINDS", "PORTS", "TERMINALS", "random_cable", "random_inputs", "random_state"]

TERMINALS = tuple(terminal for terminal in Terminal if terminal is not Terminal.MOTION)
"""Those whose motion is not given."""
_SURROUNDINGS = [(False, Drag.NONE), *((True, drag) for drag in (Drag.COEFFICIENT, Drag.PER_LINK, Drag.NONE))]
KINDS = [(terminal, water, drag) for terminal in TERMINALS for water, drag in _SURROUNDINGS]
"""Every (terminal, water, drag) under a floater that heaves and does nothing else."""
PORTS = [
    (top, terminal, water, drag)
    for top in Top
    for terminal in Terminal
    for water, drag in _SURROUNDINGS
    if top is not Top.FLOATER or terminal not in TERMINALS
]
"""Every (top, terminal, water, drag) beyond these: a top that is free, or an end whose motion is given."""


def random_cable(
    rng: np.random.Generator,
    n: int,
    terminal: Terminal,
    water: bool,
    *,
    top: Top = Top.FLOATER,
    drag: Drag | None = None,
    uneven: bool = True,
) -> Cable:
    """A cable of `n` links with every parameter of its kind drawn at random.

    Parameters
    ----------
    terminal, water, top, drag
        The kind; drag is by coefficient in water and none in air unless given.
    uneven
        Links differ in everything, and each of k_joint, c_joint, Cd is a common value (a parameter)
        only by the toss of a coin; else all links are equal and the three are always parameters.
    """
    kind = drag if drag is not None else (Drag.COEFFICIENT if water else Drag.NONE)
    if not water and kind is not Drag.NONE:
        raise ValueError("a cable in air has no drag")
    parameters = {"g": 9.81}
    floater = {
        "M_1": _spread(rng, 100.0, 1e4),
        "k_m1": _spread(rng, 100.0, 1e4),
        "c_m1": _spread(rng, 10.0, 1e3),
        "static_load": rng.uniform(0.0, 5e3),
    }
    if top is Top.FREE:
        floater |= {
            "k_m1H": _spread(rng, 100.0, 1e4),
            "c_m1H": _spread(rng, 10.0, 1e3),
            "static_pull": rng.uniform(-2e3, 2e3),
        }
    if top is not Top.MOTION:
        parameters |= floater
    if water:
        parameters["rho_w"] = rng.uniform(990.0, 1030.0)
    links = _random_links(rng, n, kind, water, uneven, parameters)
    parameters |= _random_terminal(rng, terminal, water)
    reach, angle = links.length.sum(), rng.uniform(-1.0, 1.0)
    placed = terminal in (Terminal.ANCHOR_SPRING, Terminal.FLOATER, Terminal.PIN, Terminal.MOTION)
    rest = (float(reach * np.sin(angle)), float(reach * np.cos(angle))) if placed else (0.0, 0.0)
    shape = np.concatenate([[0.0], np.full(n, angle), [0.0]])[_own(top)]
    at_end = _INPUTS[terminal] if rng.random() < 0.5 else _INPUTS[terminal] + _OPTIONAL_INPUTS[terminal]
    inputs = _inputs(top, terminal, at_end)
    return Cable(
        name=f"random-{terminal}-{n}",
        links=links,
        terminal=terminal,
        drag=kind,
        parameters=parameters,
        inputs=inputs,
        position=shape + 0.1 * rng.uniform(-1.0, 1.0, len(shape)),
        velocity=0.1 * rng.uniform(-1.0, 1.0, len(shape)),
        rest_position=rest,
        input_start={name: _random_input(rng, name, rest) for name in inputs[:1]},
        top=top,
    )


def random_state(rng: np.random.Generator, cable: Cable) -> tuple[Floats, Floats]:
    """(q, v) anywhere: every angle up to half a turn, rates up to 1 rad/s, 2 m and 2 m/s of heave and of surge.

    A pin may be far from P_n: the equation of motion holds off the constraint as well.
    """

    def draw(angle: float) -> Floats:
        heave, angles = rng.uniform(-2.0, 2.0, int(cable.top is not Top.MOTION)), rng.uniform(-angle, angle, cable.n)
        return np.concatenate([heave, angles, rng.uniform(-2.0, 2.0, int(cable.top is Top.FREE))])

    return draw(np.pi), draw(1.0)


def random_inputs(rng: np.random.Generator, cable: Cable) -> dict[str, float]:
    """Every input: forces up to 1 kN, an end's motion up to 2 m about its rest, 2 m/s and 2 m/s^2."""
    return {name: _random_input(rng, name, cable.rest_position) for name in cable.inputs}


def _random_input(rng: np.random.Generator, name: str, rest: tuple[float, float]) -> float:
    """Of x_2 and y_2 about `rest`."""
    if name[-2:] not in ("_1", "_2"):
        return rng.uniform(-1e3, 1e3)
    return rng.uniform(-2.0, 2.0) + (rest["xy".index(name[0])] if name in ("x_2", "y_2") else 0.0)


def _own(top: Top) -> slice:
    """Which of (y_m, theta, x_m) are coordinates."""
    return {Top.FLOATER: slice(0, -1), Top.FREE: slice(None), Top.MOTION: slice(1, -1)}[top]


def _inputs(top: Top, terminal: Terminal, at_end: tuple[str, ...]) -> tuple[str, ...]:
    """All inputs in their order, `at_end` being the forces at the terminal."""

    def motion(port: int) -> tuple[str, ...]:
        return tuple(f"{kind}{axis}_{port}" for kind in ("", "v", "a") for axis in "xy")

    heaved: tuple[str, ...] = () if top is Top.MOTION else ("u_m1",)
    moved = {Top.FLOATER: (), Top.FREE: ("u_m1x",), Top.MOTION: motion(1)}[top]
    return (*heaved, *at_end, *moved, *(motion(2) if terminal is Terminal.MOTION else ()))


_INPUTS: dict[Terminal, tuple[str, ...]] = {
    Terminal.LOAD: ("F_cx", "F_cy"),
    Terminal.ANCHOR_MASS: (),
    Terminal.ANCHOR_SPRING: (),
    Terminal.FLOATER: ("u_m2",),
    Terminal.PIN: (),
    Terminal.MOTION: (),
}
_OPTIONAL_INPUTS: dict[Terminal, tuple[str, ...]] = {
    Terminal.LOAD: (),
    Terminal.ANCHOR_MASS: (),
    Terminal.ANCHOR_SPRING: (),
    Terminal.FLOATER: ("F_cx",),
    Terminal.PIN: (),
    Terminal.MOTION: (),
}


def _spread(rng: np.random.Generator, low: float, high: float) -> float:
    """Evenly spread over the orders of magnitude between two positive numbers."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _random_links(
    rng: np.random.Generator, n: int, drag: Drag, water: bool, uneven: bool, parameters: dict[str, float]
) -> Links:
    """Steel-like rods, 1 to 20 m long and 1 to 4 cm thick; common values go into `parameters`."""

    def draw(low: float, high: float, *, common: str = "") -> Floats:
        if uneven and not (common and rng.random() < 0.5):
            return rng.uniform(low, high, n)
        value = rng.uniform(low, high)
        if common:
            parameters[common] = value
        return np.full(n, value)

    length, diameter, density = draw(1.0, 20.0), draw(0.01, 0.04), draw(2000.0, 8000.0)
    section = np.pi * diameter**2 / 4
    mass = density * section * length
    nothing = np.zeros(n)
    if drag is Drag.COEFFICIENT:
        drag_area, coefficient = diameter * length, draw(0.5, 2.0, common="Cd")
    else:
        drag_area, coefficient = nothing, draw(1.0, 100.0) if drag is Drag.PER_LINK else nothing
    return Links(
        length=length,
        mass=mass,
        inertia=mass * length**2 / 12 * draw(0.8, 1.2),
        volume=section * length if water else nothing,
        joint_stiffness=draw(1.0, 1e3, common="k_joint"),
        joint_damping=draw(0.1, 20.0, common="c_joint"),
        drag_area=drag_area,
        drag=coefficient,
    )


def _random_terminal(rng: np.random.Generator, terminal: Terminal, water: bool) -> dict[str, float]:
    """The terminal's parameters: none where it is held, else a mass of 10 kg to 10 t, and what else its kind has."""
    if terminal in (Terminal.PIN, Terminal.MOTION):
        return {}
    mass = _spread(rng, 10.0, 1e4)
    if terminal is Terminal.FLOATER:
        return {"M_2": mass, **_random_springs(rng, ("k_m2V", "c_m2V", "k_m2H", "c_m2H"))}
    parameters = {"m_c": mass}
    if terminal is Terminal.ANCHOR_MASS:
        return parameters
    if water and rng.random() < 0.5:
        parameters["rho_c"] = rng.uniform(1100.0, 8000.0)
    elif water:
        parameters["V_c"] = mass / rng.uniform(1100.0, 8000.0)
    if terminal is Terminal.ANCHOR_SPRING:
        return parameters | _random_springs(rng, ("k_cH", "c_cH", "k_cV", "c_cV"))
    if rng.random() < 0.5:
        parameters["I_Rc"] = rng.uniform(1.0, 100.0)
    return parameters


def _random_springs(rng: np.random.Generator, names: tuple[str, str, str, str]) -> dict[str, float]:
    values = {name: _spread(rng, 100.0, 1e5) if name[0] == "k" else _spread(rng, 10.0, 1e4) for name in names}
    return values | {"static_load_2": rng.uniform(-2e3, 2e3), "static_pull_2": rng.uniform(-2e3, 2e3)}
