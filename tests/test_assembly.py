"""The numbers of a cable against sums done by hand, and its preloads against balances of forces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Terminal
from cablefmu.errors import SceneError
from cablefmu.scene import Scene, load_scene
from cablefmu.shapes import end_point

# By hand, for the common cable: pi (0.01 m)^2 240 m = 0.0753982 m^3, times 7850 kg/m^3
CABLE_MASS = 591.876
# (7850 - 1000) kg/m^3 times the volume, times 9.81 m/s^2
CABLE_WEIGHT = 5066.65
HAND = 1e-5  # relative: six digits were carried

SMALL = """\
format = 1
description = "Two unequal links with a load"
gravity = 10
[cable]
links = 2
link_length = [2, 4]
diameter = ["20 mm", "40 mm"]
link_mass = [3, 5]
joint_stiffness = [10, 20]
joint_damping = [1, 1]
[top]
kind = "floater"
mass = 600
stiffness = 1200
damping = 237.6
[terminal]
kind = "load"
mass = 60
[shape]
kind = "angles"
angles = [0.1, "0.2 rad"]
[run]
stop_time = 1
"""


def small(*changes: tuple[str, str]) -> Cable:
    text = SMALL
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    return Scene.from_text(text, name="small").cable


def test_common_cable_in_twelve_links() -> None:
    cable = load_scene("free-12-water").cable
    assert cable.links.length == pytest.approx(np.full(12, 20.0))
    assert cable.links.mass == pytest.approx(np.full(12, CABLE_MASS / 12.0), rel=HAND)
    assert cable.links.inertia == pytest.approx(cable.links.mass * 400.0 / 12.0)
    # (5/6) 8e10 Pa (pi/4) (0.01 m)^4 / 20 m = 26.18 N m/rad, that is 26.17994
    assert cable.links.joint_stiffness == pytest.approx(np.full(12, 26.17994), rel=HAND)
    # 1/2 1000 kg/m^3 times 1.0 times 0.02 m times 20 m = 200 N s^2/m^2 [Table 6.1]
    assert cable.drag is Drag.COEFFICIENT
    assert 0.5 * 1000.0 * cable.links.drag * cable.links.drag_area == pytest.approx(np.full(12, 200.0))
    assert cable.parameters["I_Rc"] == 50.0
    assert cable.position == pytest.approx(np.array([0.0] + [math.pi / 4.0] * 12))
    assert not cable.velocity.any()


def test_a_hanging_cable_is_carried_with_its_weight_and_the_loads() -> None:
    load = 60.0 * (1.0 - 1000.0 / 7850.0) * 9.81
    assert load_scene("free-60-water").cable.parameters["static_load"] == pytest.approx(CABLE_WEIGHT + load, rel=HAND)
    # Dry: (591.876 + 60) kg times 9.81 m/s^2
    assert load_scene("free-60-air").cable.parameters["static_load"] == pytest.approx(6394.90, rel=HAND)


def test_two_floaters_carry_half_the_cable_each() -> None:
    parameters = load_scene("floaters-both-80").cable.parameters
    assert parameters["static_load"] == pytest.approx(2533.3, abs=0.1)
    assert parameters["static_load_2"] == pytest.approx(2533.3, abs=0.1)
    # against 1041.1 N of the smooth catenary of 240 m over 160 m; 80 links differ in the fourth digit
    assert parameters["static_pull_2"] == pytest.approx(1041.1, rel=1e-3)


@pytest.mark.parametrize("name", ["seabed-spring-60", "floaters-loose-80", "seabed-mass-110", "seabed-pin-60"])
def test_the_start_is_at_rest(name: str) -> None:
    """Virtual work: with joints without springs, no coordinate is pushed by weights, preloads and floater.

    The generalised force on th_i is (weight below the middle of link i, less the lift at P_n) and the pull
    on P_n, both through dP_n/dth_i; on y_m the total.
    """
    cable = load_scene(name).cable
    p, links, angles = cable.parameters, cable.links, cable.position[1:]
    weights = (links.mass - p["rho_w"] * links.volume) * p["g"]
    if cable.terminal in (Terminal.ANCHOR_MASS, Terminal.PIN):
        # It takes any force: what holds it follows from the last link.
        carried = p["static_load"] - weights.sum()
        pull = math.tan(angles[-1]) * (carried + weights[-1] / 2.0)
    else:
        mass = p["m_c"] * (1.0 - p["rho_w"] / p["rho_c"]) if "m_c" in p else 0.0
        carried, pull = mass * p["g"] - p["static_load_2"], p["static_pull_2"]
    middle = np.cumsum(weights[::-1])[::-1] - weights / 2.0
    force_down = middle + carried
    on_angles = links.length * (pull * np.cos(angles) - force_down * np.sin(angles))
    on_heave = weights.sum() + carried - p["static_load"]
    # forces of kN on links of metres; the catenary is solved to rounding
    assert np.max(np.abs(on_angles)) < 1e-7
    assert abs(on_heave) < 1e-9 * p["static_load"]


@pytest.mark.parametrize(
    ("name", "port"),
    [("seabed-mass-60", (120.0, 200.0)), ("seabed-mass-110", (120.0, 200.0)), ("seabed-spring-60", (120.0, 200.0)),
     ("seabed-pin-60", (120.0, 200.0)),
     ("floaters-both-80", (160.0, 0.0)), ("floaters-loose-80", (160.0, 0.0)), ("floaters-restrained-80", (160.0, 0.0))],
)  # fmt: skip
def test_the_start_shape_ends_at_the_port(name: str, port: tuple[float, float]) -> None:
    cable = load_scene(name).cable
    angles, length = cable.position[1:], cable.links.length
    assert math.hypot((length * np.sin(angles)).sum() - port[0], (length * np.cos(angles)).sum() - port[1]) < 1e-9
    assert cable.rest_position == ((0.0, 0.0) if cable.terminal is Terminal.ANCHOR_MASS else port)


def test_links_may_differ_in_everything() -> None:
    cable = small()
    assert cable.links.length.tolist() == [2.0, 4.0]
    assert cable.links.mass.tolist() == [3.0, 5.0]
    assert cable.links.inertia == pytest.approx([1.0, 80.0 / 12.0])
    assert cable.links.volume == pytest.approx([math.pi * 1e-4 * 2.0, math.pi * 4e-4 * 4.0])
    assert cable.position.tolist() == [0.0, 0.1, 0.2]
    assert cable.drag is Drag.NONE


def test_parameters_are_what_the_scene_has_and_no_more() -> None:
    cable = small()
    # No k_joint: the joints differ; their damping does not. Dry weight (3 + 5 + 60) kg times 10 m/s^2.
    assert cable.parameters == {
        "g": 10.0, "M_1": 600.0, "k_m1": 1200.0, "c_m1": 237.6, "static_load": 680.0, "c_joint": 1.0, "m_c": 60.0,
    }  # fmt: skip
    assert cable.inputs == ("u_m1", "F_cx", "F_cy")
    wet = small(("[top]", "[water]\ndrag_per_link = 200\n[top]"), ("mass = 60\n", "mass = 60\nvolume = 0.01\n"))
    assert wet.drag is Drag.PER_LINK
    assert wet.links.drag.tolist() == [200.0, 200.0]
    assert not wet.links.drag_area.any()
    assert {"rho_w", "V_c"} <= wet.parameters.keys()
    assert "Cd" not in wet.parameters
    # 1000 kg/m^3 times (2 pi 1e-4 + 16 pi 1e-4 + 0.01) m^3 floats: 680 N less 156.549 N
    assert wet.parameters["static_load"] == pytest.approx(523.451, abs=1e-3)


@pytest.mark.parametrize(
    ("name", "names"),
    [
        ("free-12-air", "g M_1 k_m1 c_m1 static_load k_joint c_joint m_c I_Rc"),
        ("load-lift-80", "g M_1 k_m1 c_m1 static_load rho_w Cd k_joint c_joint m_c rho_c"),
        ("seabed-mass-60", "g M_1 k_m1 c_m1 static_load rho_w Cd k_joint c_joint m_c"),
        ("seabed-pin-60", "g M_1 k_m1 c_m1 static_load rho_w Cd k_joint c_joint"),
        ("seabed-spring-60", "g M_1 k_m1 c_m1 static_load rho_w Cd k_joint c_joint m_c rho_c"
                             " k_cV c_cV k_cH c_cH static_load_2 static_pull_2"),
        ("floaters-both-80", "g M_1 k_m1 c_m1 static_load rho_w Cd k_joint c_joint M_2"
                             " k_m2V c_m2V k_m2H c_m2H static_load_2 static_pull_2"),
    ],
)  # fmt: skip
def test_names_of_the_parameters(name: str, names: str) -> None:
    assert list(load_scene(name).cable.parameters) == names.split()


def test_a_static_load_that_is_given_is_kept() -> None:
    assert small(("damping = 237.6", 'damping = 237.6\nstatic_load = "0 N"')).parameters["static_load"] == 0.0


def test_an_anchor_of_mass_stands_where_the_cable_ends() -> None:
    anchor = 'kind = "anchor-mass"\nposition = [3.5, 4.4]\nmass'
    with pytest.raises(SceneError, match=r"terminal.position = \[3.5, 4.4\]: the start shape ends at \(0.994"):
        small(('kind = "load"\nmass', anchor))
    straight = ('kind = "angles"\nangles = [0.1, "0.2 rad"]', 'kind = "catenary"')
    assert small(('kind = "load"\nmass', anchor), straight).inputs == ("u_m1",)


PIN = 'kind = "pin"\nposition = [{}, {}]'
END = (2.0 * math.sin(0.1) + 4.0 * math.sin(0.2), 2.0 * math.cos(0.1) + 4.0 * math.cos(0.2))
"""Where the start shape of the small scene ends [m]; its cable is 6 m long."""


@pytest.mark.parametrize("off", [0.0, 0.0059, 0.0061])
def test_a_start_shape_may_miss_its_pin_by_the_rounding_of_its_angles(off: float) -> None:
    """By a thousandth of the cable's 6 m, and then turns a little to meet it; its place is no parameter."""
    position = (END[0], END[1] + off)
    change = ('kind = "load"\nmass = 60', PIN.format(*position))
    if off > 0.006:
        with pytest.raises(SceneError, match=r"the start shape ends at \(0.994344, 5.91027\) m, not at the pin"):
            small(change)
        return
    cable = small(change)
    assert (cable.terminal, cable.rest_position, cable.inputs) == (Terminal.PIN, position, ("u_m1",))
    assert end_point(cable.links.length, cable.position[1:]) == pytest.approx(position, rel=0, abs=1e-14)
    assert cable.position[1:] == pytest.approx([0.1, 0.2], rel=0, abs=0.1)  # nearly taut
    assert set(cable.parameters) == {"g", "M_1", "k_m1", "c_m1", "static_load", "c_joint"}


def test_a_pin_is_pulled_as_any_anchor_in_its_place() -> None:
    """The floater carries the catenary's vertical pull, whatever takes the other end's."""
    loads = {
        name: load_scene(f"seabed-{name}-60").cable.parameters["static_load"] for name in ("pin", "mass", "spring")
    }
    assert loads["pin"] == loads["mass"] == loads["spring"] > CABLE_WEIGHT


def test_inputs_start_at_what_their_signals_start_at() -> None:
    assert load_scene("load-lift-80").cable.input_start == {"F_cx": 1.0, "F_cy": -2000.0}
    assert load_scene("heave-60-air").cable.input_start == {"u_m1": 0.0}
