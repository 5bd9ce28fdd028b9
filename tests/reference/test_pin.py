"""A pin as what heavy masses and stiff springs tend to, against its own law, and against statics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Floats, Terminal
from cablefmu.reference import Reference, Trajectory, integrate
from cablefmu.reference.chain import chain_of
from cablefmu.reference.extended import extended_acceleration, long_double_acceleration
from cablefmu.reference.kinematics import motion_of, points, velocities
from cablefmu.reference.outputs import energy, joint_forces, powers
from cablefmu.reference.pin import PIN_RATE
from cablefmu.scene import load_scene
from tests.random_cables import random_cable, random_inputs, random_state

KEPT = 1e-13
"""Of P_n - P_pin and V_n [m, m/s] where a test makes them zero in doubles, on cables of some 10 m."""


def pinned_at_its_end(n: int, *, water: bool = True, seed: int = 0) -> Cable:
    """A random cable whose start keeps the constraint: the pin is where P_n is, and V_n = 0."""
    rng = np.random.default_rng([n, seed])
    cable = random_cable(rng, n, Terminal.PIN, water)
    chain, q = chain_of(cable), cable.position
    motion = motion_of(q, cable.velocity)
    jacobian = np.column_stack([[0.0, 1.0], (chain.length[:, None] * motion.across).T])
    still = cable.velocity - np.linalg.pinv(jacobian) @ velocities(chain, motion)[-1]
    end = points(chain, motion)[-1]
    assert np.abs(velocities(chain, motion_of(q, still))[-1]).max() < KEPT
    return replace(cable, rest_position=(float(end[0]), float(end[1])), velocity=still)


def pushed(t: float) -> Mapping[str, float]:
    """A heaving force that moves the cables below by decimetres."""
    return {"u_m1": 4000.0 * np.sin(3.0 * t)}


def drift(cable: Cable, run: Trajectory) -> Floats:
    """P_n - P_pin over time [m], shape (m, 2)."""
    return np.stack([run.outputs["x_c"], run.outputs["y_c"]], axis=1) - cable.rest_position


# --- as a limit ---


@pytest.mark.parametrize("n", [2, 3, 12])
def test_a_neutrally_buoyant_mass_that_grows_becomes_a_pin(n: int) -> None:
    """The difference is the cable's pull over the mass: a tenth of it for ten times the mass, in 50 digits."""
    cable = pinned_at_its_end(n)
    inputs = random_inputs(np.random.default_rng(n), cable)
    at_pin = extended_acceleration(cable, cable.position, cable.velocity, inputs)
    differences = []
    for mass in (1e8, 1e9, 1e10):
        heavy = replace(cable, terminal=Terminal.ANCHOR_MASS, parameters=cable.parameters | {"m_c": mass})
        found = extended_acceleration(heavy, cable.position, cable.velocity, inputs)
        differences.append(float(np.abs(found - at_pin).max() / np.abs(at_pin).max()))
    assert 0 < differences[-1] < 1e-4
    # to first order in mass of the cable / mass of the anchor, and what the start keeps of the constraint in doubles
    assert differences[0] / differences[1] == pytest.approx(10.0, rel=1e-3)
    assert differences[1] / differences[2] == pytest.approx(10.0, rel=1e-3)


def test_springs_that_stiffen_become_a_pin() -> None:
    """An anchor of 10 kg on springs with critical dampers gives way by its pull over the stiffness."""
    cable, times = pinned_at_its_end(3), np.linspace(0.0, 1.0, 6)
    at_pin = integrate(cable, pushed, times)
    assert np.ptp(at_pin.outputs["y_m1"]) > 0.1
    away = []
    for stiffness in (1e6, 1e7):
        damping = 2.0 * np.sqrt(stiffness * 10.0)
        springs = {f"k_c{axis}": stiffness for axis in "HV"} | {f"c_c{axis}": damping for axis in "HV"}
        anchor = {"m_c": 10.0, "V_c": 10.0 / cable.parameters["rho_w"], "static_load_2": 0.0, "static_pull_2": 0.0}
        held = replace(cable, terminal=Terminal.ANCHOR_SPRING, parameters=cable.parameters | anchor | springs)
        away.append(np.abs(integrate(held, pushed, times).q - at_pin.q).max())
    assert 0 < away[1] < 1e-3  # m and rad
    # measured 10.2; at 1e5 N/m the anchor still gives way by decimetres
    assert away[0] / away[1] == pytest.approx(10.0, rel=0.1)


# --- the constraint ---


@pytest.mark.parametrize("water", [False, True])
def test_drift_decays_whatever_the_cable_does(water: bool) -> None:
    """P_n - P_pin = (d + (V + w d) t) exp(-w t) [m] from a start that is off by d and moves with V."""
    cable = random_cable(np.random.default_rng(51), 6, Terminal.PIN, water)
    chain, motion = chain_of(cable), motion_of(cable.position, cable.velocity)
    start, speed = points(chain, motion)[-1] - cable.rest_position, velocities(chain, motion)[-1]
    times = np.linspace(0.0, 2.0, 9)
    run = integrate(cable, pushed, times)
    expected = (start + np.outer(times, speed + PIN_RATE * start)) * np.exp(-PIN_RATE * times)[:, None]
    assert np.abs(start).max() > 0.1
    # DOP853 at rtol 1e-10 on angles of links of 20 m
    assert drift(cable, run) == pytest.approx(expected, abs=1e-8)


def test_kept_constraint_stays_and_the_pin_neither_gives_nor_takes_energy() -> None:
    drawn = pinned_at_its_end(6, water=False)
    quiet = {name: 0.0 for name in drawn.parameters if name[0] == "c"}
    cable = replace(drawn, links=replace(drawn.links, joint_damping=np.zeros(6)), parameters=drawn.parameters | quiet)
    run = integrate(cable, lambda _: {}, np.linspace(0.0, 3.0, 13))
    assert np.abs(drift(cable, run)).max() < 1e-9  # m; of the start and of DOP853 at rtol 1e-10
    heaved = np.ptp(run.q[:, 0]) * cable.parameters["static_load"]  # J, what one term alone exchanged
    assert heaved > 100.0
    assert np.ptp(run.outputs["energy"]) < 1e-8 * heaved


def test_off_the_constraint_the_multiplier_works_on_what_moves() -> None:
    """The only power that `powers` leaves out: -lambda . V_n, zero where the constraint is kept."""
    rng = np.random.default_rng(52)
    cable = random_cable(rng, 5, Terminal.PIN, water=True)
    (q, v), inputs, step = random_state(rng, cable), random_inputs(rng, cable), 1e-6
    reference, motion = Reference(cable), motion_of(q, v)
    a, chain = reference.acceleration(q, v, inputs), reference.chain
    later, earlier = (energy(chain, motion_of(q + v * t, v + a * t)) for t in (step, -step))
    work = -reference.joint_forces(q, v, inputs)[-1] @ velocities(chain, motion)[-1]
    assert abs(work) > 1e4  # W
    # differences of 1e5 J over 2e-6 s: 1e-16 x 1e5 / 1e-6 of rounding
    flow = sum(powers(chain, motion, inputs).values())
    assert (later - earlier) / (2 * step) == pytest.approx(flow + work, rel=1e-6)


# --- its force ---


def test_pin_of_a_limp_cable_at_rest_takes_the_catenarys_pull() -> None:
    """H and V - W of the shape's own solver, as the preload of the same cable on springs has them."""
    cable, springs = load_scene("seabed-pin-60").cable, load_scene("seabed-spring-60").cable.parameters
    limp = replace(cable.links, joint_stiffness=np.zeros(cable.n))
    rest = {name: value for name, value in cable.parameters.items() if name != "k_joint"}
    held = Reference(replace(cable, links=limp, parameters=rest))
    weight = springs["m_c"] * (1 - springs["rho_w"] / springs["rho_c"]) * springs["g"]
    pull = np.array([springs["static_pull_2"], weight - springs["static_load_2"]])
    found = held.joint_forces(cable.position, cable.velocity, {})[-1]
    # the shape is solved to 1e-10 of the pull, and the joints turn by rounding
    assert found == pytest.approx(-pull, rel=1e-8)
    along = np.array([np.sin(cable.position[-1]), np.cos(cable.position[-1])])
    assert held.outputs(cable.position, cable.velocity, {})["tension_end"] == pytest.approx(pull @ along, rel=1e-8)


def test_one_link_on_a_pin_cannot_move() -> None:
    """Two coordinates and two constraints."""
    cable = pinned_at_its_end(1)
    stuck = Reference(cable).acceleration(cable.position, cable.velocity, {"u_m1": 1e4})
    assert stuck == pytest.approx(np.zeros(2), abs=1e-10)


def test_pin_is_never_inside_the_matrix() -> None:
    cable = pinned_at_its_end(4)
    assert Reference(cable, heavy_end=False).heavy_end
    assert Reference(cable).chain.end_mass == 0.0


def test_force_on_a_pin_must_be_given() -> None:
    cable = pinned_at_its_end(4)
    chain, motion = chain_of(cable), motion_of(cable.position, cable.velocity)
    with pytest.raises(ValueError, match="does not follow from the motion"):
        joint_forces(chain, motion, np.zeros(5), {})


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_doubles_and_long_doubles_against_50_digits(n: int) -> None:
    rng = np.random.default_rng(n)
    cable = random_cable(rng, n, Terminal.PIN, water=True)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    exact = extended_acceleration(cable, q, v, inputs)
    size = float(np.abs(exact).max())
    # 16 and 19 digits less the condition of the bordered matrix (up to 1e6)
    in_doubles = Reference(cable).acceleration(q, v, inputs)
    assert in_doubles == pytest.approx(exact.astype(float), rel=0, abs=1e-10 * size)
    in_long_doubles = long_double_acceleration(cable, q, v, inputs)
    assert float(np.abs(in_long_doubles - exact.astype(np.longdouble)).max()) < 1e-13 * size
