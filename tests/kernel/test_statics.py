"""Equilibria that the kernel finds: forces balance, the cable would stay, whatever it starts from and hangs on.

Checked with the dense reference model, which shares no code with the kernel, with scipy's minimisers, and against
textbook problems in test_statics_classics.py.
"""

from __future__ import annotations

import ctypes
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize, root

from cablefmu.cable import Cable, Floats, SolverChoice, Terminal
from cablefmu.reference import Reference
from cablefmu.scene import Scene, load_scene
from tests.kernel.library import Kernel, inputs_of
from tests.kernel.resting import START_NAMES, cable_of, end_of, held, start, tangent_stiffness
from tests.random_cables import KINDS, random_inputs
from tests.validation.cables import links_of, load_cable

OK, NO_BALANCE, NOT_FINITE = range(3)

BALANCE = 1e-9
"""Largest acceleration left per link [m/s^2, rad/s^2]: 1e-10 of gravity. Rounding of P_n, some 1e-16 of a cable of 10 m
a link and more where it is added up, comes back with the anchor's stiffness over its mass or the pin's 100/s^2."""

MOST_ITERATIONS = 4000
"""Where the search gives up"""


def balance(n: int) -> float:
    return BALANCE * (1 + n)


def inputs_for(cable: Cable, draw: int = 0) -> dict[str, float]:
    return random_inputs(np.random.default_rng([cable.n, draw, 1]), cable)


def negative_pivots(kernel: Kernel, q: Floats, inputs: dict[str, float]) -> int:
    """Of the tangent stiffness, that is how many ways lead downhill."""
    x, nothing = np.concatenate([q, np.zeros_like(q)]), np.zeros_like(q)
    solved = kernel.linear(x, inputs_of(inputs), np.array([1.0, 0.0, 0.0]), nothing, np.zeros(2))
    assert solved is not None
    return solved.negative


def has_rest(cable: Cable, name: str) -> bool:
    """A straight cable from side to side that two points hold cannot carry a weight."""
    return not (cable.terminal is Terminal.ANCHOR_MASS and name == "horizontal")


@pytest.mark.parametrize("n", [1, 2, 3, 12, 120, 1000])
@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_any_start_comes_to_rest_by_the_dense_equations(library: ctypes.CDLL, n: int, kind: int) -> None:
    cable = cable_of(kind, n)
    inputs = inputs_for(cable)
    for name in START_NAMES:
        if not has_rest(cable, name):
            continue
        first = start(name, n)
        fixed = held(cable, first)
        status, q, residual, _ = Kernel(library, cable).equilibrium(first, inputs)
        assert status == OK, name
        if n <= 120:
            assert np.abs(Reference(fixed).acceleration(q, np.zeros_like(q), inputs)).max() < balance(n), name
        kernel = Kernel(library, fixed)
        acceleration = kernel.acceleration(q, np.zeros_like(q), inputs)
        assert np.abs(acceleration).max() < balance(n), name
        if fixed is cable:
            assert residual == np.abs(acceleration).max()
        if fixed.terminal is Terminal.PIN:
            off = end_of(fixed, q) - fixed.rest_position
            assert np.hypot(*off) < 1e-11 * fixed.links.length.sum(), name
        assert negative_pivots(kernel, q, inputs) == 0, name


@pytest.mark.parametrize("n", [2, 3, 12])
@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_every_way_from_there_leads_uphill(library: ctypes.CDLL, n: int, kind: int) -> None:
    """Eigenvalues of the dense tangent stiffness by differences, whose error is 1e-10 of the largest; the least are
    1e-6 of it, the stiffness of a heavy load's swing beside that of a floater's spring of 1e5 N/m."""
    cable = cable_of(kind, n, draw=1)
    inputs = inputs_for(cable)
    for name in START_NAMES:
        if not has_rest(cable, name):
            continue
        first = start(name, n)
        fixed = held(cable, first)
        status, q, _, _ = Kernel(library, fixed).equilibrium(first, inputs)
        assert status == OK
        values = np.linalg.eigvalsh(tangent_stiffness(fixed, q, inputs))
        assert np.all(values > 1e-8 * np.abs(values).max()), name


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", [k for k, (terminal, *_) in enumerate(KINDS) if terminal != Terminal.ANCHOR_MASS])
def test_a_minimum_of_the_energy_that_scipy_finds_as_well(library: ctypes.CDLL, n: int, kind: int) -> None:
    """From 0.05 rad away, by a descent on the dense energy, and on to the root of the dense accelerations."""
    cable = cable_of(kind, n, draw=2)
    inputs, reference = inputs_for(cable), Reference(cable)
    still = np.zeros(n + 1)
    status, q, _, _ = Kernel(library, cable).equilibrium(start("random", n), inputs)
    assert status == OK

    def energy(at: Floats) -> float:
        end = end_of(cable, at)
        work = inputs["u_m1"] * at[0] + inputs.get("F_cx", 0.0) * end[0]
        work += (inputs.get("F_cy", 0.0) + inputs.get("u_m2", 0.0)) * end[1]
        return float(reference.outputs(at, still, {})["energy"] - work) * 1e-3

    near = q + 0.05 * np.random.default_rng(n).uniform(-1.0, 1.0, n + 1)
    pinned = cable.terminal is Terminal.PIN
    options = (
        {"method": "SLSQP", "constraints": {"type": "eq", "fun": lambda at: end_of(cable, at) - cable.rest_position}}
        if pinned
        else {"method": "BFGS"}
    )
    low = minimize(energy, near, **options).x  # type: ignore[call-overload]
    assert np.abs(low - q).max() < 5e-3  # as close as differences of an energy lead
    found = root(lambda at: reference.acceleration(at, still, inputs), low, tol=1e-13)
    np.testing.assert_allclose(q, found.x, rtol=0.0, atol=1e-8)


def test_an_anchor_of_mass_rests_as_a_pin_does(library: ctypes.CDLL) -> None:
    """Of eight hundred million kilograms or of one: what holds it is not in question."""
    kind = next(k for k, (terminal, *_) in enumerate(KINDS) if terminal is Terminal.ANCHOR_MASS)
    cable, first = cable_of(kind, 12), start("zigzag", 12)
    pinned = Kernel(library, held(cable, first)).equilibrium(first, {"u_m1": 500.0})[1]
    for mass in (1.0, 8e8):
        heavy = replace(cable, parameters=cable.parameters | {"m_c": mass})
        q = Kernel(library, heavy).equilibrium(first, {"u_m1": 500.0})[1]
        np.testing.assert_allclose(q, pinned, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("slack", [0.0, 0.05, 0.3, 0.99, 0.999])
@pytest.mark.parametrize("n", [3, 12, 120])
def test_a_pin_is_reached_from_anywhere(library: ctypes.CDLL, n: int, slack: float) -> None:
    kind = next(k for k, (terminal, *_) in enumerate(KINDS) if terminal is Terminal.PIN)
    cable = cable_of(kind, n, slack=slack)
    kernel = Kernel(library, cable)
    for name in START_NAMES:
        status, q, residual, _ = kernel.equilibrium(start(name, n), {})
        assert status == OK, name
        assert residual < balance(n), name
        assert np.hypot(*(end_of(cable, q) - cable.rest_position)) < 1e-11 * cable.links.length.sum()
        assert negative_pivots(kernel, q, {}) == 0


def test_the_pull_at_a_pin_closes_the_balance(library: ctypes.CDLL) -> None:
    """All forces from outside add up to nothing: weights, floater and pin, by the outputs alone."""
    kind = next(k for k, (terminal, water, _) in enumerate(KINDS) if terminal is Terminal.PIN and not water)
    cable = cable_of(kind, 12)
    kernel, p = Kernel(library, cable), cable.parameters
    q = kernel.equilibrium(start("hanging", 12), {"u_m1": 300.0})[1]
    at_pin = -Reference(cable).joint_forces(q, np.zeros_like(q), {"u_m1": 300.0})[-1]
    floater = 300.0 - p["k_m1"] * q[0] - p["static_load"]
    weight = float(cable.links.mass.sum()) * p["g"]
    assert at_pin[1] + floater + weight == pytest.approx(0.0, abs=1e-9 * weight)


# --- hard loads ---


def hanging(n: int, *, stiffness: float = 0.0, load: float = 60.0, k_m1: float = 1200.0) -> Cable:
    """The cable of Table 6.1 in air, its load carried by the floater at rest."""
    steel = links_of(n, 240.0, 592.0, stiffness=np.full(n, 5.0 / 6.0 * stiffness * n / 240.0))
    carried = (592.0 + load) * 9.81
    return load_cable(steel, np.zeros(n + 1), g=9.81, M_1=6000.0, k_m1=k_m1, static_load=carried, m_c=load)


@pytest.mark.parametrize("sideways", [0.0, 1.0, 200.0])
@pytest.mark.parametrize("n", [12, 80, 1000])
def test_two_thousand_newtons_of_lift(library: ctypes.CDLL, n: int, sideways: float) -> None:
    """Hanging straight the forces balance as well, but the load would not stay below: it weighs 60 kg."""
    cable, inputs = hanging(n, stiffness=628.3), {"F_cx": sideways, "F_cy": -2000.0}
    kernel, net = Kernel(library, cable), 2000.0 - 60.0 * 9.81
    for name in START_NAMES:
        status, q, residual, _ = kernel.equilibrium(start(name, n), inputs)
        assert status == OK, name
        assert residual < balance(n)
        assert negative_pivots(kernel, q, inputs) == 0
        # The net lift carries its share of the weight straight up: without bending the end is at 240 m less twice that
        # part, and the floater rises. A hairpin takes room, and one that is wound up takes a link or two more.
        limp = 240.0 * (1.0 - 2.0 * net / (592.0 * 9.81)) - net / cable.parameters["k_m1"]
        assert abs(end_of(cable, q)[1] - limp) < 20.0 + 2 * 240.0 / n, name


@pytest.mark.parametrize("load", [1e-6, 1e-3, 1.0, 1e3, 1e7, 1e10])
@pytest.mark.parametrize("n", [1, 12, 120])
def test_loads_of_a_milligram_and_of_a_mountain(library: ctypes.CDLL, n: int, load: float) -> None:
    """tan th_i = F_cx / (weight below the middle of link i), joints being free."""
    cable = hanging(n, load=load)
    force = 0.3 * (load + 592.0) * 9.81
    below = (load + 592.0 * (np.arange(n, 0, -1) - 0.5) / n) * 9.81
    for name in ("horizontal", "inverted", "coil", "random"):
        status, q, _, _ = Kernel(library, cable).equilibrium(start(name, n), {"F_cx": force})
        assert status == OK, name
        expected = np.arctan2(force, below)
        turns = np.round((q[1:] - expected) / (2 * np.pi))
        # as exact as the forces: rounding of the load's weight, over a link's own
        np.testing.assert_allclose(q[1:] - 2 * np.pi * turns, expected, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("bending_stiffness", [0.0, 1e-3, 1.0, 1e3, 1e6, 1e9])
@pytest.mark.parametrize("n", [2, 12, 120])
def test_from_limp_to_rigid(library: ctypes.CDLL, n: int, bending_stiffness: float) -> None:
    """Accelerations of a rigid cable answer to rounding of its angles: EI / l / (m l^2/3) times 1e-16 and the number of
    links."""
    cable, inputs = hanging(n, stiffness=bending_stiffness), {"F_cx": 200.0}
    kernel, length = Kernel(library, cable), 240.0 / n
    rounding = bending_stiffness / length / (592.0 / n * length**2 / 3.0) * 1e-16 * n
    for name in START_NAMES:
        status, q, residual, _ = kernel.equilibrium(start(name, n), inputs)
        assert status == OK, name
        assert residual < balance(n) + 100.0 * rounding, name
        assert negative_pivots(kernel, q, inputs) == 0


# --- no equilibrium ---


def unbalanced() -> dict[str, tuple[Cable, dict[str, float]]]:
    pin = next(k for k, (terminal, *_) in enumerate(KINDS) if terminal is Terminal.PIN)
    anchor = next(k for k, (terminal, *_) in enumerate(KINDS) if terminal is Terminal.ANCHOR_MASS)
    far = cable_of(pin, 12)
    reach = float(far.links.length.sum())
    sinking = hanging(12, k_m1=0.0)
    limp = load_cable(links_of(12, 240.0, 592.0), np.zeros(13), M_1=6000.0, k_m1=1200.0)
    taut = cable_of(anchor, 12)
    return {
        "nothing holds the floater": (sinking, {"u_m1": 100.0}),
        "nothing holds the floater, but balance": (sinking, {}),
        "neither weight nor stiffness": (limp, {}),
        "a pin out of reach": (replace(far, rest_position=(1.5 * reach, 0.0)), {}),
        "straight from side to side, with weight": (replace(taut, position=start("horizontal", 12)), {}),
    }


@pytest.mark.parametrize("why", unbalanced())
@pytest.mark.parametrize("name", ["hanging", "horizontal", "coil", "random"])
def test_where_there_is_no_equilibrium_the_search_says_so(library: ctypes.CDLL, why: str, name: str) -> None:
    """Neutral is not stable: what may rest anywhere rests nowhere in particular."""
    cable, inputs = unbalanced()[why]
    first = cable.position if why.startswith("straight") else start(name, 12)
    status, q, residual, iterations = Kernel(library, cable).equilibrium(first, inputs)
    assert status == NO_BALANCE
    assert np.all(np.isfinite(q)) and np.isfinite(residual)
    assert iterations <= MOST_ITERATIONS


@pytest.mark.parametrize("force", [1e300, -1e308, 1e308])
def test_forces_at_the_end_of_the_range_of_numbers(library: ctypes.CDLL, force: float) -> None:
    """1e300 N sideways pull a limp cable straight; where numbers end, the search says so."""
    status, q, residual, iterations = Kernel(library, hanging(12)).equilibrium(start("coil", 12), {"F_cx": force})
    assert status == (OK if abs(force) < 1e305 else NOT_FINITE)
    assert iterations <= MOST_ITERATIONS
    if status == OK:
        assert np.isfinite(residual)
        np.testing.assert_allclose(np.sin(q[1:]), np.sign(force), rtol=1e-12)


def test_the_same_start_gives_the_same_bits(library: ctypes.CDLL) -> None:
    """Whatever the scratch held: pushes are no accidents."""
    cable, inputs = hanging(60, stiffness=628.3), {"F_cy": -2000.0}
    kernel = Kernel(library, cable)
    first = kernel.equilibrium(start("hanging", 60), inputs)[1]
    kernel.equilibrium(start("coil", 60), inputs)
    kernel.spoil_scratch()
    assert np.array_equal(kernel.equilibrium(start("hanging", 60), inputs)[1], first)


# --- staying there ---


SCENES = ("free-60-water", "seabed-mass-60", "seabed-spring-60", "floaters-both-80", "seabed-pin-60")
"""One of each terminal"""


@pytest.mark.parametrize("n", [12, 120, 1000])
@pytest.mark.parametrize("name", SCENES)
def test_a_run_from_equilibrium_stays_there(library: ctypes.CDLL, name: str, n: int) -> None:
    """For 60 s neither floater nor terminal moves faster than 1e-9 m/s, as hosts see them.

    Nodes between them feel the rounding of 1000 short links: joints of 2 kN m/rad answer to 1e-16 rad with
    accelerations of 1e-10 rad/s^2 and more, which some swing with by 1e-9 m/s. Nothing but its mass holds an anchor of
    mass, and it follows the cable's pull R with R t / m: a true motion, of 1e-4 m/s for 8e8 kg. It has 1e18 kg here,
    and nothing takes from it what rounding of the links' rates adds up to: 7e-9 to 2e-8 m/s from starts 1e-14 apart.
    """
    text = re.sub(r"links = \d+", f"links = {n}", load_scene(name).text)
    cable = Scene.from_text(text, name="changed").cable
    if cable.terminal is Terminal.ANCHOR_MASS:
        cable = replace(cable, parameters=cable.parameters | {"m_c": 1e18})
    kernel = Kernel(library, cable)
    status, q, _, _ = kernel.equilibrium(cable.position, {})
    assert status == OK
    long = 1e-9 if n < 1000 else 4e-8 if cable.terminal is Terminal.ANCHOR_MASS else 1e-8
    kernel.start(0.0, q, np.zeros_like(q), tolerance=1e-6, solver=SolverChoice.AUTOMATIC)
    for end in range(1, 61):
        run = kernel.advance(float(end), {})
        assert run.status == "ok"
        outputs = kernel.outputs_without_tensions(run.q, run.v)
        assert abs(outputs["v_m1"]) < 1e-9
        assert np.hypot(outputs["vx_c"], outputs["vy_c"]) < (long if cable.terminal is Terminal.ANCHOR_MASS else 1e-9)
        steps = cable.links.length * run.v[1:] * np.array([np.cos(run.q[1:]), -np.sin(run.q[1:])])
        assert np.hypot(np.cumsum(steps[0]), run.v[0] + np.cumsum(steps[1])).max() < long
    assert np.abs(run.q - q).max() < 1e-8
