"""Newton's and Euler's laws link by link, and where the energy goes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Floats, Terminal, Top
from cablefmu.reference import Reference
from cablefmu.reference.chain import chain_of
from cablefmu.reference.extended import extended_acceleration, extended_outputs
from cablefmu.reference.kinematics import Motion, motion_of, velocities
from cablefmu.reference.outputs import energy, joint_forces, powers, pulls
from tests.random_cables import KINDS, PORTS, random_cable, random_inputs, random_state
from tests.reference.lagrangian import vectorised

WEIGHT = 1e-10
"""Of the largest joint force: 16 digits less the condition of I (up to 1e5)."""


ALL_KINDS = [(Top.FLOATER, *kind) for kind in KINDS] + PORTS


def moving(
    n: int, terminal: Terminal, water: bool, drag: Drag, top: Top = Top.FLOATER
) -> tuple[Cable, Floats, Floats, Any]:
    """A random cable in a random state under random inputs."""
    rng = np.random.default_rng(n)
    cable = random_cable(rng, n, terminal, water, top=top, drag=drag)
    return cable, *random_state(rng, cable), random_inputs(rng, cable)


@pytest.mark.parametrize(("top", "terminal", "water", "drag"), ALL_KINDS)
def test_joint_forces_turn_every_link_and_carry_the_floater(
    top: Top, terminal: Terminal, water: bool, drag: Drag
) -> None:
    """Joint forces come from the sum of forces alone, so the moments and the floater are a check.

    I_i th_i'' = -l_i/2 n_i . (R_i + R_{i+1}) + T_{i+1} - T_i and
    M y_m'' = u_m1 - c_m y_m' - k_m y_m - static_load - R_1y; of a free floater also
    M x_m'' = u_m1x - c_mH x_m' - k_mH x_m - static_pull - R_1x.
    """
    cable, q, v, inputs = moving(9, terminal, water, drag, top)
    chain, motion = chain_of(cable), motion_of(q, v, top=top, inputs=inputs)
    a, R = Reference(cable).acceleration(q, v, inputs), Reference(cable).joint_forces(q, v, inputs)
    bend, bend_rate = np.diff(motion.theta, prepend=0.0), np.diff(motion.omega, prepend=0.0)
    T = np.append(chain.stiffness * bend + chain.damping * bend_rate, 0.0)
    moments = -chain.length / 2 * np.sum(motion.across * (R[:-1] + R[1:]), axis=1) + T[1:] - T[:-1]
    size = WEIGHT * np.abs(R).max()
    turning = a[int(top is not Top.MOTION) :][:9]
    assert chain.inertia * turning == pytest.approx(moments, rel=0, abs=size * chain.length.max())
    p = cable.parameters
    if top is not Top.MOTION:
        held = p["c_m1"] * v[0] + p["k_m1"] * q[0] + p["static_load"]
        assert p["M_1"] * a[0] == pytest.approx(inputs["u_m1"] - held - R[0, 1], rel=0, abs=size)
    if top is Top.FREE:
        held = p["c_m1H"] * v[-1] + p["k_m1H"] * q[-1] + p["static_pull"]
        assert p["M_1"] * a[-1] == pytest.approx(inputs["u_m1x"] - held - R[0, 0], rel=0, abs=size)


@pytest.mark.parametrize(("top", "terminal", "water", "drag"), PORTS)
def test_forces_on_what_moves_an_end_are_those_through_its_joint(
    top: Top, terminal: Terminal, water: bool, drag: Drag
) -> None:
    cable, q, v, inputs = moving(4, terminal, water, drag, top)
    R, outputs = Reference(cable).joint_forces(q, v, inputs), Reference(cable).outputs(q, v, inputs)
    forces = {name: value for name, value in outputs.items() if name[0] == "F"}
    expected = {"F_1x": -R[0, 0], "F_1y": -R[0, 1]} if top is Top.MOTION else {}
    if terminal is Terminal.MOTION:
        expected |= {"F_2x": R[-1, 0], "F_2y": R[-1, 1]}
    assert forces == expected
    shown = {name: value for name, value in outputs.items() if name.endswith("m1")}
    heave = {} if top is Top.MOTION else {"y_m1": q[0], "v_m1": v[0]}
    assert shown == (heave | {"x_m1": q[-1], "vx_m1": v[-1]} if top is Top.FREE else heave)


def at_a_fixed_end(cable: Cable, v: Any, motion: Callable[[Any], Motion]) -> Any:
    """The rates less what moves P_n, taken from the first and the third link alone: l_1 n_1 w_1 + l_3 n_3 w_3 = V_n."""
    chain, fixed = chain_of(cable, mpmath.mpf), v.copy()
    first, third = ((chain.length[i] * motion(v).across[i]).tolist() for i in (0, 2))
    turn = mpmath.lu_solve(mpmath.matrix([first, third]).T, mpmath.matrix(velocities(chain, motion(v))[-1].tolist()))
    at = int(cable.top is not Top.MOTION)
    fixed[at] -= turn[0]
    fixed[at + 2] -= turn[1]
    left = velocities(chain, motion(fixed))[-1]
    assert max(abs(speed) for speed in left) < mpmath.mpf(10) ** -50  # m/s, of 60 digits
    return fixed


def later(inputs: dict[str, Any], t: Any) -> dict[str, Any]:
    """The same inputs after t [s]: ends whose motion is given have moved on."""
    moved = dict(inputs)
    for end in [f"{axis}_{port}" for axis in "xy" for port in (1, 2) if f"x_{port}" in inputs]:
        moved[end] += inputs[f"v{end}"] * t + inputs[f"a{end}"] * t * t / 2
        moved[f"v{end}"] += inputs[f"a{end}"] * t
    return moved


@pytest.mark.parametrize(("top", "terminal", "water", "drag"), ALL_KINDS)
def test_energy_changes_by_the_powers(top: Top, terminal: Terminal, water: bool, drag: Drag) -> None:
    """dE/dt along (v, x'') by a central difference in 60 digits, whose error is of order 1e-30.

    A pin takes no part in it, as P_n must not move there: its force does no work. What moves an end does, and the
    given motion goes on meanwhile.
    """
    cable, q, v, inputs = moving(5, terminal, water, drag, top)
    exact, sin, cos = (vectorised(f) for f in (mpmath.mpf, mpmath.sin, mpmath.cos))
    with mpmath.workdps(60):
        chain, step = chain_of(cable, mpmath.mpf), mpmath.mpf(10) ** -15
        given = {name: mpmath.mpf(value) for name, value in inputs.items()}

        def motion(rates: Any, a: Any = 0, t: Any = 0) -> Motion:
            return motion_of(exact(q) + rates * t, rates + a * t, sin, cos, top=top, inputs=later(given, t))

        rates = at_a_fixed_end(cable, exact(v), motion) if terminal is Terminal.PIN else exact(v)
        a = extended_acceleration(cable, q, rates, inputs, digits=60)
        after, before = (energy(chain, motion(rates, a, t)) for t in (step, -step))
        shown = extended_outputs(cable, q, rates, inputs, digits=60)
        on_vessels = [[shown.get(f"F_{port}{axis}", mpmath.mpf(0)) for axis in "xy"] for port in (1, 2)]
        forces = np.array(on_vessels) * np.array([[-1], [1]])
        flows = powers(chain, motion(rates), given, forces)
        assert abs((after - before) / (2 * step) - sum(flows.values())) < 1e-18
    assert all(flows[name] <= 0 for name in ("joints", "floater", "terminal", "drag"))
    assert (flows["drag"] < 0) == (drag is not Drag.NONE)


def test_powers_of_a_given_motion_need_the_joint_forces() -> None:
    cable, q, v, inputs = moving(3, Terminal.LOAD, True, Drag.COEFFICIENT, Top.MOTION)
    with pytest.raises(ValueError, match="joint forces are needed"):
        powers(chain_of(cable), motion_of(q, v, top=Top.MOTION, inputs=inputs), inputs)


def test_projected_rule_feeds_energy_by_its_departure() -> None:
    """It is not conservative: the energy gains what the departure does work on."""
    cable, q, v, inputs = moving(5, Terminal.LOAD, False, Drag.NONE)
    projected = Reference(cable, terminal_rule="projected")
    a, step = projected.acceleration(q, v, inputs), 1e-5
    chain = projected.chain
    later, earlier = (energy(chain, motion_of(q + v * t, v + a * t)) for t in (step, -step))
    flow = sum(powers(chain, motion_of(q, v), inputs).values())
    gain = projected.departure(q, v, inputs) @ v
    assert abs(gain) > 1.0  # W
    # differences of 1e6 J over 2e-5 s: 1e-16 x 1e6 / 1e-5 of rounding, 1e-10 x f''' of truncation
    assert (later - earlier) / (2 * step) == pytest.approx(flow + gain, abs=1e-3)


@pytest.mark.parametrize("water", [False, True])
def test_hanging_cable_pulls_with_the_weight_below(water: bool) -> None:
    cable = random_cable(np.random.default_rng(14), 6, Terminal.LOAD, water)
    links, p = cable.links, cable.parameters
    load = p["m_c"] - p.get("rho_w", 0.0) * (p["m_c"] / p["rho_c"] if "rho_c" in p else p.get("V_c", 0.0))
    weights = 9.81 * np.append(links.mass - p.get("rho_w", 0.0) * links.volume, load)
    below = np.cumsum(weights[::-1])[::-1]  # from each joint on, the load last
    held = Reference(replace(cable, parameters=p | {"static_load": weights.sum()}))
    nothing = np.zeros(7)
    a = held.acceleration(nothing, nothing, {})
    at_rest = motion_of(nothing, nothing)
    pull = pulls(at_rest, joint_forces(held.chain, at_rest, a, {}))
    assert pull == pytest.approx(np.stack([below[:-1], below[1:]], axis=1), rel=1e-12)
    outputs = held.outputs(nothing, nothing, {})
    assert outputs["tension_top"] == pytest.approx(weights.sum(), rel=1e-12)
    assert outputs["tension_max"] == outputs["tension_top"]
    assert outputs["tension_end"] == pytest.approx(weights[-1], rel=1e-12)


def test_horizontal_pull_on_a_level_cable_is_its_tension() -> None:
    """In free space a level cable pulled along itself: Newton for all that is to the right of a joint."""
    cable = random_cable(np.random.default_rng(15), 4, Terminal.LOAD, water=False)
    still = replace(cable, parameters=cable.parameters | {"g": 0.0, "static_load": 0.0})
    stiff = replace(still.links, joint_stiffness=np.zeros(4), joint_damping=np.zeros(4))
    level = np.array([0.0, *[np.pi / 2] * 4])
    free = {name: value for name, value in still.parameters.items() if name[1:] != "_joint"}
    reference = Reference(replace(still, links=stiff, parameters=free))
    outputs = reference.outputs(level, np.zeros(5), {"F_cx": 300.0})
    # the guided floater cannot move sideways: the whole pull goes through every joint
    assert [outputs[f"tension_{at}"] for at in ("top", "end", "max")] == pytest.approx([300.0] * 3)


def test_port_outputs_are_the_end_points() -> None:
    cable, q, v, inputs = moving(7, Terminal.FLOATER, True, Drag.COEFFICIENT)
    outputs = Reference(cable).outputs(q, v, inputs)
    assert (outputs["y_m1"], outputs["v_m1"]) == (q[0], v[0])
    length, theta = cable.links.length, q[1:]
    assert outputs["x_c"] == pytest.approx(length @ np.sin(theta))
    assert outputs["y_c"] == pytest.approx(q[0] + length @ np.cos(theta))
    assert outputs["vx_c"] == pytest.approx((length * np.cos(theta)) @ v[1:])
    assert outputs["vy_c"] == pytest.approx(v[0] - (length * np.sin(theta)) @ v[1:])
    assert velocities(chain_of(cable), motion_of(q, v))[0] == pytest.approx([0.0, v[0]])


def test_tension_max_is_over_both_ends_of_every_link() -> None:
    cable, q, v, inputs = moving(7, Terminal.LOAD, True, Drag.COEFFICIENT)
    reference, motion = Reference(cable), motion_of(q, v)
    R = joint_forces(reference.chain, motion, reference.acceleration(q, v, inputs), inputs)
    along = motion.along
    every_end = [-R[i] @ along[i] for i in range(7)] + [-R[i + 1] @ along[i] for i in range(7)]
    outputs = reference.outputs(q, v, inputs)
    assert outputs["tension_max"] == pytest.approx(max(every_end), rel=1e-12)
    assert outputs["tension_top"] == pytest.approx(every_end[0], rel=1e-12)
    assert outputs["tension_end"] == pytest.approx(every_end[-1], rel=1e-12)
