"""Trajectories against closed forms, conserved quantities, other methods, and known end points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Links, Terminal
from cablefmu.errors import OptionError, RunError
from cablefmu.reference import Reference, Trajectory, integrate
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import centres, motion_of, points
from tests.random_cables import random_cable

TRAJECTORY = 1e-8
"""Relative; DOP853 at rtol 1e-10 per step, some hundred steps."""


def nothing(_: float) -> Mapping[str, float]:
    """No force on anything."""
    return {}


def loose(cable: Cable) -> Cable:
    """The same cable on a floater without spring and damper, and without joint damping."""
    links = replace(cable.links, joint_damping=np.zeros(cable.n))
    free = {name: value for name, value in cable.parameters.items() if name != "c_joint"}
    return replace(cable, links=links, parameters=free | {"k_m1": 0.0, "c_m1": 0.0})


def vertical_centre_of_mass(cable: Cable, run: Trajectory) -> list[float]:
    """sum m y / sum m of floater, links and terminal, from positions alone."""
    p, heights = cable.parameters, []
    for q in run.q:
        at = points(chain_of(cable), motion_of(q, 0 * q))
        moment = p["M_1"] * q[0] + cable.links.mass @ centres(at)[:, 1] + p["m_c"] * at[-1, 1]
        heights.append(float(moment / (p["M_1"] + cable.links.mass.sum() + p["m_c"])))
    return heights


def test_centre_of_mass_falls_freely_whatever_the_links_do() -> None:
    """(M + sum m + m_c) Y'' = weights - static_load + u_m1 + F_cy: a parabola and a cubic in t."""
    drawn = loose(random_cable(np.random.default_rng(41), 8, Terminal.LOAD, water=False))
    cable = replace(drawn, velocity=np.zeros(9))
    p, times = cable.parameters, np.linspace(0.0, 2.0, 5)
    total = p["M_1"] + cable.links.mass.sum() + p["m_c"]
    run = integrate(cable, lambda t: {"u_m1": 700.0 * t, "F_cx": 80.0, "F_cy": -300.0}, times)
    pull = 9.81 * (cable.links.mass.sum() + p["m_c"]) - p["static_load"] - 300.0
    fall = (pull * times**2 / 2 + 700.0 * times**3 / 6) / total
    height = vertical_centre_of_mass(cable, run)
    assert np.ptp(run.q[:, 1:], axis=0).max() > 0.1  # rad: the links do move
    assert height == pytest.approx(height[0] + fall, rel=TRAJECTORY)


def test_straight_hanging_cable_is_one_oscillator_under_a_stepping_force() -> None:
    """All links vertical, in water: M y'' + c y' + k y = u, u = 0, then 900 N, then -400 N.

    The jumps lie at 0.37 and 1.1 s; the exact answer is a sum of shifted step responses.
    """
    drawn = random_cable(np.random.default_rng(42), 10, Terminal.LOAD, water=True)
    chain = chain_of(drawn)
    weight = float((chain.wet_mass.sum() + chain.end_wet_mass) * 9.81)
    cable = replace(
        drawn,
        parameters=drawn.parameters | {"static_load": weight},
        position=np.zeros(11),
        velocity=np.zeros(11),
    )
    mass = chain.floater_mass + chain.mass.sum() + chain.end_mass
    k, decay = chain.floater_stiffness, chain.floater_damping / (2 * mass)
    frequency = np.sqrt(k / mass - decay**2)

    def response(t: float) -> float:
        """To a unit step at 0 [m/N]."""
        swing = np.cos(frequency * t) + decay / frequency * np.sin(frequency * t)
        return float((1 - np.exp(-decay * t) * swing) / k) if t > 0 else 0.0

    def push(t: float) -> Mapping[str, float]:
        return {"u_m1": 0.0 if t < 0.37 else 900.0 if t < 1.1 else -400.0}

    times = np.linspace(0.0, 3.0, 13)
    run = integrate(cable, push, times, breaks=[1.1, 0.37])
    expected = [900.0 * response(t - 0.37) - 1300.0 * response(t - 1.1) for t in times]
    assert run.outputs["y_m1"] == pytest.approx(expected, rel=1e-9, abs=1e-11)
    assert not np.any(run.q[:, 1:])
    # at the jump itself the outputs show the force after it: T_top = weight - m_below y''
    at_jump = integrate(cable, push, [0.0, 0.37], breaks=[0.37]).outputs["tension_top"][-1]
    hanging = chain.mass.sum() + chain.end_mass
    assert at_jump == pytest.approx(weight - hanging * 900.0 / mass, rel=1e-12)


def test_steps_before_a_jump_never_see_it() -> None:
    """Once the force after the jump has been asked for, that before it is not: no step is tried twice."""
    cable = random_cable(np.random.default_rng(49), 2, Terminal.LOAD, water=False)
    asked: list[float] = []

    def push(t: float) -> Mapping[str, float]:
        asked.append(t)
        return {"F_cx": 0.0 if t < 0.3 else 1e4}

    integrate(cable, push, [0.0, 0.6], breaks=[0.3])
    stepping = asked[:-2]  # the last two are for the outputs at 0 and 0.6 s
    first_after = next(i for i, t in enumerate(stepping) if t >= 0.3)
    assert stepping[first_after] == 0.3
    assert all(t < 0.3 for t in stepping[:first_after])
    assert all(t >= 0.3 for t in stepping[first_after:])


def test_large_swing_under_a_free_floater_takes_the_quadrature_of_its_energy() -> None:
    """One link let go at 120 degrees from a floater that is free to heave and carried at rest.

    Without vertical force in sum, momentum stays zero: M_total y' = mu l sin th th'. The energy then
    gives th'^2 = 2 mu g l (cos th - cos th_0) / (J - (mu l sin th)^2 / M_total), and a quarter of the
    period is an integral, done to 30 digits with sin(th/2) = sin(th_0/2) sin s.
    """
    start = 2 * np.pi / 3
    drawn = loose(random_cable(np.random.default_rng(43), 1, Terminal.LOAD, water=False))
    no_spring = {name: value for name, value in drawn.parameters.items() if name != "k_joint"}
    weight = 9.81 * float(drawn.links.mass[0] + drawn.parameters["m_c"])
    cable = replace(
        drawn,
        links=replace(drawn.links, joint_stiffness=np.zeros(1)),
        parameters=no_spring | {"static_load": weight, "M_1": 500.0},
        position=np.array([0.0, start]),
        velocity=np.zeros(2),
    )
    m, length, m_c = cable.links.mass[0], cable.links.length[0], cable.parameters["m_c"]
    first = (m / 2 + m_c) * length
    second = (m / 4 + m_c) * length**2 + cable.links.inertia[0] + cable.parameters.get("I_Rc", 0.0)
    total = 500.0 + m + m_c
    peak = mpmath.sin(mpmath.mpf(start) / 2)

    def slowness(s: mpmath.mpf) -> mpmath.mpf:
        half = mpmath.asin(peak * mpmath.sin(s))
        coupled = second - (first * mpmath.sin(2 * half)) ** 2 / total
        return mpmath.sqrt(coupled / (first * 9.81)) / mpmath.cos(half)

    with mpmath.workdps(30):
        period = 4 * float(mpmath.quad(slowness, [0, mpmath.pi / 2]))
    run = integrate(cable, nothing, [0.0, period / 4, period / 2, period], rtol=1e-12)
    assert run.q[:, 1] == pytest.approx([start, 0.0, -start, start], abs=TRAJECTORY)
    assert run.q[1, 0] == pytest.approx(first / total * (np.cos(start) - 1), abs=TRAJECTORY)


def test_energy_stays_without_losses() -> None:
    """Floater spring, joint springs, terminal springs and preload, no damper and no water."""
    drawn = random_cable(np.random.default_rng(44), 6, Terminal.FLOATER, water=False)
    quiet = {name: 0.0 for name in drawn.parameters if name[0] == "c"}
    links = replace(drawn.links, joint_damping=np.zeros(6))
    cable = replace(drawn, links=links, parameters=drawn.parameters | quiet)
    run = integrate(cable, nothing, np.linspace(0.0, 3.0, 7))
    heaved = np.ptp(run.q[:, 0]) * cable.parameters["static_load"]  # J, what one term alone exchanged
    assert heaved > 100.0
    assert np.ptp(run.outputs["energy"]) < TRAJECTORY * heaved


def test_implicit_method_agrees() -> None:
    cable = random_cable(np.random.default_rng(45), 4, Terminal.ANCHOR_SPRING, water=True)

    def push(t: float) -> Mapping[str, float]:
        return {"u_m1": 2000.0 * np.sin(3.0 * t)}

    explicit = integrate(cable, push, [0.0, 0.25, 0.5])
    implicit = integrate(cable, push, [0.0, 0.25, 0.5], method="Radau", rtol=1e-8, atol=1e-10)
    # Radau's own tolerance, over some hundred steps
    assert implicit.q == pytest.approx(explicit.q, abs=1e-6)
    assert implicit.v == pytest.approx(explicit.v, abs=1e-5)


def test_only_the_times_asked_for_and_the_same_wherever_one_stops() -> None:
    cable = random_cable(np.random.default_rng(46), 5, Terminal.LOAD, water=True)
    coarse, fine = (integrate(cable, nothing, np.linspace(1.0, 2.0, count)) for count in (2, 11))
    assert coarse.times.tolist() == [1.0, 2.0] and fine.q.shape == (11, 6)
    assert fine.q[0] == pytest.approx(cable.position) and fine.v[0] == pytest.approx(cable.velocity)
    assert coarse.q[-1] == pytest.approx(fine.q[-1], rel=TRAJECTORY)


@pytest.mark.parametrize("times", [[], [0.0, 0.0], [1.0, 0.5], [0.0, np.nan], [0.0, np.inf]])
def test_times_that_do_not_increase_are_refused(times: list[float]) -> None:
    cable = random_cable(np.random.default_rng(47), 2, Terminal.LOAD, water=False)
    with pytest.raises(OptionError, match="times must be finite and increasing"):
        integrate(cable, nothing, times)


def test_run_that_blows_up_says_when_and_keeps_what_it_had() -> None:
    """A hanging cable pushed down by a force with a pole at 0.5 s, which no step gets past."""
    drawn = random_cable(np.random.default_rng(48), 2, Terminal.LOAD, water=False)
    cable = replace(drawn, position=np.zeros(3), velocity=np.zeros(3))

    def runaway(t: float) -> Mapping[str, float]:
        return {"u_m1": 1e3 / (0.5 - t) ** 3 if t < 0.5 else 1e300}

    with pytest.raises(RunError, match=r"ended at 0\.5 s: Required step size") as caught:
        integrate(cable, runaway, [0.0, 0.1, 1.0], rtol=1e-3, atol=1e-3)
    assert caught.value.time == pytest.approx(0.5, abs=1e-3)
    assert isinstance(caught.value.partial, Trajectory)
    assert caught.value.partial.times.tolist() == [0.0, 0.1]


def load_horizontal(n: int) -> Cable:
    """240 m of 2 cm steel cable hanging at rest in the sea with a 60 kg load."""
    one, length = np.ones(n), 240.0 / n
    mass = np.pi * 0.01**2 * length * 7850.0
    links = Links(
        length=length * one,
        mass=mass * one,
        inertia=mass * length**2 / 12 * one,
        volume=mass / 7850.0 * one,
        joint_stiffness=5 / 6 * n * 8e10 * (np.pi * 0.01**4 / 4) / 240.0 * one,
        joint_damping=11.2 * one,
        drag_area=0.02 * length * one,
        drag=one,
    )
    weight = (n * mass + 60.0) * (1 - 1000 / 7850) * 9.81
    floater = {"M_1": 6000.0, "k_m1": 400.0, "c_m1": 79.2, "static_load": weight}
    return Cable(
        name="load-horizontal",
        links=links,
        terminal=Terminal.LOAD,
        drag=Drag.COEFFICIENT,
        parameters={"g": 9.81, "rho_w": 1000.0, "m_c": 60.0, "rho_c": 7850.0, **floater},
        inputs=("u_m1", "F_cx", "F_cy"),
        position=np.zeros(n + 1),
        velocity=np.zeros(n + 1),
    )


@pytest.mark.parametrize(("rule", "reach"), [("virtual_work", 12.5), ("projected", 7.2)])
def test_both_terminal_rules_on_a_load_pulled_sideways(rule: str, reach: float) -> None:
    """200 N for 15.5 s on 20 links: how far the print's rule departs in a whole motion [m]."""
    reference = Reference(load_horizontal(20), terminal_rule=rule)  # type: ignore[arg-type]
    run = integrate(reference, lambda t: {"F_cx": 200.0}, [0.0, 15.5], rtol=1e-7, atol=1e-9)
    assert run.outputs["x_c"][-1] == pytest.approx(reach, abs=0.05)
