"""A cable seen from its other end: what holds the top in one holds P_n in the other, and by other means."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cablefmu.cable import Cable, Floats, Terminal, Top
from cablefmu.reference import Reference
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import accelerations, motion_of, points, velocities
from tests.random_cables import random_cable, random_inputs, random_state
from tests.reference.vessels import given, without_first_joint


def reversed_links(cable: Cable) -> Cable:
    """The same links from the other end; the joint at the top of the first one has no spring in either."""
    hinged = without_first_joint(cable)
    flipped = {name: getattr(hinged.links, name)[::-1].copy() for name in hinged.links.__dataclass_fields__}
    for name in ("joint_stiffness", "joint_damping"):
        flipped[name] = np.roll(flipped[name], 1)
    return replace(hinged, links=replace(hinged.links, **flipped))


def from_below(cable: Cable, q: Floats, v: Floats, inputs: dict[str, float]) -> tuple[Floats, Floats, Any, Any]:
    """(angles, rates, motion of P_n in two arrays) as seen by the reversed cable."""
    motion = motion_of(q, v, top=Top.MOTION, inputs=inputs)
    place, speed = (at(chain_of(cable), motion)[-1] for at in (points, velocities))
    return q[::-1] + np.pi, v[::-1], place, speed


SWAPPED = {"tension_top": "tension_end", "tension_end": "tension_top", "tension_max": "tension_max", "energy": "energy"}


@pytest.mark.parametrize("water", [False, True])
def test_second_floater_under_a_moved_top_is_a_free_floater_over_a_moved_end(water: bool) -> None:
    """Every term of x_m has its twin at the other end, which holds it by other means: a constraint, springs at P_n."""
    rng = np.random.default_rng(68)
    drawn = random_cable(rng, 6, Terminal.FLOATER, water, top=Top.MOTION)
    cable = without_first_joint(replace(drawn, inputs=("u_m2", "F_cx", *drawn.inputs[-6:]), rest_position=(0.0, 0.0)))
    p = cable.parameters
    twins = {"M_1": "M_2", "k_m1": "k_m2V", "c_m1": "c_m2V", "k_m1H": "k_m2H", "c_m1H": "c_m2H"}
    parameters = {name: value for name, value in p.items() if "2" not in name}
    parameters |= {name: p[twin] for name, twin in twins.items()}
    parameters |= {"static_load": p["static_load_2"], "static_pull": -p["static_pull_2"]}
    ends = {"top": Top.FREE, "terminal": Terminal.MOTION}
    forces = ("u_m1", "u_m1x", *given(2, *np.zeros((3, 2))))
    turned = replace(reversed_links(cable), **ends, parameters=parameters, inputs=forces)

    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    angles, rates, place, speed = from_below(cable, q, v, inputs)
    q_turned, v_turned = (np.concatenate([[at[1]], x, [at[0]]]) for at, x in ((place, angles), (speed, rates)))
    push = {"u_m1": inputs["u_m2"], "u_m1x": inputs["F_cx"]}
    push |= {name.replace("_1", "_2"): value for name, value in inputs.items() if name[-2:] == "_1"}

    a, turned_a = Reference(cable).acceleration(q, v, inputs), Reference(turned).acceleration(q_turned, v_turned, push)
    size = 1e-9 * np.abs(a).max()  # 16 digits less the conditions of both matrices
    assert turned_a[1:-1][::-1] == pytest.approx(a, abs=size)
    motion = motion_of(q, v, top=Top.MOTION, inputs=inputs)
    floater = accelerations(chain_of(cable), motion, a)[-1]
    assert turned_a[[-1, 0]] == pytest.approx(floater, abs=size * cable.links.length.sum())
    shown, seen = Reference(cable).outputs(q, v, inputs), Reference(turned).outputs(q_turned, v_turned, push)
    twin_outputs = SWAPPED | {"F_1x": "F_2x", "F_1y": "F_2y", "x_c": "x_m1", "y_c": "y_m1", "vy_c": "v_m1"}
    for name, twin in twin_outputs.items():
        assert seen[twin] == pytest.approx(shown[name], rel=1e-8, abs=1e-9), name


@pytest.mark.parametrize("water", [False, True])
def test_cable_between_two_moved_ends_turned_end_for_end(water: bool) -> None:
    rng = np.random.default_rng(69)
    cable = without_first_joint(random_cable(rng, 5, Terminal.MOTION, water, top=Top.MOTION))
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    angles, rates, place, speed = from_below(cable, q, v, inputs)
    inputs |= given(2, place, speed, (inputs["ax_2"], inputs["ay_2"]))
    swapped = {name[:-1] + {"1": "2", "2": "1"}[name[-1]]: value for name, value in inputs.items()}
    shown = Reference(cable).outputs(q, v, inputs)
    seen = Reference(reversed_links(cable)).outputs(angles, rates, swapped)
    for name, twin in (SWAPPED | {f"F_1{axis}": f"F_2{axis}" for axis in "xy"}).items():
        assert seen[twin] == pytest.approx(shown[name], rel=1e-8), name
