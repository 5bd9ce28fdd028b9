"""From a validated scene to the numbers of a `Cable`: masses, stiffnesses, preloads, the start.

The preloads make the rest shape an equilibrium. Between two ports this is the discrete catenary with its pull
(H, V) at the top: floater 1 is carried with static_load = V, and the terminal's springs pull with
static_pull_2 = H and static_load_2 = (terminal's submerged weight) - (V - W), W being the cable's weight.
The dissertation's G_1 = 0 [5.6] is the special case of a hanging load, static_load = all the weight.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cablefmu import scene_schema as schema
from cablefmu.cable import Cable, Drag, Floats, Initial, Links, SolverChoice, Terminal, Top
from cablefmu.scene_mistakes import Mistake, MistakeFoundError
from cablefmu.shapes import END_TOLERANCE, Catenary, NoCatenaryError, catenary, end_point, ending_at, straight
from cablefmu.signals import Signal

__all__ = ["assemble", "bending_stiffness"]

_UNPLACED = (schema.LoadTable, schema.AnchorMassTable)
"""Terminals of whose place the equations of motion know nothing."""
_UNMOVED = (schema.AnchorMassTable, schema.PinTable, schema.MotionEndTable)
"""Terminals that hold the cable's end from the start."""

END_SLACK = 1e-3
"""How far from its anchor or pin a start shape may end, as a share of the cable: room for rounded angles."""


def assemble(name: str, spec: schema.Spec, signals: Mapping[str, Signal]) -> Cable:
    """Work out the cable of a scene.

    Parameters
    ----------
    name
        The scene's name.
    spec
        What the scene file says.
    signals
        Each input that the scene names over time, motions with their derivatives.

    Raises
    ------
    MistakeFoundError
        If the cable cannot hang where the scene wants it.
    """
    links = _links(spec)
    weights = _submerged(links.mass, links.volume, spec) * spec.gravity
    cable_weight = _cable_weight(spec, weights)
    terminal_weight = _terminal_mass(spec) * spec.gravity
    terminal = spec.terminal
    surges = getattr(spec.top, "surges", False)
    inputs = schema.inputs_of(spec.top.kind, surges, terminal.kind, getattr(terminal, "horizontal_force", False))
    input_start = _input_start(spec, inputs, signals)
    place = _place(spec, input_start)
    rest = _rest(spec, links.length, weights, place)
    angles = _angles(spec, rest)
    angles = _at_anchor(spec, links.length, angles, place)
    hung = (rest.horizontal, rest.vertical) if rest is not None else (0.0, cable_weight + terminal_weight)
    parameters = {
        "g": spec.gravity,
        **_top_parameters(spec.top, *hung),
        **_water_parameters(spec, links),
        **_joint_parameters(links),
        **_terminal_parameters(spec, rest, cable_weight, terminal_weight),
    }
    position = np.concatenate([[0.0][: isinstance(spec.top, schema.FloaterTopTable)], angles, [0.0][:surges]])
    return Cable(
        name=name,
        links=links,
        terminal=Terminal(terminal.kind),
        drag=_drag_kind(spec),
        parameters=parameters,
        inputs=inputs,
        position=position,
        velocity=np.zeros(len(position)),
        rest_position=(0.0, 0.0) if isinstance(terminal, _UNPLACED) else terminal.position,
        input_start=input_start,
        solver=SolverChoice(spec.run.solver),
        initial=Initial(spec.run.initial),
        top=Top.FREE if surges else Top(spec.top.kind),
    )


def _input_start(spec: schema.Spec, inputs: tuple[str, ...], signals: Mapping[str, Signal]) -> dict[str, float]:
    """What is not 0 by the file: named signals, and where a vessel at the lower end rests."""
    terminal = spec.terminal
    place = terminal.position if isinstance(terminal, schema.MotionEndTable) else ()
    at_rest = dict(zip(("x_2", "y_2"), place, strict=False))
    named = {key: signals[key](0.0) for key in inputs if key in signals}
    return {key: (at_rest | named)[key] for key in inputs if key in at_rest | named}


def _place(spec: schema.Spec, start: Mapping[str, float]) -> tuple[float, float]:
    """The lower port from the upper one, both where they are at the start [m]; (0, 0) for a load."""
    terminal = spec.terminal
    if isinstance(terminal, schema.LoadTable):
        return (0.0, 0.0)
    x, y = terminal.position
    x, y = start.get("x_2", x), start.get("y_2", y)
    return x - start.get("x_1", 0.0), y - start.get("y_1", 0.0)


def _top_parameters(top: schema.TopTable, horizontal: float, vertical: float) -> dict[str, float]:
    """Of floater 1, whose rest carries this pull of the cable [N]; none of a vessel."""
    if isinstance(top, schema.MotionTopTable):
        return {}
    static_load = vertical if top.static_load is None else top.static_load
    parameters = {"M_1": top.mass, "k_m1": top.stiffness, "c_m1": top.damping, "static_load": static_load}
    if top.stiffness_horizontal is None or top.damping_horizontal is None:
        return parameters
    static_pull = horizontal if top.static_pull is None else top.static_pull
    sideways = {"k_m1H": top.stiffness_horizontal, "c_m1H": top.damping_horizontal, "static_pull": static_pull}
    return parameters | sideways


# ---------------------------------------------------------------------------------------------------- links


def _spread(value: float | tuple[float, ...] | None, n: int) -> Floats:
    """One entry per link; zeros where the scene says nothing."""
    return np.full(n, value or 0.0) if not isinstance(value, tuple) else np.array(value, dtype=np.float64)


def _links(spec: schema.Spec) -> Links:
    cable, water = spec.cable, spec.water
    n = cable.links
    length = _spread(cable.link_length, n) if cable.length is None else np.full(n, cable.length / n)
    diameter = _spread(cable.diameter, n)
    volume = _volume(diameter, length)
    mass = _spread(cable.link_mass, n) if cable.density is None else _spread(cable.density, n) * volume
    if cable.young_modulus is None:
        stiffness = _spread(cable.joint_stiffness, n)
    else:
        stiffness = bending_stiffness(_spread(cable.young_modulus, n), diameter) / length
    by_coefficient = water is not None and water.Cd is not None
    drag = np.zeros(n) if water is None else _spread(water.Cd if by_coefficient else water.drag_per_link, n)
    return Links(
        length=length,
        mass=mass,
        inertia=mass * length**2 / 12.0,
        volume=volume,
        joint_stiffness=stiffness,
        joint_damping=_spread(cable.joint_damping, n),
        drag_area=diameter * length if by_coefficient else np.zeros(n),
        drag=drag,
    )


def _volume(diameter: Floats, length: Floats) -> Floats:
    return np.pi / 4.0 * diameter**2 * length


def bending_stiffness(young_modulus: Floats, diameter: Floats) -> Floats:
    """EI [N m^2] of a round cable; its joints have EI over the length of a link.

    Table 6.1: k_i = (5/6) E I_sec / l_i, I_sec = pi r^4 / 4.
    """
    second_moment = np.pi / 4.0 * (diameter / 2.0) ** 4
    return 5.0 / 6.0 * young_modulus * second_moment


def _cable_weight(spec: schema.Spec, weights: Floats) -> float:
    """Submerged, of all links [N]; where the cable is only shared out evenly, the same to the bit for every n."""
    cable = spec.cable
    if cable.length is None or not isinstance(cable.density, float) or not isinstance(cable.diameter, float):
        return float(np.sum(weights))
    volume = _volume(np.array([cable.diameter]), np.array([cable.length]))
    return float(_submerged(cable.density * volume, volume, spec)[0] * spec.gravity)


def _drag_kind(spec: schema.Spec) -> Drag:
    if spec.water is None:
        return Drag.NONE
    return Drag.COEFFICIENT if spec.water.Cd is not None else Drag.PER_LINK


def _submerged(mass: Floats, volume: Floats, spec: schema.Spec) -> Floats:
    """Weight-carrying mass m - rho_w V [kg]; in air m."""
    return mass - spec.water.density * volume if spec.water is not None else mass


def _terminal_mass(spec: schema.Spec) -> float:
    """Weight-carrying mass of the terminal [kg]: 0 for what floats, is neutrally buoyant or has no mass."""
    terminal = spec.terminal
    if isinstance(terminal, schema.AnchorMassTable | schema.FloaterTable | schema.PinTable | schema.MotionEndTable):
        return 0.0
    if spec.water is None:
        return terminal.mass
    volume = terminal.mass / terminal.density if terminal.density is not None else terminal.volume or 0.0
    return terminal.mass - spec.water.density * volume


# ---------------------------------------------------------------------------------------------------- shape


def _rest(spec: schema.Spec, length: Floats, weights: Floats, place: tuple[float, float]) -> Catenary | None:
    """Rest shape between the ports; None where the cable just hangs."""
    terminal = spec.terminal
    if isinstance(terminal, schema.LoadTable):
        return None
    try:
        return catenary(length, weights, place)
    except NoCatenaryError as reason:
        raise MistakeFoundError(Mistake("terminal.position", str(reason), list(terminal.position))) from None


def _angles(spec: schema.Spec, rest: Catenary | None) -> Floats:
    shape = spec.shape
    if isinstance(shape, schema.AnglesShape):
        return np.array(shape.angles)
    if isinstance(shape, schema.CatenaryShape) and rest is not None:
        return rest.angles
    return straight(spec.cable.links, shape.angle if isinstance(shape, schema.StraightShape) else 0.0)


def _at_anchor(spec: schema.Spec, length: Floats, angles: Floats, place: tuple[float, float]) -> Floats:
    """What does not move stands where it stands: a shape that ends elsewhere would move it; rounding is mended."""
    if not isinstance(spec.terminal, _UNMOVED):
        return angles
    position = list(spec.terminal.position)
    is_exact = not isinstance(spec.terminal, schema.AnchorMassTable)
    total = float(np.sum(length))
    if _miss(length, angles, place) > END_SLACK * total:
        x, y = end_point(length, angles)
        what = {"pin": "pin", "motion": "vessel"}.get(spec.terminal.kind, "anchor")
        text = f'the start shape ends at ({x:.6g}, {y:.6g}) m, not at the {what}; use kind = "catenary"'
        raise MistakeFoundError(Mistake("terminal.position", text, position))
    if not is_exact or isinstance(spec.shape, schema.CatenaryShape):
        return angles
    angles = ending_at(length, angles, place)
    if _miss(length, angles, place) > END_TOLERANCE * total:
        text = 'links near the start shape do not reach the pin; use kind = "catenary"'
        raise MistakeFoundError(Mistake("terminal.position", text, position))
    return angles


def _miss(length: Floats, angles: Floats, position: tuple[float, float]) -> float:
    """How far the chain ends from a place [m]."""
    return float(np.hypot(*np.subtract(end_point(length, angles), position)))


# ----------------------------------------------------------------------------------------------- parameters


def _common(values: Floats) -> float | None:
    """The one value of all links, None if they differ."""
    return float(values[0]) if np.all(values == values[0]) else None


def _water_parameters(spec: schema.Spec, links: Links) -> dict[str, float]:
    if spec.water is None:
        return {}
    coefficient = _common(links.drag) if spec.water.Cd is not None else None
    return {"rho_w": spec.water.density} | ({"Cd": coefficient} if coefficient is not None else {})


def _joint_parameters(links: Links) -> dict[str, float]:
    common = {"k_joint": _common(links.joint_stiffness), "c_joint": _common(links.joint_damping)}
    return {name: value for name, value in common.items() if value}


def _terminal_parameters(
    spec: schema.Spec, rest: Catenary | None, cable_weight: float, terminal_weight: float
) -> dict[str, float]:
    terminal = spec.terminal
    if isinstance(terminal, schema.PinTable | schema.MotionEndTable):
        return {}
    if isinstance(terminal, schema.AnchorMassTable):
        return {"m_c": terminal.mass}
    if isinstance(terminal, schema.LoadTable):
        inertia = {"I_Rc": terminal.rotary_inertia} if terminal.rotary_inertia else {}
        return {"m_c": terminal.mass, **inertia, **_buoyancy(terminal)}
    assert rest is not None  # every terminal but a load has a position
    preload = {
        "static_load_2": terminal_weight - (rest.vertical - cable_weight),
        "static_pull_2": rest.horizontal,
    }
    horizontal, vertical = "m2H", "m2V"
    head: dict[str, float] = {"M_2": terminal.mass}
    if isinstance(terminal, schema.AnchorSpringTable):
        horizontal, vertical = "cH", "cV"
        head = {"m_c": terminal.mass, **_buoyancy(terminal)}
    return {
        **head,
        f"k_{vertical}": terminal.stiffness_vertical,
        f"c_{vertical}": terminal.damping_vertical,
        f"k_{horizontal}": terminal.stiffness_horizontal,
        f"c_{horizontal}": terminal.damping_horizontal,
        **preload,
    }


def _buoyancy(terminal: schema.LoadTable | schema.AnchorSpringTable) -> dict[str, float]:
    """What the terminal's submerged weight depends on; nothing in air, where the schema allows neither."""
    if terminal.density is not None:
        return {"rho_c": terminal.density}
    return {"V_c": terminal.volume} if terminal.volume is not None else {}
