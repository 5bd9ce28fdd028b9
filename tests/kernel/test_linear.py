"""The linearised chain's solver against a dense matrix that shares no code with it, its signs against eigenvalues."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from cablefmu.cable import Cable, Floats, Terminal
from cablefmu.reference import Reference
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import motion_of
from cablefmu.scene import load_scene
from cablefmu.shapes import catenary
from tests.kernel.cases import Case, case
from tests.kernel.dense_linear import DenseLinear
from tests.kernel.library import Kernel, Solved, inputs_of
from tests.random_cables import KINDS, random_cable

INERTIA, STIFFNESS = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
STEPS = ((1.0, 30.0, 900.0), (1.0, 1e3, 1e6))
"""Weights (w_q, w_v, w_a): of an implicit step they are (1, 1/g, 1/g^2) for g [s]."""
TIGHT = 1e-11
"""Largest error of a change over the largest change, where the inertia rules. Measured: 5e-12 at an end of 90 times the
cable's mass, which is eliminated; else 5e-13."""
LOOSE = 1e-8
"""The same of the tangent stiffness, which is near singular in some of the random states, with no pivoting. Measured:
2e-9 at 60 links, the median 3e-13."""


def solve(c: Case, weights: tuple[float, float, float], force: Floats, end: Floats) -> Solved:
    x, u = np.concatenate([c.q, c.v]), inputs_of(c.inputs)
    solved = c.kernel.linear(x, u, np.array(weights), force, end)
    assert solved is not None
    return solved


def right_side(c: Case) -> tuple[Floats, Floats]:
    """Forces of some kN on every coordinate, and an end that is off by some m/s^2."""
    rng = np.random.default_rng(c.cable.n)
    return 1e3 * rng.normal(size=c.cable.n + 1), rng.normal(size=2)


def assert_solved(c: Case, weights: tuple[float, float, float], bound: float) -> None:
    """Change against the dense matrix, and the pivots' signs against its determinant's."""
    dense = DenseLinear.about(c.cable, c.q, c.v, c.inputs, weights)
    force, end = right_side(c)
    solved, expected = solve(c, weights, force, end), dense.solved(force, end)
    assert np.abs(solved.change - expected).max() < bound * np.abs(expected).max()
    sign, _ = np.linalg.slogdet(dense.matrix.astype(float))
    assert (-1) ** solved.negative == sign


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("n", [1, 2, 3, 12, 60])
def test_solutions_are_those_of_the_dense_matrix(library: ctypes.CDLL, n: int, kind: int) -> None:
    c = case(library, n, kind)
    for weights in (INERTIA, *STEPS):
        assert_solved(c, weights, TIGHT)
    assert_solved(c, STIFFNESS, LOOSE)


@pytest.mark.parametrize("mass", [1e4, 1e5, 8e8, 1e12, 1e20])
@pytest.mark.parametrize("terminal", [Terminal.ANCHOR_MASS, Terminal.ANCHOR_SPRING, Terminal.FLOATER])
def test_solutions_at_heavy_ends(library: ctypes.CDLL, terminal: Terminal, mass: float) -> None:
    """In air without weight: that of 1e20 kg is more than the dense matrix can tell the cable's force from."""
    kind = next(k for k, (its, water, _) in enumerate(KINDS) if its is terminal and not water)
    c = case(library, 12, kind, draw=0, **{"M_2" if terminal is Terminal.FLOATER else "m_c": mass, "g": 0.0})
    for weights in (INERTIA, *STEPS):
        assert_solved(c, weights, TIGHT)


# --- taut cables, on a pin and behind 1e12 kg ---


def taut(library: ctypes.CDLL, terminal: Terminal, bend: float) -> Case:
    """Twelve links at rest within `bend` [rad] of a line, P_n at its pin."""
    kind = next(k for k, (its, water, _) in enumerate(KINDS) if its is terminal and water)
    c = case(library, 12, kind, draw=0, **({} if terminal is Terminal.PIN else {"m_c": 1e12}))
    q = np.concatenate([[0.0], 0.7 + bend * np.random.default_rng(12).uniform(-1.0, 1.0, 12)])
    end = c.cable.links.length @ np.column_stack([np.sin(q[1:]), np.cos(q[1:])])
    cable = replace(c.cable, rest_position=(float(end[0]), float(end[1])))
    return Case(cable, q, np.zeros(13), c.inputs, Kernel(library, cable), Reference(cable))


@pytest.mark.parametrize("bend", [1.0, 1e-2, 1e-4, 1e-8, 0.0])
@pytest.mark.parametrize("terminal", [Terminal.PIN, Terminal.ANCHOR_MASS])
def test_solutions_of_taut_cables(library: ctypes.CDLL, terminal: Terminal, bend: float) -> None:
    c = taut(library, terminal, bend)
    for weights in (INERTIA, *STEPS):
        assert_solved(c, weights, TIGHT)


# --- a thousand links, by what is left ---


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("weights", [INERTIA, *STEPS])
def test_what_a_thousand_links_leave(library: ctypes.CDLL, kind: int, weights: tuple[float, float, float]) -> None:
    """L change - force, by a product that has no factors, over the largest force. Measured: 2e-10.

    At rates of 0.01 rad/s, which move the end by metres a second; at 1 rad/s drag on a thousand links at random angles
    makes L itself as good as singular.
    """
    c = case(library, 1000, kind)
    c = replace(c, v=0.01 * c.v)
    force, end = right_side(c)
    solved = solve(c, weights, force, end)
    chain, across = chain_of(c.cable), motion_of(c.q, c.v).across
    jacobian = np.column_stack([[0.0, 1.0], (chain.length[:, None] * across).T])
    left = solved.back + solved.through @ jacobian - force
    assert np.abs(left).max() < 1e-9 * np.abs(force).max()
    if solved.through.any():
        assert np.abs(solved.end - end).max() < 1e-9


# --- signs ---


@pytest.mark.parametrize("kind", [k for k, (_, water, _) in enumerate(KINDS) if not water])
@pytest.mark.parametrize("n", [1, 2, 12, 60])
def test_inertia_is_positive(library: ctypes.CDLL, n: int, kind: int) -> None:
    """Of what is left to move, whatever the state: of one link on a pin nothing."""
    c = case(library, n, kind)
    free = DenseLinear.about(c.cable, c.q, c.v, c.inputs, INERTIA).free()
    assert free == pytest.approx(free.T, rel=0, abs=1e-13 * np.abs(free).max(initial=0.0))
    assert np.all(scipy.linalg.eigvalsh(free) > 0)
    assert solve(c, INERTIA, *right_side(c)).negative == 0


def limp(terminal: Terminal, n: int) -> Cable:
    """Unequal links in air without joint springs."""
    cable = random_cable(np.random.default_rng(n), n, terminal, water=False)
    kept = {name: value for name, value in cable.parameters.items() if name != "k_joint"}
    return replace(cable, parameters=kept, links=replace(cable.links, joint_stiffness=np.zeros(n)))


@pytest.mark.parametrize("up", range(16))
def test_as_many_negative_pivots_as_links_stand_on_their_heads(library: ctypes.CDLL, up: int) -> None:
    """Any links of a limp hanging cable may stand upwards in balance; each falls by itself, as K is diagonal there."""
    cable = limp(Terminal.LOAD, 4)
    p = cable.parameters
    carried = (cable.links.mass.sum() + p["m_c"]) * p["g"]
    cable = replace(cable, parameters=p | {"static_load": carried})
    upwards = np.array([bool(up >> i & 1) for i in range(4)])
    q, v = np.concatenate([[0.0], np.where(upwards, np.pi, 0.0)]), np.zeros(5)
    c = Case(cable, q, v, {}, Kernel(library, cable), Reference(cable))
    stiffness = DenseLinear.about(cable, q, v, {}, STIFFNESS).matrix.astype(float)
    assert stiffness == pytest.approx(np.diag(np.diag(stiffness)), abs=1e-9 * np.abs(stiffness).max())
    assert solve(c, STIFFNESS, *right_side(c)).negative == upwards.sum() == (np.diag(stiffness) < 0).sum()


def between(library: ctypes.CDLL, n: int, gravity: float) -> Case:
    """A limp cable between floater and pin in its rest shape, of which `gravity` < 0 makes an arch."""
    cable = limp(Terminal.PIN, n)
    links = cable.links
    end = (0.5 * float(links.length.sum()), 0.6 * float(links.length.sum()))
    shape = catenary(links.length, links.mass * 9.81, end)
    balanced = {"g": gravity, "static_load": gravity / 9.81 * shape.vertical}
    cable = replace(cable, rest_position=end, parameters=cable.parameters | balanced)
    return Case(
        cable, np.concatenate([[0.0], shape.angles]), np.zeros(n + 1), {}, Kernel(library, cable), Reference(cable)
    )


@pytest.mark.parametrize("n", [3, 12, 60])
def test_hanging_between_floater_and_pin_is_stable_and_an_arch_is_not(library: ctypes.CDLL, n: int) -> None:
    """As many negative pivots as K has negative eigenvalues on the shapes that the pin allows."""
    for gravity, stable in ((9.81, True), (-9.81, False)):
        c = between(library, n, gravity)
        assert np.abs(c.kernel.acceleration(c.q, c.v, c.inputs)).max() < 1e-6
        free = DenseLinear.about(c.cable, c.q, c.v, c.inputs, STIFFNESS).free()
        # the catenary ends within 1e-9 m of the pin, and what accelerates it is not symmetric
        assert free == pytest.approx(free.T, rel=0, abs=1e-7 * np.abs(free).max())
        negative = int(np.sum(scipy.linalg.eigvalsh((free + free.T) / 2) < 0))
        assert (negative == 0) == stable
        assert solve(c, STIFFNESS, *right_side(c)).negative == negative


def test_joints_that_stiffen_leave_one_way_to_fall(library: ctypes.CDLL) -> None:
    """Upside down in a straight line on a limp joint at the top: each link by itself at first, all as one at last."""
    counts = []
    q, v = np.concatenate([[0.0], np.full(6, np.pi)]), np.zeros(7)
    for bending in (0.0, 1e3, 3e3, 1e4, 1e5, 1e7):
        cable = limp(Terminal.LOAD, 6)
        p = cable.parameters
        carried = (cable.links.mass.sum() + p["m_c"]) * p["g"]
        joints = np.concatenate([[0.0], np.full(5, bending)])
        cable = replace(
            cable, parameters=p | {"static_load": carried}, links=replace(cable.links, joint_stiffness=joints)
        )
        c = Case(cable, q, v, {}, Kernel(library, cable), Reference(cable))
        stiffness = DenseLinear.about(cable, q, v, {}, STIFFNESS).matrix.astype(float)
        counts.append(solve(c, STIFFNESS, *right_side(c)).negative)
        assert counts[-1] == np.sum(scipy.linalg.eigvalsh(stiffness) < 0)
    assert counts == sorted(counts, reverse=True)
    assert counts[0] == 6 and counts[-1] == 1 and len(set(counts)) > 3


def test_seabed_scenes_are_definite_for_an_implicit_step(library: ctypes.CDLL) -> None:
    for name in ("seabed-pin-60", "seabed-mass-60", "seabed-spring-60"):
        cable = load_scene(name).cable
        c = Case(cable, cable.position, cable.velocity, {}, Kernel(library, cable), Reference(cable))
        for weights in (INERTIA, *STEPS):
            assert solve(c, weights, *right_side(c)).negative == 0
