"""The whole equation of motion: against the Lagrangian, at equilibria, and what a caller may do wrong."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from cablefmu.cable import Cable, Drag, Terminal, Top
from cablefmu.errors import OptionError
from cablefmu.reference import Reference
from cablefmu.reference.extended import extended_acceleration
from cablefmu.scene import load_scene
from tests.random_cables import KINDS, PORTS, random_cable, random_inputs, random_state
from tests.reference.lagrangian import INPUT_NAMES, derive

DIGITS = 40


@cache
def lagrangian_equation(n: int, top: Top) -> Any:
    """(I, T - everything else, J, V_n' - J x'', V_n, P_n) of n links as a function of numbers, from the symbols.

    J = dP_n/dq and what is behind it serve held ends alone.
    """
    d = derive(n, top)
    forces = sp.Matrix(d.end_forces()) + sp.Matrix(d.floater_forces())
    for centre, drag in zip(d.centres, d.drag_forces(), strict=True):
        forces += sp.Matrix(d.by_virtual_work(centre, drag))
    held_back = sp.Matrix(d.velocity_terms()) + sp.Matrix(d.gradient(d.weight_energy + d.spring_energy))
    held_back += sp.Matrix(d.loss_gradient(d.spring_loss))
    ends, c = d.chain.end_springs, d.chain
    symbols = [*d.q, *d.v, *d.inputs.values(), *c.length, *c.mass, *c.wet_mass, *c.inertia, *c.stiffness]
    symbols += [*c.damping, *c.drag, c.gravity, c.floater_mass, c.floater_stiffness, c.floater_damping]
    symbols += [c.static_load, c.surge_stiffness, c.surge_damping, c.static_pull, c.end_mass, c.end_wet_mass]
    symbols += [*ends.stiffness, *ends.damping, *ends.rest, *ends.preload]
    velocity = d.rate(d.end)
    constraint = [d.end.jacobian(d.q), d.rate(velocity), velocity, d.end]
    return sp.lambdify(symbols, [d.inertia(), forces - held_back, *constraint], modules="mpmath", cse=True)


def held(cable: Cable, inputs: dict[str, float], equation: Any) -> Any:
    """x'' by elimination of the multiplier: P_n'' is prescribed, with 10/s for the pin's rate."""
    inertia, right_side, jacobian, convective, velocity, end = equation
    start = dict(zip(("x_2", "y_2"), cable.rest_position, strict=True))

    def given(kind: str) -> Any:
        names = [f"{kind}{axis}_2" for axis in "xy"]
        return mpmath.matrix([mpmath.mpf(inputs.get(name, start.get(name, 0.0))) for name in names])

    prescribed = given("a") - 20 * (velocity - given("v")) - 100 * (end - given(""))
    compliance = jacobian * mpmath.inverse(inertia) * jacobian.T
    free = mpmath.lu_solve(inertia, right_side)
    multiplier = mpmath.lu_solve(compliance, jacobian * free + convective - prescribed)
    return free - mpmath.inverse(inertia) * jacobian.T * multiplier


def numbers_of(cable: Cable) -> list[Any]:
    """The cable's numbers in that order, worked out from `Cable`'s docstring, not by the reference."""
    p = {name: mpmath.mpf(value) for name, value in cable.parameters.items()}
    zero, links, n = mpmath.mpf(0), cable.links, cable.n

    def exact(values: Any) -> list[Any]:
        return [mpmath.mpf(float(value)) for value in values]

    rho_w, m_c = p.get("rho_w", zero), p.get("M_2", p.get("m_c", zero))
    wet = [m - rho_w * v for m, v in zip(exact(links.mass), exact(links.volume), strict=True)]
    if cable.terminal in (Terminal.ANCHOR_MASS, Terminal.FLOATER):
        end_wet = zero
    else:
        end_wet = m_c - rho_w * (m_c / p["rho_c"] if "rho_c" in p else p.get("V_c", zero))
    inertia = exact(links.inertia)
    inertia[-1] += p.get("I_Rc", zero)
    stiffness = [p["k_joint"]] * n if "k_joint" in p else exact(links.joint_stiffness)
    damping = [p["c_joint"]] * n if "c_joint" in p else exact(links.joint_damping)
    drag = [p["Cd"]] * n if "Cd" in p else exact(links.drag)
    if cable.drag is Drag.COEFFICIENT:
        drag = [rho_w * cd * area / 2 for cd, area in zip(drag, exact(links.drag_area), strict=True)]
    suffix = "2" if cable.terminal is Terminal.FLOATER else "c"
    k_d = [p.get(f"{kind}_{'m2' if suffix == '2' else 'c'}{axis}", zero) for kind in "kc" for axis in "HV"]
    preload = [p.get("static_pull_2", zero), -p.get("static_load_2", zero)]
    ports = [p["g"]]
    ports += [p.get(name, zero) for name in ("M_1", "k_m1", "c_m1", "static_load", "k_m1H", "c_m1H", "static_pull")]
    return [
        *exact(links.length),
        *exact(links.mass),
        *wet,
        *inertia,
        *stiffness,
        *damping,
        *drag,
        *ports,
        m_c,
        end_wet,
        *k_d,
        *exact(cable.rest_position),
        *preload,
    ]


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize(("top", "terminal", "water", "drag"), [(Top.FLOATER, *kind) for kind in KINDS] + PORTS)
def test_acceleration_of_every_kind_of_cable(n: int, top: Top, terminal: Terminal, water: bool, drag: Drag) -> None:
    """Two links between two held ends hang by their constraint alone, and yet turn by it."""
    rng = np.random.default_rng(n)
    cable = random_cable(rng, n, terminal, water, top=top, drag=drag)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    with mpmath.workdps(DIGITS):
        forces = [mpmath.mpf(inputs.get(name, 0.0)) for name in INPUT_NAMES]
        state = [mpmath.mpf(x) for x in (*q, *v)]
        equation = lagrangian_equation(n, top)(*state, *forces, *numbers_of(cable))
        if terminal in (Terminal.PIN, Terminal.MOTION):
            expected = list(held(cable, inputs, equation))
        else:
            expected = list(mpmath.lu_solve(*equation[:2]))
        exact = extended_acceleration(cable, q, v, inputs, digits=DIGITS)
        size = max(abs(x) for x in expected)
        # 40 digits less the condition of I (up to 1e5) and a hundred roundings
        assert all(abs(a - b) < size * mpmath.mpf(10) ** -32 for a, b in zip(exact, expected, strict=True))
    # 16 digits less the same
    in_doubles = Reference(cable).acceleration(q, v, inputs)
    assert in_doubles == pytest.approx(np.array(expected, dtype=float), rel=0, abs=1e-10 * float(size))


@pytest.mark.parametrize("water", [False, True])
def test_hanging_cable_stays_at_rest(water: bool) -> None:
    cable = random_cable(np.random.default_rng(3), 25, Terminal.LOAD, water)
    reference = Reference(cable)
    weight = (reference.chain.wet_mass.sum() + reference.chain.end_wet_mass) * cable.parameters["g"]
    held = Reference(replace(cable, parameters=cable.parameters | {"static_load": weight}))
    nothing = np.zeros(26)
    # weight [N] over floater mass is a few m/s^2 in doubles
    assert held.acceleration(nothing, nothing, {}) == pytest.approx(nothing, abs=1e-13)


@pytest.mark.parametrize("scene", ["seabed-mass-60", "seabed-pin-60", "seabed-spring-60", "floaters-restrained-80"])
def test_shipped_rest_shapes_are_equilibria_of_links_without_bending_stiffness(scene: str) -> None:
    """Catenary, static loads and pulls come from statics; the equation of motion must find nothing to do.

    The anchor mass alone has no spring to hold it: 1.6 kN of pull moves 8e8 kg by 2e-6 m/s^2, and the
    lowest link turns accordingly.
    """
    cable = load_scene(scene).cable
    limp = replace(cable.links, joint_stiffness=np.zeros(cable.n))
    rest = {name: value for name, value in cable.parameters.items() if name != "k_joint"}
    at_rest = Reference(replace(cable, links=limp, parameters=rest))
    drift = at_rest.acceleration(cable.position, cable.velocity, {})
    assert np.abs(drift).max() < (1e-5 if cable.terminal is Terminal.ANCHOR_MASS else 1e-8)


def test_heave_rules_differ_by_the_static_load_on_the_floater() -> None:
    rng = np.random.default_rng(8)
    cable = random_cable(rng, 6, Terminal.LOAD, water=True)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    load = cable.parameters["static_load"]
    lifted = Reference(cable).acceleration(q, v, inputs)
    appendix = Reference(cable, heave_rule="none").acceleration(q, v, inputs | {"u_m1": inputs["u_m1"] - load})
    assert lifted == pytest.approx(appendix, rel=1e-9)
    assert Reference(cable, heave_rule="none").acceleration(q, v, inputs)[0] > lifted[0]


def test_parameter_wins_over_the_arrays() -> None:
    rng = np.random.default_rng(21)
    cable = random_cable(rng, 5, Terminal.LOAD, water=True, uneven=False)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    changes = {"k_joint": 17.0, "c_joint": 3.0, "Cd": 0.7}
    by_parameter = replace(cable, parameters=cable.parameters | changes)
    arrays = replace(
        cable.links,
        joint_stiffness=np.full(5, 17.0),
        joint_damping=np.full(5, 3.0),
        drag=np.full(5, 0.7),
    )
    rest = {name: value for name, value in cable.parameters.items() if name not in changes}
    by_array = replace(cable, links=arrays, parameters=rest)
    changed = Reference(by_parameter).acceleration(q, v, inputs)
    assert np.array_equal(changed, Reference(by_array).acceleration(q, v, inputs))
    assert not np.allclose(changed, Reference(cable).acceleration(q, v, inputs))


def test_right_side_is_pure() -> None:
    rng = np.random.default_rng(4)
    cable = random_cable(rng, 8, Terminal.FLOATER, water=True)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    kept = q.copy(), v.copy(), dict(inputs)
    reference = Reference(cable)
    first, again = (reference.acceleration(q, v, inputs) for _ in range(2))
    assert np.array_equal(first, again)
    assert np.array_equal(q, kept[0]) and np.array_equal(v, kept[1]) and inputs == kept[2]


def test_departure_report_names_every_coordinate() -> None:
    rng = np.random.default_rng(6)
    cable = random_cable(rng, 3, Terminal.LOAD, water=False)
    (q, v), inputs = random_state(rng, cable), {"F_cx": 200.0, "F_cy": -150.0}
    lines = Reference(cable).departure_report(q, v, inputs).splitlines()
    assert [line.split()[0] for line in lines[1:]] == ["y_m", "theta[1]", "theta[2]", "theta[3]"]
    shown = [float(line.split()[-1]) for line in lines[1:]]
    assert shown == pytest.approx(Reference(cable).departure(q, v, inputs), rel=1e-5)
    assert shown[0] == 150.0  # the print never passes the vertical force on to floater 1


def test_mistakes_of_the_caller_are_named() -> None:
    cable = random_cable(np.random.default_rng(1), 3, Terminal.ANCHOR_MASS, water=True)
    q = np.zeros(4)
    with pytest.raises(OptionError, match=r"q must have shape \(4,\), got \(3,\)"):
        Reference(cable).acceleration(np.zeros(3), q, {})
    with pytest.raises(OptionError, match='input "F_cx" does not exist; allowed: "u_m1"'):
        Reference(cable).acceleration(q, q, {"F_cx": 1.0})
    with pytest.raises(OptionError, match="v must be finite"):
        Reference(cable).acceleration(q, np.array([0.0, np.nan, 0.0, 0.0]), {})
    with pytest.raises(OptionError, match='input "u_m1" must be finite, got inf'):
        Reference(cable).acceleration(q, q, {"u_m1": np.inf})
    with pytest.raises(OptionError, match='terminal_rule "guess" does not exist; allowed: "virtual_work"'):
        Reference(cable, terminal_rule="guess")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match='heave_rule "" does not exist'):
        Reference(cable, heave_rule="")  # type: ignore[arg-type]
