"""Random but physical cables, states and inputs, for checks that must hold for every cable."""

from __future__ import annotations

import numpy as np

from cablefmu.cable import Cable, Drag, Floats, Links, Terminal

__all__ = ["KINDS", "random_cable", "random_inputs", "random_state"]

KINDS = [
    (terminal, water, drag)
    for terminal in Terminal
    for water in (False, True)
    for drag in ((Drag.COEFFICIENT, Drag.PER_LINK, Drag.NONE) if water else (Drag.NONE,))
]
"""Every (terminal, water, drag) that a scene can have."""


def random_cable(
    rng: np.random.Generator,
    n: int,
    terminal: Terminal,
    water: bool,
    *,
    drag: Drag | None = None,
    uneven: bool = True,
) -> Cable:
    """A cable of `n` links with every parameter of its kind drawn at random.

    Parameters
    ----------
    terminal, water, drag
        The kind; drag is by coefficient in water and none in air unless given.
    uneven
        Links differ in everything, and each of k_joint, c_joint, Cd is a common value (a parameter)
        only by the toss of a coin; else all links are equal and the three are always parameters.
    """
    kind = drag if drag is not None else (Drag.COEFFICIENT if water else Drag.NONE)
    if not water and kind is not Drag.NONE:
        raise ValueError("a cable in air has no drag")
    parameters = {
        "g": 9.81,
        "M_1": _spread(rng, 100.0, 1e4),
        "k_m1": _spread(rng, 100.0, 1e4),
        "c_m1": _spread(rng, 10.0, 1e3),
        "static_load": rng.uniform(0.0, 5e3),
    }
    if water:
        parameters["rho_w"] = rng.uniform(990.0, 1030.0)
    links = _random_links(rng, n, kind, water, uneven, parameters)
    parameters |= _random_terminal(rng, terminal, water)
    reach, angle = links.length.sum(), rng.uniform(-1.0, 1.0)
    placed = terminal in (Terminal.ANCHOR_SPRING, Terminal.FLOATER, Terminal.PIN)
    shape = np.concatenate([[0.0], np.full(n, angle)])
    inputs = _INPUTS[terminal] if rng.random() < 0.5 else _INPUTS[terminal] + _OPTIONAL_INPUTS[terminal]
    return Cable(
        name=f"random-{terminal}-{n}",
        links=links,
        terminal=terminal,
        drag=kind,
        parameters=parameters,
        inputs=inputs,
        position=shape + 0.1 * rng.uniform(-1.0, 1.0, n + 1),
        velocity=0.1 * rng.uniform(-1.0, 1.0, n + 1),
        rest_position=(float(reach * np.sin(angle)), float(reach * np.cos(angle))) if placed else (0.0, 0.0),
        input_start={inputs[0]: rng.uniform(-1e3, 1e3)},
    )


def random_state(rng: np.random.Generator, cable: Cable) -> tuple[Floats, Floats]:
    """(q, v) anywhere: every angle up to half a turn, rates up to 1 rad/s, 2 m and 2 m/s of heave.

    A pin may be far from P_n: the equation of motion holds off the constraint as well.
    """
    q = np.concatenate([[rng.uniform(-2.0, 2.0)], rng.uniform(-np.pi, np.pi, cable.n)])
    v = np.concatenate([[rng.uniform(-2.0, 2.0)], rng.uniform(-1.0, 1.0, cable.n)])
    return q, v


def random_inputs(rng: np.random.Generator, cable: Cable) -> dict[str, float]:
    """A force up to 1 kN on every input that the cable has [N]."""
    return {name: rng.uniform(-1e3, 1e3) for name in cable.inputs}


_INPUTS: dict[Terminal, tuple[str, ...]] = {
    Terminal.LOAD: ("u_m1", "F_cx", "F_cy"),
    Terminal.ANCHOR_MASS: ("u_m1",),
    Terminal.ANCHOR_SPRING: ("u_m1",),
    Terminal.FLOATER: ("u_m1", "u_m2"),
    Terminal.PIN: ("u_m1",),
}
_OPTIONAL_INPUTS: dict[Terminal, tuple[str, ...]] = {
    Terminal.LOAD: (),
    Terminal.ANCHOR_MASS: (),
    Terminal.ANCHOR_SPRING: (),
    Terminal.FLOATER: ("F_cx",),
    Terminal.PIN: (),
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
    """The terminal's parameters: none of a pin, else a mass of 10 kg to 10 t, and what else its kind has."""
    if terminal is Terminal.PIN:
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
