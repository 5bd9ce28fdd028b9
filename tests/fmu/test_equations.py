"""The equations that a scene's page shows: true of the dense reference model, and of what the scene has only."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Terminal, Top
from cablefmu.fmu.equations import Topic, equations_of
from cablefmu.fmu.table import table
from cablefmu.fmu.variables import variables_of
from cablefmu.reference import Reference
from cablefmu.reference.drag import drag_forces
from cablefmu.reference.kinematics import accelerations, centres, motion_of, points, velocities
from cablefmu.scene import Scene
from cablefmu.scene_inputs import FOLLOWING
from tests.fmu.tex import Lookup, sides
from tests.fmu_helpers import KINDS, SCENES, small_scene
from tests.random_cables import KINDS as RANDOM_KINDS
from tests.random_cables import PORTS, random_cable, random_inputs, random_state

SYMBOLS = {
    "g": ") g", "rho_w": "ρ_w", "Cd": "C_{d,i}", "k_joint": "k_i (θ_i", "c_joint": "c_i (\\dot", "M_1": "M_1",
    "k_m1": "k_{m1}", "c_m1": "c_{m1}", "static_load": "\\name{static_load}", "m_c": "m_c", "I_Rc": "`I_Rc`",
    "rho_c": "ρ_c", "V_c": "V_c", "k_cH": "k_{cH}", "c_cH": "c_{cH}", "k_cV": "k_{cV}", "c_cV": "c_{cV}", "M_2": "M_2",
    "k_m2V": "k_{m2V}", "c_m2V": "c_{m2V}", "k_m2H": "k_{m2H}", "c_m2H": "c_{m2H}",
    "static_load_2": "\\name{static_load_2}", "static_pull_2": "\\name{static_pull_2}",
    "u_m1": "u_{m1}", "u_m2": "u_{m2}", "F_cx": "F_{cx}", "F_cy": "F_{cy}",
    "k_m1H": "k_{m1H}", "c_m1H": "c_{m1H}", "static_pull": "\\name{static_pull}", "u_m1x": "u_{m1x}",
    **{name: f"`{name}`" for name in FOLLOWING}, **{of: f"`{of}`" for of, _ in FOLLOWING.values()},
}  # fmt: skip
"""How each parameter and input is written in the formulas or in the words beside them."""


def topics(cable: Cable, dropped: tuple[str, ...] = ()) -> dict[str, Topic]:
    return {topic.title: topic for topic in equations_of(cable, variables_of(cable, dropped))}


def text(cable: Cable) -> str:
    return "\n".join(line for topic in topics(cable).values() for line in (*topic.formulas, topic.words))


def test_every_parameter_and_input_has_a_symbol() -> None:
    assert set(SYMBOLS) == {*table().parameters, *table().inputs}


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_are_those_of_the_scene(kind: str) -> None:
    cable = small_scene(kind).cable
    written = text(cable).replace("m_i g", "(m_i) g")
    present = {*cable.parameters, *cable.inputs}
    # A volume follows from a density: V_c stands in the weight either way.
    if "rho_c" in present:
        present.add("V_c")
    assert {name for name, symbol in SYMBOLS.items() if symbol in written} == present


def test_limp_joints_have_no_torque() -> None:
    cable = small_scene("load").cable
    nothing = np.zeros(cable.n)
    links = replace(cable.links, joint_stiffness=nothing, joint_damping=nothing)
    parameters = {name: v for name, v in cable.parameters.items() if name not in ("k_joint", "c_joint")}
    limp = topics(replace(cable, links=links, parameters=parameters))
    assert "Joints" not in limp
    assert not any("T_i" in formula for topic in limp.values() for formula in topic.formulas)
    assert "- θ_{i-1})^2" not in "".join(limp["Energy"].formulas)


def test_drag_given_for_each_link() -> None:
    scene = Scene.from_text(SCENES["load"].replace("Cd = 1.0", "drag_per_link = 200"), name="x")
    assert scene.cable.drag is Drag.PER_LINK
    drag = topics(scene.cable)["Drag"]
    assert "c_{v,i}" in drag.formulas[0]
    assert "Cd" not in drag.words and "ρ_w" not in drag.formulas[0]


def test_outputs_that_are_dropped_are_not_explained() -> None:
    cable = small_scene("load").cable
    assert {"Tensions", "Energy"} < set(topics(cable))
    without = topics(cable, ("tension_max", "energy"))
    assert "Energy" not in without
    assert [formula.split(" = ")[0] for formula in without["Tensions"].formulas] == [
        r"\name{tension_top}", r"\name{tension_end}"
    ]  # fmt: skip


# --- against the reference ---


def numbers(cable: Cable, rng: np.random.Generator) -> tuple[Lookup, float]:
    """The value of every letter in one motion by the reference model, and the largest force in it [N]."""
    q, v = random_state(rng, cable)
    inputs = random_inputs(rng, cable)
    reference = Reference(cable)
    chain, motion = reference.chain, motion_of(q, v, top=cable.top, inputs=inputs)
    a, forces = reference.acceleration(q, v, inputs), reference.joint_forces(q, v, inputs)
    nodes = [points(chain, motion), velocities(chain, motion), accelerations(chain, motion, a)]
    angles = [np.array([0.0, *cable.angles_in(part)]) for part in (q, v, a)]
    bend = [np.diff(part) for part in angles]
    torques = chain.stiffness * bend[0] + chain.damping * bend[1]
    across = np.sum(motion.across * centres(nodes[1]), axis=1)
    of_links = {
        "l": chain.length, "m": chain.mass, "I": chain.inertia, "k": chain.stiffness, "c": chain.damping,
        "V": cable.links.volume, "D": cable.links.drag_area / cable.links.length, "w": chain.wet_mass * chain.gravity,
        "T": np.array([*torques, 0.0]), "R": forces, "e": motion.along, "n": motion.across, "v": across,
        "f": drag_forces(chain, motion),
    }  # fmt: skip
    end_weight = chain.end_wet_mass * chain.gravity
    known = {**cable.parameters, **inputs, "ω": 10.0, "1/s": 1.0, "w_c": end_weight}
    known |= {"x_0": cable.rest_position[0], "y_0": cable.rest_position[1], "ρ_w": cable.parameters.get("rho_w")}
    known |= reference.outputs(q, v, inputs)
    if "rho_c" in known:
        known["V_c"] = known["m_c"] / known["rho_c"]

    def lookup(letter: str, dots: int, index: str, i: int) -> object:
        at, _, part = index.partition(",")
        place = {"i": i, "i-1": i - 1, "i+1": i + 1, "n": cable.n, "n+1": cable.n + 1, "0": 0, "1": 1}.get(at)
        if letter in "xy" and index == "m1":
            return nodes[dots][0]["xy".index(letter)]
        if letter in "va" and index[:1] in ("x", "y"):
            return inputs[f"{letter}{index[0]}_{index[1]}"]
        if letter in "xy" and index == "c":
            return nodes[dots][-1]["xy".index(letter)]
        if letter == "C" or (letter, at) == ("c", "v"):
            return cable.parameters.get("Cd", cable.links.drag[i - 1]) if letter == "C" else cable.links.drag[i - 1]
        if letter == "P":
            return np.array(cable.rest_position) if index == "pin" else nodes[dots][place]
        if letter == "θ":
            return angles[dots][place]
        if letter == "p":
            value = centres(nodes[dots])[place - 1]
            return value["xy".index(part)] if part else value
        name = f"{letter}_{index}" if index else letter
        if name in known or place is None:
            return known[name]
        value = of_links[letter][place - 1]
        return value["xy".index(part)] if part else value

    return lookup, float(np.max(np.abs(forces)))


def equations(cable: Cable) -> list[str]:
    """One a line; that of the energy goes over several."""
    found = []
    for topic in topics(cable).values():
        lines = [" ".join(topic.formulas)] if topic.title == "Energy" else topic.formulas
        found += [part.strip() for line in lines for part in line.split(r"\quad")]
    return [line for line in found if r"\dots" not in line]


def holds(equation: str, cable: Cable, lookup: Lookup, force: float) -> bool:
    """Whether both sides are equal for every link, but for the rounding of forces that cancel."""
    length = float(np.max(cable.links.length))
    for i in range(1, cable.n + 1):
        first, *others = sides(equation, lookup, i, cable.n)
        size = max(force * max(length, 1.0), float(np.max(np.abs(first))))
        if not all(np.allclose(first, other, rtol=0.0, atol=1e-9 * size) for other in others):
            return False
    return True


@pytest.mark.parametrize(
    ("top", "terminal", "water", "drag"), [*((Top.FLOATER, *kind) for kind in RANDOM_KINDS), *PORTS]
)
def test_every_equation_holds_in_the_motion_of_the_reference(
    top: Top, terminal: Terminal, water: bool, drag: Drag
) -> None:
    """Links that differ, at any angle and rate: what a reader computes by the page is what the model does."""
    rng = np.random.default_rng([*top.encode(), *terminal.encode(), water, *drag.encode()])
    for n in (1, 2, 7) if top is Top.FLOATER else (3, 7):
        cable = random_cable(rng, n, terminal, water, top=top, drag=drag)
        lookup, force = numbers(cable, rng)
        assert [line for line in equations(cable) if not holds(line, cable, lookup, force)] == []


@pytest.mark.parametrize("terminal", list(Terminal))
@pytest.mark.parametrize("top", list(Top))
def test_a_wrong_sign_in_any_equation_is_seen(top: Top, terminal: Terminal) -> None:
    """Every plus and minus between terms, one at a time, but for those in an index."""
    rng = np.random.default_rng([1, *top.encode(), *terminal.encode()])
    cable = random_cable(rng, 5, terminal, True, top=top, drag=Drag.COEFFICIENT)
    lookup, force = numbers(cable, rng)
    unseen, planted = [], 0
    for line in equations(cable):
        for sign in re.finditer(r"(?<= )[+-](?= )", line):
            wrong = line[: sign.start()] + {"+": "-", "-": "+"}[sign[0]] + line[sign.end() :]
            planted += 1
            if holds(wrong, cable, lookup, force):
                unseen.append(wrong)
    assert planted > 15
    assert unseen == []
