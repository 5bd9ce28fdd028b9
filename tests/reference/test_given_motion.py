"""Ends whose motion is given: as a limit, in the moving frame, at rest, and by their energy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Terminal, Top
from cablefmu.reference import Reference, integrate
from cablefmu.reference.chain import chain_of
from cablefmu.reference.extended import extended_acceleration, extended_outputs
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.long_double import long_double_acceleration
from cablefmu.reference.matrices import inertia_matrix
from cablefmu.reference.outputs import powers
from cablefmu.reference.pin import PIN_RATE
from cablefmu.reference.vectors import drive_vector
from cablefmu.scene import load_scene
from tests.random_cables import random_cable, random_inputs, random_state
from tests.reference.lagrangian import derive, same
from tests.reference.vessels import given, slack, swaying, towed, without_first_joint

WATERS = [(False, Drag.NONE), (True, Drag.COEFFICIENT)]


# --- as a limit ---


def on_a_floater(cable: Cable, mass: float, start: Mapping[str, float]) -> Cable:
    """The same cable under a free floater of `mass` [kg] without springs, which starts where and as the motion does."""
    nothing = dict.fromkeys(("k_m1", "c_m1", "static_load", "k_m1H", "c_m1H", "static_pull"), 0.0)
    return replace(
        cable,
        top=Top.FREE,
        parameters=cable.parameters | nothing | {"M_1": mass},
        inputs=("u_m1", *(name for name in cable.inputs if name[-2:] != "_1"), "u_m1x"),
        position=np.concatenate([[start["y_1"]], cable.position, [start["x_1"]]]),
        velocity=np.concatenate([[start["vy_1"]], cable.velocity, [start["vx_1"]]]),
    )


@pytest.mark.parametrize(("water", "drag"), WATERS)
@pytest.mark.parametrize("terminal", Terminal)
def test_a_floater_that_grows_and_is_pushed_along_becomes_the_given_motion(
    terminal: Terminal, water: bool, drag: Drag
) -> None:
    """The difference is the cable's pull over the mass: a tenth of it for ten times the mass, in 50 digits."""
    cable = random_cable(np.random.default_rng(61), 7, terminal, water, top=Top.MOTION, drag=drag)
    inputs = random_inputs(np.random.default_rng(62), cable)
    exact = extended_acceleration(cable, cable.position, cable.velocity, inputs)
    force = [extended_outputs(cable, cable.position, cable.velocity, inputs)[f"F_1{axis}"] for axis in "xy"]
    differences = []
    for mass in (1e8, 1e9, 1e10):
        push = {name: value for name, value in inputs.items() if name[-2:] != "_1"}
        push |= {"u_m1": mass * inputs["ay_1"], "u_m1x": mass * inputs["ax_1"]}
        floater = on_a_floater(cable, mass, inputs)
        found = extended_acceleration(floater, floater.position, floater.velocity, push)
        angles = np.abs(found[1:-1] - exact).max() / np.abs(exact).max()
        with mpmath.workdps(50):
            # Newton for the floater: what is left of M a beside the push is the cable's force
            pull = np.array([mass * found[-1] - push["u_m1x"], mass * found[0] - push["u_m1"]])
            differences.append((float(angles), float(np.abs(pull - force).max() / np.abs(force).max())))
    angles, forces = np.array(differences).T
    for errors in (angles, forces):
        assert 0 < errors[-1] < 1e-3
        # to first order in mass of the cable / mass of the floater
        assert errors[:-1] / errors[1:] == pytest.approx([10.0, 10.0], rel=1e-2)


def test_a_floater_of_1e12_kg_on_the_same_way() -> None:
    """Over 3 s it is pulled off its way by some kN x t^2/2 / 1e12 kg = 1e-8 m."""
    cable, way, times = towed(6, Terminal.LOAD, True, 63), swaying(1), np.linspace(0.0, 3.0, 7)
    floater = on_a_floater(cable, 1e12, way(0.0))

    def push(t: float) -> dict[str, float]:
        return {"u_m1": 1e12 * way(t)["ay_1"], "u_m1x": 1e12 * way(t)["ax_1"]}

    led, pushed = integrate(cable, way, times), integrate(floater, push, times)
    assert np.ptp(led.q, axis=0).min() > 0.05  # rad
    assert pushed.q[:, 1:-1] == pytest.approx(led.q, abs=1e-7)
    assert pushed.outputs["x_m1"] == pytest.approx([way(t)["x_1"] for t in times], abs=1e-7)
    assert pushed.outputs["tension_top"] == pytest.approx(led.outputs["tension_top"], rel=1e-6)


# --- in the moving frame ---


@pytest.mark.parametrize("n", [1, 2, 3])
def test_drive_vector_is_the_weight_in_a_moving_frame(n: int) -> None:
    """D = d/dq of sum m a_0 . (p_i - P_0) + m_c a_0 . (P_n - P_0), in symbols: loads -m a_0 in the vessel's frame."""
    derivation = derive(n, Top.MOTION)
    chain, u = derivation.chain, derivation.inputs
    along = [u["ax_1"], u["ay_1"]]
    energy = chain.end_mass * derivation.end.dot(along)
    for mass, centre in zip(chain.mass, derivation.centres, strict=True):
        energy += mass * centre.dot(along)
    actual = drive_vector(chain, derivation.motion)
    assert all(same(row, expected) for row, expected in zip(actual, derivation.gradient(energy), strict=True))


@pytest.mark.parametrize("drag", [Drag.COEFFICIENT, Drag.PER_LINK])
def test_fixed_top_in_a_stream_with_inertial_loads(drag: Drag) -> None:
    """In the vessel's frame the top is fixed, the water flows with -v_0, and -m a_0 acts at every centre."""
    rng = np.random.default_rng(64)
    cable = random_cable(rng, 8, Terminal.LOAD, True, top=Top.MOTION, drag=drag)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    forces = {name: inputs[name] for name in ("F_cx", "F_cy")}
    still = replace(cable, drag=Drag.NONE)
    v_0, a_0 = (np.array([inputs[f"{kind}x_1"], inputs[f"{kind}y_1"]]) for kind in "va")
    chain = chain_of(cable)
    across = np.stack([np.cos(q), -np.sin(q)], axis=1)
    moment, speed, before = np.zeros(8), np.zeros(2), []
    for i in range(8):
        arm = chain.length[i] * across[i]
        at_centre = across[i] @ (speed + arm / 2 * v[i] + v_0)
        load = -chain.drag[i] * abs(at_centre) * at_centre * across[i] - chain.mass[i] * a_0
        for j, upper in enumerate(before):
            moment[j] += load @ upper
        moment[i] += load @ arm / 2
        before.append(arm)
        speed = speed + arm * v[i]
    moment -= chain.end_mass * np.array([a_0 @ arm for arm in before])
    fixed = Reference(still).acceleration(q, v, forces)
    turned = np.linalg.solve(inertia_matrix(chain, motion_of(q, v, top=Top.MOTION)), moment)
    found = Reference(cable).acceleration(q, v, inputs)
    assert np.abs(turned).max() > 0.1 * np.abs(found).max()
    # 16 digits less the condition of I
    assert found == pytest.approx(fixed + turned, abs=1e-10 * np.abs(found).max())


def test_even_acceleration_is_a_tilted_gravity() -> None:
    """In air, hinged at the top: with g' = |g - a_0| and all angles counted from g - a_0 the same motion."""
    cable = without_first_joint(slack(towed(3, Terminal.LOAD, False, 65)))
    ax, ay, times = 3.0, -1.5, np.linspace(0.0, 2.0, 5)

    def vessel(t: float) -> dict[str, float]:
        return given(1, (ax * t * t / 2, ay * t * t / 2), (ax * t, ay * t), (ax, ay))

    down = np.array([0.0, cable.parameters["g"]]) - [ax, ay]
    tilt, size = np.arctan2(*down), float(np.hypot(*down))
    fixed = replace(cable, position=cable.position - tilt, parameters=cable.parameters | {"g": size})
    moving, at_rest = integrate(cable, vessel, times), integrate(fixed, lambda _: {}, times)
    assert np.ptp(moving.q, axis=0).min() > 0.2
    assert moving.q == pytest.approx(at_rest.q + tilt, abs=1e-8)  # DOP853 at rtol 1e-10
    force, tilted = (np.stack([run.outputs[f"F_1{axis}"] for axis in "xy"]) for run in (moving, at_rest))
    turn = np.array([[np.cos(tilt), np.sin(tilt)], [-np.sin(tilt), np.cos(tilt)]])
    assert force == pytest.approx(turn @ tilted, abs=1e-6 * np.abs(force).max())


def test_even_motion_in_air_changes_nothing() -> None:
    cable, rng = towed(6, Terminal.LOAD, False, 66), np.random.default_rng(66)
    (q, v), still = random_state(rng, cable), Reference(cable)
    sailing = given(1, (3.0, -2.0), (7.0, 4.0), (0.0, 0.0))
    assert np.array_equal(still.acceleration(q, v, sailing), still.acceleration(q, v, {}))
    shown, at_rest = still.outputs(q, v, sailing), still.outputs(q, v, {})
    for name in ("F_1x", "F_1y", "tension_max"):
        # the tip moves 7 m/s faster, which costs a digit
        assert shown[name] == pytest.approx(at_rest[name], rel=1e-12), name


@pytest.mark.parametrize("speed", [0.5, 3.0])
def test_towed_cable_trails_at_the_critical_angle(speed: float) -> None:
    """Limp and without load: each link's weight across it is its drag, w sin th = -c (U cos th)^2 [N]."""
    rng = np.random.default_rng(67)
    drawn = random_cable(rng, 9, Terminal.LOAD, True, top=Top.MOTION, uneven=False)
    limp = replace(drawn.links, joint_stiffness=np.zeros(9), joint_damping=np.zeros(9))
    kept = ("g", "rho_w", "Cd")
    parameters = {name: value for name, value in drawn.parameters.items() if name in kept}
    cable = replace(drawn, links=limp, parameters=parameters | {"m_c": 0.0})
    chain = chain_of(cable)
    weight, resistance = chain.wet_mass[0] * 9.81, chain.drag[0] * speed**2
    # w s = c U^2 (1 - s^2) with s = -sin th
    sine = (np.sqrt(weight**2 + 4 * resistance**2) - weight) / (2 * resistance)
    angles = np.full(9, -np.arcsin(sine))
    towing = given(1, (0.0, 0.0), (speed, 0.0), (0.0, 0.0))
    held = Reference(cable).acceleration(angles, np.zeros(9), towing)
    free = Reference(cable).acceleration(angles, np.zeros(9), {})
    assert held == pytest.approx(np.zeros(9), abs=1e-9 * np.abs(free).max())
    outputs = Reference(cable).outputs(angles, np.zeros(9), towing)
    # the vessel carries all the weight but what the drag lifts, and tows all that it brakes
    drag = 9 * resistance * np.cos(angles[0]) ** 2
    assert outputs["F_1x"] == pytest.approx(-drag * np.cos(angles[0]), rel=1e-9)
    assert outputs["F_1y"] == pytest.approx(9 * weight + drag * np.sin(angles[0]), rel=1e-9)


# --- at rest ---


def test_given_motion_that_stands_still_is_a_pin() -> None:
    for top in Top:
        rng = np.random.default_rng(70)
        cable = random_cable(rng, 6, Terminal.PIN, True, top=top)
        (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
        standing = replace(cable, terminal=Terminal.MOTION, inputs=(*cable.inputs, *given(2, *np.zeros((3, 2)))))
        by_inputs = inputs | given(2, cable.rest_position, (0.0, 0.0), (0.0, 0.0))
        expected = Reference(cable).acceleration(q, v, inputs)
        for said in (inputs, by_inputs):
            assert np.array_equal(Reference(standing).acceleration(q, v, said), expected)


def test_catenary_pulls_at_both_vessels_and_at_the_mooring() -> None:
    """H and V of the shape's own solver: on the vessels (H, V) and -(H, V - W), balanced by what a mooring carries."""
    scene, springs = load_scene("seabed-pin-60").cable, load_scene("seabed-spring-60").cable.parameters
    limp = replace(scene.links, joint_stiffness=np.zeros(scene.n))
    parameters = {name: value for name, value in scene.parameters.items() if name != "k_joint"}
    cable = replace(scene, links=limp, parameters=parameters)
    pull, lift = springs["static_pull_2"], parameters["static_load"]
    weight = float(chain_of(cable).wet_mass.sum()) * parameters["g"]
    assert pull > 1e3  # N
    ends = {"top": Top.MOTION, "terminal": Terminal.MOTION}
    between = replace(cable, **ends, inputs=tuple(given(1, *np.zeros((3, 2)))), position=cable.position[1:])
    shown = Reference(between).outputs(between.position, np.zeros(60), {})
    expected = {"F_1x": pull, "F_1y": lift, "F_2x": -pull, "F_2y": weight - lift}
    # the shape is solved to 1e-10 of the pull, and the joints turn by rounding
    assert {name: shown[name] for name in expected} == pytest.approx(expected, rel=1e-8)

    moored = parameters | {"static_pull": pull, "k_m1H": 500.0, "c_m1H": 100.0}
    free = replace(cable, top=Top.FREE, parameters=moored, position=np.append(cable.position, 0.0))
    assert np.abs(Reference(free).acceleration(free.position, np.zeros(62), {})).max() < 1e-8
    adrift = replace(free, parameters=moored | {"static_pull": 0.0})
    assert Reference(adrift).acceleration(free.position, np.zeros(62), {})[-1] > 0.01  # m/s^2, to the right


# --- off the given motion, and over time ---


@pytest.mark.parametrize("top", Top)
def test_drift_off_a_given_motion_decays_whatever_the_cable_does(top: Top) -> None:
    """P_n - p_2 = (d + (V + w d) t) exp(-w t) [m] from a start that is off by d and too fast by V."""
    cable = slack(random_cable(np.random.default_rng(71), 6, Terminal.MOTION, True, top=top))
    way, times = swaying(2, cable.rest_position), np.linspace(0.0, 2.0, 9)
    run = integrate(cable, way, times)
    off = np.stack([run.outputs[f"{axis}_c"] - [way(t)[f"{axis}_2"] for t in times] for axis in "xy"], axis=1)
    start = off[0]
    fast = np.array([run.outputs[f"v{axis}_c"][0] - way(0.0)[f"v{axis}_2"] for axis in "xy"])
    expected = (start + np.outer(times, fast + PIN_RATE * start)) * np.exp(-PIN_RATE * times)[:, None]
    assert np.abs(start).max() > 0.1
    # DOP853 at rtol 1e-10 on angles of links of 20 m
    assert off == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("terminal", [Terminal.LOAD, Terminal.FLOATER, Terminal.MOTION])
def test_energy_along_a_run_is_what_the_vessels_put_in(terminal: Terminal) -> None:
    """E(t) - E(0) is the integral of the powers, by Simpson's rule on steps of 5 ms."""
    cable, times = slack(towed(5, terminal, True, 72)), np.linspace(0.0, 1.0, 201)
    ways = [swaying(1)] + ([swaying(2, cable.rest_position)] if terminal is Terminal.MOTION else [])

    def vessels(t: float) -> dict[str, float]:
        return {name: value for way in ways for name, value in way(t).items()}

    run, reference = integrate(cable, vessels, times), Reference(cable)
    flows = []
    for t, q, v in zip(times, run.q, run.v, strict=True):
        motion = motion_of(q, v, top=Top.MOTION, inputs=vessels(t))
        flow = powers(reference.chain, motion, vessels(t), reference.joint_forces(q, v, vessels(t)))
        flows.append((sum(flow.values()), flow["F_1"]))
    weights = np.array([1.0, *[4.0, 2.0] * 99, 4.0, 1.0]) * (times[1] - times[0]) / 3
    gained, put_in = weights @ np.array(flows)
    assert abs(put_in) > 100.0  # J
    # Simpson's error, h^4 of some oscillations of the joints a second
    assert run.outputs["energy"][-1] - run.outputs["energy"][0] == pytest.approx(gained, abs=1e-5 * abs(put_in))


# --- derivatives ---


@pytest.mark.parametrize("terminal", [Terminal.ANCHOR_SPRING, Terminal.MOTION])
def test_force_on_the_vessel_has_an_added_mass(terminal: Terminal) -> None:
    """-dF_1/da_1: of no state but the shape, symmetric, positive, and no more than the cable's own mass."""
    cable, rng = towed(7, terminal, True, 73), np.random.default_rng(73)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    reference, step = Reference(cable), 1e-30

    def force(more: Mapping[str, Any]) -> Any:
        shown = reference.outputs(q, v, {**inputs, **more})
        return np.array([shown["F_1x"], shown["F_1y"]])

    names = ("ax_1", "ay_1")
    added = -np.stack([force({name: inputs[name] + 1j * step}).imag / step for name in names], axis=1)
    differences = -np.stack([force({name: inputs[name] + 1.0}) - force({}) for name in names], axis=1)
    assert added == pytest.approx(differences, rel=1e-6)  # linear in a; 1e5 N less 1e5 N
    assert added == pytest.approx(added.T, rel=1e-9)
    values = np.linalg.eigvalsh(added)
    assert values.min() > 0
    if terminal is not Terminal.MOTION:
        assert values.max() < cable.links.mass.sum() + cable.parameters["m_c"]


@pytest.mark.parametrize(("top", "terminal"), [(Top.FREE, Terminal.MOTION), (Top.MOTION, Terminal.MOTION)])
def test_complex_steps_pass_through_states_and_inputs(top: Top, terminal: Terminal) -> None:
    """Against central differences in long doubles, steps of 1e-6."""
    rng = np.random.default_rng(74)
    cable = random_cable(rng, 4, terminal, True, top=top)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    along = [rng.normal(size=len(q)), rng.normal(size=len(q)), rng.normal(size=len(inputs))]

    def moved(step: Any) -> tuple[Any, Any, dict[str, Any]]:
        changed = {name: value + step * d for (name, value), d in zip(inputs.items(), along[2], strict=True)}
        return q + step * along[0], v + step * along[1], changed

    size = np.longdouble(1e-6)
    after, before = (long_double_acceleration(cable, *moved(step)) for step in (size, -size))
    expected = ((after - before) / (2 * size)).astype(float)
    largest = 1e-8 * np.abs(expected).max()  # 1e-12 of truncation, 1e-19 / 1e-6 of rounding, times the condition
    for accelerated in (Reference(cable).acceleration, lambda *at: long_double_acceleration(cable, *at)):
        assert accelerated(*moved(1e-30j)).imag / 1e-30 == pytest.approx(expected, abs=largest)
