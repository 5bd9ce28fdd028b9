"""Random cables are what they are said to be: every kind, complete, physical, and the same again."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Terminal, Top
from tests.random_cables import KINDS, PORTS, random_cable, random_inputs, random_state

MANY = 60
"""Draws; the chance that a coin never shows one of its sides is 1e-18."""

EXPECTED: dict[Terminal, set[str]] = {
    Terminal.LOAD: {"m_c"},
    Terminal.ANCHOR_MASS: {"m_c"},
    Terminal.ANCHOR_SPRING: {"m_c", "k_cH", "c_cH", "k_cV", "c_cV", "static_load_2", "static_pull_2"},
    Terminal.FLOATER: {"M_2", "k_m2H", "c_m2H", "k_m2V", "c_m2V", "static_load_2", "static_pull_2"},
    Terminal.PIN: set(),
    Terminal.MOTION: set(),
}
HEAVING = {"M_1", "k_m1", "c_m1", "static_load"}
EXPECTED_TOP: dict[Top, set[str]] = {
    Top.FLOATER: HEAVING,
    Top.FREE: HEAVING | {"k_m1H", "c_m1H", "static_pull"},
    Top.MOTION: set(),
}
MOTION_INPUTS = ["x_", "y_", "vx_", "vy_", "ax_", "ay_"]
ALL_KINDS = [(Top.FLOATER, *kind) for kind in KINDS] + PORTS


def draws(top: Top, terminal: Terminal, water: bool, drag: Drag) -> list[Cable]:
    """Many cables of one kind."""
    rng = np.random.default_rng(7)
    return [random_cable(rng, 3, terminal, water, top=top, drag=drag) for _ in range(MANY)]


def test_kinds_are_every_combination_of_ends_and_surroundings_once() -> None:
    assert len(ALL_KINDS) == len(set(ALL_KINDS)) == len(Top) * len(Terminal) * 4
    assert {(top, terminal) for top, terminal, _, _ in ALL_KINDS} == {(t, e) for t in Top for e in Terminal}


@pytest.mark.parametrize(("top", "terminal", "water", "drag"), ALL_KINDS)
def test_parameters_are_those_of_the_kind(top: Top, terminal: Terminal, water: bool, drag: Drag) -> None:
    optional = {"k_joint", "c_joint"} | ({"Cd"} if drag is Drag.COEFFICIENT else set())
    if terminal is Terminal.LOAD:
        optional |= {"I_Rc"}
    if water and terminal in (Terminal.LOAD, Terminal.ANCHOR_SPRING):
        optional |= {"rho_c", "V_c"}
    needed = {"g"} | EXPECTED_TOP[top] | EXPECTED[terminal] | ({"rho_w"} if water else set())
    seen = [set(cable.parameters) for cable in draws(top, terminal, water, drag)]
    assert set.union(*seen) == needed | optional
    assert set.intersection(*seen) == needed
    assert not any({"rho_c", "V_c"} <= names for names in seen)


@pytest.mark.parametrize(("top", "terminal", "water", "drag"), ALL_KINDS)
def test_everything_is_physical(top: Top, terminal: Terminal, water: bool, drag: Drag) -> None:
    for cable in draws(top, terminal, water, drag):
        links, mass = cable.links, cable.parameters.get("M_2", cable.parameters.get("m_c", 0.0))
        assert cable.in_water is water and cable.drag is drag and cable.top is top
        assert 10.0 <= mass <= 1e4 or (terminal in (Terminal.PIN, Terminal.MOTION) and mass == 0.0)
        for positive in (links.length, links.mass, links.inertia, links.joint_stiffness, links.joint_damping):
            assert positive.shape == (3,) and np.all(positive > 0)
        assert np.all(links.mass > cable.parameters.get("rho_w", 0.0) * links.volume)
        assert np.any(links.drag > 0) == (drag is not Drag.NONE)
        assert np.any(links.drag_area > 0) == (drag is Drag.COEFFICIENT)
        assert cable.position.shape == cable.velocity.shape == (cable.coordinates,)
        assert set(cable.input_start) <= set(cable.inputs)


@pytest.mark.parametrize(("top", "terminal", "water", "drag"), ALL_KINDS)
def test_inputs_are_forces_in_order_and_behind_them_motions(
    top: Top, terminal: Terminal, water: bool, drag: Drag
) -> None:
    order = ["u_m1", "u_m2", "F_cx", "F_cy", "u_m1x", *(f"{name}{port}" for port in (1, 2) for name in MOTION_INPUTS)]
    for cable in draws(top, terminal, water, drag):
        assert list(cable.inputs) == [name for name in order if name in cable.inputs]
        assert [name for name in cable.inputs if name[-2:] == "_1"] == [
            f"{name}1" for name in MOTION_INPUTS if top is Top.MOTION
        ]
        assert [name for name in cable.inputs if name[-2:] == "_2"] == [
            f"{name}2" for name in MOTION_INPUTS if terminal is Terminal.MOTION
        ]
        assert ("u_m1" in cable.inputs, "u_m1x" in cable.inputs) == (top is not Top.MOTION, top is Top.FREE)


def test_even_cables_have_common_values_as_parameters() -> None:
    cable = random_cable(np.random.default_rng(1), 6, Terminal.LOAD, water=True, uneven=False)
    for name, values in (
        ("k_joint", cable.links.joint_stiffness),
        ("c_joint", cable.links.joint_damping),
        ("Cd", cable.links.drag),
    ):
        assert np.all(values == cable.parameters[name])
    assert np.ptp(cable.links.length) == 0


def test_same_seed_same_cable_state_and_inputs() -> None:
    first, again = (
        (cable.parameters, random_state(rng, cable)[0].tolist(), random_inputs(rng, cable))
        for rng in (np.random.default_rng(3), np.random.default_rng(3))
        for cable in [random_cable(rng, 5, Terminal.FLOATER, water=True)]
    )
    assert first == again
    assert set(first[2]) in ({"u_m1", "u_m2"}, {"u_m1", "u_m2", "F_cx"})


def test_drag_needs_water() -> None:
    with pytest.raises(ValueError, match="air has no drag"):
        random_cable(np.random.default_rng(0), 2, Terminal.LOAD, water=False, drag=Drag.PER_LINK)
