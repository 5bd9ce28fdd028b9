"""The equations of one scene as formulas: those terms that it has, and no other.

Newton and Euler for every link, with the forces R_i in the joints; docs/model.md has the same for all scenes, and what
the kernel solves. Formulas are in the TeX of `mathml`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass

import numpy as np

from ..cable import Cable, Drag, Terminal, Top
from .variables import Variable

__all__ = ["Topic", "equations_of"]


@dataclass(frozen=True, slots=True)
class Topic:
    """Some formulas and what their letters mean."""

    title: str
    formulas: tuple[str, ...]
    """Lines; what \\quad separates need not stand on one."""
    words: str
    """HTML without formulas; what stands in `backquotes` is code, in $dollars$ a formula."""


def equations_of(cable: Cable, variables: Sequence[Variable]) -> list[Topic]:
    """All topics of a scene, in the order of a reader.

    Parameters
    ----------
    cable
        The scene's numbers.
    variables
        Of the FMU: outputs that it does not have are not explained.
    """
    outputs = {variable.name for variable in variables if variable.causality == "output"}
    topics = [_geometry(cable), _links(cable)]
    if _has_joints(cable):
        topics.append(_joints(cable, {variable.name for variable in variables}))
    if cable.drag is not Drag.NONE:
        topics.append(_drag(cable))
    topics += [_top(cable), _ENDS[cable.terminal](cable)]
    tensions = [name for name in _TENSIONS if name in outputs]
    if tensions:
        words = "Negative where the cable is pushed together."
        topics.append(Topic("Tensions", tuple(_TENSIONS[name] for name in tensions), words))
    if "energy" in outputs:
        topics.append(_energy(cable))
    return topics


def _geometry(cable: Cable) -> Topic:
    top, state, rates = {
        Top.FLOATER: (r"(0, y_{m1})", "$y_{m1}$, all $θ_i$", "away from floater 1"),
        Top.FREE: (r"(x_{m1}, y_{m1})", "$y_{m1}$, all $θ_i$, $x_{m1}$", "away from floater 1"),
        Top.MOTION: (r"(x_1, y_1)", "all $θ_i$", "away from the vessel at the top"),
    }[cable.top]
    return Topic(
        "Geometry",
        (
            r"\vec{e}_i = (\sin θ_i, \cos θ_i) \quad \vec{n}_i = (\cos θ_i, -\sin θ_i)",
            rf"\vec{{P}}_0 = {top} \quad " r"\vec{P}_i = \vec{P}_{i-1} + l_i \vec{e}_i",
            r"\vec{p}_i = \frac{1}{2} (\vec{P}_{i-1} + \vec{P}_i) \quad i = 1 \dots n",
        ),
        rf"$\vec{{e}}_i$ points along link i, {rates}, "
        r"$\vec{n}_i$ across it; $\vec{P}_i$ are the joints,"
        rf" $\vec{{p}}_i$ the links' centres. The end of the cable is $\vec{{P}}_n = (x_c, y_c)$. The"
        f" state is {state}, and their rates.",
    )


def _has_joints(cable: Cable) -> bool:
    return bool(np.any(cable.links.joint_stiffness) or np.any(cable.links.joint_damping))


def _links(cable: Cable) -> Topic:
    drag = r" + \vec{f}_i" if cable.drag is not Drag.NONE else ""
    torques = "T_{i+1} - T_i - " if _has_joints(cable) else "-"
    inertia = r" $I_n$ includes the load's `I_Rc`." if "I_Rc" in cable.parameters else ""
    weight, volume = (r"(m_i - ρ_w V_i) g", " and displaced volume $V_i$") if cable.in_water else ("m_i g", "")
    return Topic(
        "Every link",
        (
            rf"m_i \ddot{{\vec{{p}}}}_i = \vec{{R}}_i - \vec{{R}}_{{i+1}} + (0, w_i){drag} \quad w_i = {weight}",
            rf"I_i \ddot{{θ}}_i = {torques}\frac{{l_i}}{{2}} \vec{{n}}_i \cdot (\vec{{R}}_i + \vec{{R}}_{{i+1}})",
        ),
        rf"$\vec{{R}}_i$ is the force through joint i, at the top of link i, on that link. Link i has length $l_i$,"
        rf" mass $m_i${volume}, and $I_i = m_i l_i^2 / 12$.{inertia}",
    )


def _joints(cable: Cable, names: Set[str]) -> Topic:
    terms, same = [], []
    if np.any(cable.links.joint_stiffness):
        terms.append(r"k_i (θ_i - θ_{i-1})")
        same += ["$k_i$ is `k_joint`"] if "k_joint" in cable.parameters else []
        same += ["$k_i$ is `EI` over $l_i$"] if "EI" in names else []
    if np.any(cable.links.joint_damping):
        terms.append(r"c_i (\dot{θ}_i - \dot{θ}_{i-1})")
        same += ["$c_i$ is `c_joint`"] if "c_joint" in cable.parameters else []
    words = f" In every joint {' and '.join(same)}." if same else ""
    return Topic(
        "Joints",
        (f"T_i = {' + '.join(terms)} \\quad T_{{n+1}} = 0",),
        rf"{'The vessel at the top' if cable.top is Top.MOTION else 'Floater 1'} does not turn: $θ_0 = 0$.{words}",
    )


def _drag(cable: Cable) -> Topic:
    if cable.drag is Drag.PER_LINK:
        factor, words = "c_{v,i}", "$c_{v,i}$ is given for each link."
    else:
        factor = r"\frac{1}{2} ρ_w C_{d,i} D_i l_i"
        words = "$D_i$ is the diameter" + (
            ", and $C_{d,i}$ is `Cd` for every link." if "Cd" in cable.parameters else "; links differ in $C_{d,i}$."
        )
    return Topic(
        "Drag",
        (rf"\vec{{f}}_i = - {factor} |v_i| v_i \vec{{n}}_i \quad v_i = \vec{{n}}_i \cdot \dot{{\vec{{p}}}}_i",),
        f"Normal to each link, at its centre. {words}",
    )


def _top(cable: Cable) -> Topic:
    return {Top.FLOATER: _floater_1, Top.FREE: _free_floater, Top.MOTION: _vessel_1}[cable.top]()


def _vessel_1() -> Topic:
    return Topic(
        "Vessel at the top",
        (
            r"\ddot{\vec{P}}_0 = (a_{x1}, a_{y1}) \quad \dot{\vec{P}}_0 = (v_{x1}, v_{y1})",
            r"(F_{1x}, F_{1y}) = -\vec{R}_1",
        ),
        "It moves as the inputs `x_1`, `y_1`, `vx_1`, `vy_1`, `ax_1`, `ay_1` say; `F_1x`, `F_1y` is what the cable"
        " does to it. The moment of joint 1 is not passed on.",
    )


def _free_floater() -> Topic:
    heave = _floater_1()
    surge = r"M_1 \ddot{x}_{m1} + c_{m1H} \dot{x}_{m1} + k_{m1H} x_{m1} = u_{m1x} - \name{static_pull} - R_{1,x}"
    words = "It heaves and surges. `static_load` and `static_pull` are what buoyancy and mooring carry at rest."
    return Topic(heave.title, (*heave.formulas, surge), words)


def _floater_1() -> Topic:
    return Topic(
        "Floater 1",
        (r"M_1 \ddot{y}_{m1} + c_{m1} \dot{y}_{m1} + k_{m1} y_{m1} = u_{m1} - \name{static_load} - R_{1,y}",),
        "It heaves and does nothing else. `static_load` is what its buoyancy carries at rest besides its own weight.",
    )


# --- the end of the cable ---


def _weight(cable: Cable) -> str:
    """Formula of the terminal's weight in the scene."""
    return r"w_c = (m_c - ρ_w V_c) g" if cable.in_water else r"w_c = m_c g"


def _volume(cable: Cable) -> str:
    return r" $V_c = m_c / ρ_c$, with $ρ_c$ `rho_c`." if "rho_c" in cable.parameters else ""


def _load(cable: Cable) -> Topic:
    return Topic(
        "Load",
        (rf"m_c \ddot{{\vec{{P}}}}_n = \vec{{R}}_{{n+1}} + (F_{{cx}}, F_{{cy}} + w_c) \quad {_weight(cable)}",),
        f"A point mass.{_volume(cable)}",
    )


def _anchor_mass(cable: Cable) -> Topic:
    formula = r"m_c \ddot{\vec{P}}_n = \vec{R}_{n+1}"
    return Topic("Anchor", (formula,), "A neutrally buoyant mass, so large that it hardly moves.")


_X, _Y = r"(x_c - x_0)", r"(y_c - y_0)"


def _anchor_spring(cable: Cable) -> Topic:
    return Topic(
        "Anchor",
        (
            rf"m_c \ddot{{x}}_c = R_{{n+1,x}} + \name{{static_pull_2}} - k_{{cH}} {_X} - c_{{cH}} \dot{{x}}_c",
            rf"m_c \ddot{{y}}_c = R_{{n+1,y}} + w_c - \name{{static_load_2}} - k_{{cV}} {_Y} - c_{{cV}} \dot{{y}}_c",
            _weight(cable),
        ),
        _rest(cable) + _volume(cable),
    )


def _floater_2(cable: Cable) -> Topic:
    pushed = "F_{cx} + " if "F_cx" in cable.inputs else ""
    sideways = rf"{pushed}\name{{static_pull_2}} - k_{{m2H}} {_X} - c_{{m2H}} \dot{{x}}_c"
    upright = rf"u_{{m2}} - \name{{static_load_2}} - k_{{m2V}} {_Y} - c_{{m2V}} \dot{{y}}_c"
    return Topic(
        "Floater 2",
        (
            rf"M_2 \ddot{{x}}_c = R_{{n+1,x}} + {sideways}",
            rf"M_2 \ddot{{y}}_c = R_{{n+1,y}} + {upright}",
        ),
        "Its buoyancy carries its weight. " + _rest(cable),
    )


def _rest(cable: Cable) -> str:
    x, y = cable.rest_position
    return f"The springs rest at $(x_0, y_0)$ = ({x:.8g}, {y:.8g}) m; their preloads carry the cable's pull there."


def _pin(cable: Cable) -> Topic:
    x, y = cable.rest_position
    return Topic(
        "Pin",
        (r"\ddot{\vec{P}}_n = -2 ω \dot{\vec{P}}_n - ω^2 (\vec{P}_n - \vec{P}_\name{pin}) \quad ω = 10 \name{1/s}",),
        rf"The end stays at $\vec{{P}}_\name{{pin}}$ = ({x:.8g}, {y:.8g}) m by whatever force that takes, which is"
        r" $-\vec{R}_{n+1}$. On the pin the right-hand side is zero; errors of the integration it leads back.",
    )


def _vessel_2(cable: Cable) -> Topic:
    x, y = (
        rf"\ddot{{{axis}}}_c = a_{{{axis}2}} - 2 ω (\dot{{{axis}}}_c - v_{{{axis}2}}) - ω^2 ({axis}_c - {axis}_2)"
        for axis in "xy"
    )
    return Topic(
        "Vessel at the lower end",
        (x, rf"{y} \quad ω = 10 \name{{1/s}}", r"(F_{2x}, F_{2y}) = \vec{R}_{n+1}"),
        "The end follows the inputs `x_2`, `y_2`, `vx_2`, `vy_2`, `ax_2`, `ay_2`; `F_2x`, `F_2y` is what the cable"
        " does to the vessel there. Where the end follows exactly, only the acceleration is left; errors of the"
        " integration are led back.",
    )


_ENDS = {
    Terminal.MOTION: _vessel_2,
    Terminal.LOAD: _load,
    Terminal.ANCHOR_MASS: _anchor_mass,
    Terminal.ANCHOR_SPRING: _anchor_spring,
    Terminal.FLOATER: _floater_2,
    Terminal.PIN: _pin,
}

# --- outputs ---

_TENSIONS = {
    "tension_top": r"\name{tension_top} = -\vec{R}_1 \cdot \vec{e}_1",
    "tension_end": r"\name{tension_end} = -\vec{R}_{n+1} \cdot \vec{e}_n",
    "tension_max": r"\name{tension_max} = \max_i (-\vec{R}_i \cdot \vec{e}_i, -\vec{R}_{i+1} \cdot \vec{e}_i)",
}


def _energy(cable: Cable) -> Topic:
    return Topic(
        "Energy",
        (r"\name{energy} = " + " + ".join(_kinetic(cable)), *_potential(cable)),
        "External forces are not part of it: it changes by their work and by what damping takes.",
    )


def _kinetic(cable: Cable) -> Iterator[str]:
    if cable.top is not Top.MOTION:
        yield r"\frac{1}{2} M_1 \dot{y}_{m1}^2"
    if cable.top is Top.FREE:
        yield r"\frac{1}{2} M_1 \dot{x}_{m1}^2"
    yield r"\sum_i (\frac{1}{2} m_i |\dot{\vec{p}}_i|^2 + \frac{1}{2} I_i \dot{θ}_i^2)"
    mass = {Terminal.FLOATER: "M_2", Terminal.PIN: "", Terminal.MOTION: ""}.get(cable.terminal, "m_c")
    if mass:
        yield rf"\frac{{1}}{{2}} {mass} |\dot{{\vec{{P}}}}_n|^2"


def _potential(cable: Cable) -> Iterator[str]:
    """Lines that go on where the kinetic energy ends."""
    if np.any(cable.links.joint_stiffness):
        yield r"+ \sum_i \frac{1}{2} k_i (θ_i - θ_{i-1})^2"
    if cable.top is not Top.MOTION:
        yield r"+ \frac{1}{2} k_{m1} y_{m1}^2 + \name{static_load} \cdot y_{m1}"
    if cable.top is Top.FREE:
        yield r"+ \frac{1}{2} k_{m1H} x_{m1}^2 + \name{static_pull} \cdot x_{m1}"
    springs = {Terminal.ANCHOR_SPRING: ("k_{cH}", "k_{cV}"), Terminal.FLOATER: ("k_{m2H}", "k_{m2V}")}
    if cable.terminal in springs:
        horizontal, vertical = springs[cable.terminal]
        yield rf"+ \frac{{1}}{{2}} {horizontal} {_X}^2 - \name{{static_pull_2}} \cdot {_X}"
        yield rf"+ \frac{{1}}{{2}} {vertical} {_Y}^2 + \name{{static_load_2}} \cdot {_Y}"
    end = " - w_c y_c" if cable.terminal in (Terminal.LOAD, Terminal.ANCHOR_SPRING) else ""
    yield rf"- \sum_i w_i p_{{i,y}}{end}"
