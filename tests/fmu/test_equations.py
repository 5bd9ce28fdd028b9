"""The equations that a scene's page shows: all parameters and inputs that it has, nothing that it has not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag
from cablefmu.fmu.equations import Topic, equations_of
from cablefmu.fmu.table import table
from cablefmu.fmu.variables import variables_of
from cablefmu.scene import Scene
from tests.fmu_helpers import KINDS, SCENES, small_scene

SYMBOLS = {
    "g": ") g", "rho_w": "ρ_w", "Cd": "C_{d,i}", "k_joint": "k_i (θ_i", "c_joint": "c_i (\\dot", "M_1": "M_1",
    "k_m1": "k_{m1}", "c_m1": "c_{m1}", "static_load": "\\name{static_load}", "m_c": "m_c", "I_Rc": "`I_Rc`",
    "rho_c": "ρ_c", "V_c": "V_c", "k_cH": "k_{cH}", "c_cH": "c_{cH}", "k_cV": "k_{cV}", "c_cV": "c_{cV}", "M_2": "M_2",
    "k_m2V": "k_{m2V}", "c_m2V": "c_{m2V}", "k_m2H": "k_{m2H}", "c_m2H": "c_{m2H}",
    "static_load_2": "\\name{static_load_2}", "static_pull_2": "\\name{static_pull_2}",
    "u_m1": "u_{m1}", "u_m2": "u_{m2}", "F_cx": "F_{cx}", "F_cy": "F_{cy}",
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
