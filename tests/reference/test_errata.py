"""The print's mistakes as counter-examples: each printed form disagrees with the Lagrangian.

In the order of the numbers in the dissertation. Every test also evaluates the corrected form by the same
lines, so that it is the mistake and not the test that disagrees. The tables' units of k_m and c_m and
[4.41]'s motors appear in no formula of the model and hence not here.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate
from typing import Any

import numpy as np
import pytest
import sympy as sp

from cablefmu.cable import Floats, Terminal
from cablefmu.reference import Reference
from cablefmu.reference.chain import Array, Chain, chain_of
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.matrices import inertia_matrix, stiffness_matrix
from cablefmu.reference.terminal import projected, virtual_work
from cablefmu.reference.vectors import gravity_vector
from tests.random_cables import random_cable, random_state
from tests.reference.lagrangian import derive, same

N = 3
"""Links of the symbolic counter-examples: the fewest at which every mistake shows."""


def numeric(seed: int, n: int = 5) -> tuple[Chain, Motion, Floats, Floats]:
    """An uneven chain in air in a random state."""
    rng = np.random.default_rng(seed)
    cable = random_cable(rng, n, Terminal.LOAD, water=False)
    q, v = random_state(rng, cable)
    return chain_of(cable), motion_of(q, v), q, v


@pytest.mark.parametrize("as_printed", [False, True])
def test_2_8_links_above_count_with_their_whole_rise(as_printed: bool) -> None:
    """h_i sums a_k = l_k/2 (1 - cos th_k) over the links above where [2.9] has l_k (1 - cos th_k)."""
    d = derive(N)
    rise = [length * (1 - sp.cos(angle)) for length, angle in zip(d.chain.length, d.q[1:], strict=True)]
    above = [0, *accumulate(r / 2 if as_printed else r for r in rise)]
    heights = [above[i] + rise[i] / 2 for i in range(N)]
    energy = d.chain.gravity * (sum(d.chain.wet_mass * heights) + d.chain.end_wet_mass * above[N])
    agrees = [
        same(sp.diff(energy, angle), row) for angle, row in zip(d.q[1:], d.gradient(d.weight_energy)[1:], strict=True)
    ]
    # the last link has none below it but the load, whose height is halved as well
    assert agrees == [not as_printed] * N


@pytest.mark.parametrize("as_printed", [False, True])
def test_2_17_centres_end_with_their_own_half_link(as_printed: bool) -> None:
    """Inner sums to n - 1 with l_n/2 put every centre at the last link's."""
    d = derive(N)
    chain, kinetic = d.chain, sp.Integer(0)
    for i in range(N):
        last = N - 1 if as_printed else i
        links = [chain.length[k] * sp.Matrix([sp.sin(d.q[k + 1]), sp.cos(d.q[k + 1])]) for k in range(last + 1)]
        centre = sp.Matrix([0, d.q[0]]) + sum(links[:-1], sp.zeros(2, 1)) + links[-1] / 2
        kinetic += chain.mass[i] * d.rate(centre).dot(d.rate(centre)) / 2
    expected = inertia_matrix(_without_ends(chain), d.motion)
    agrees = same(sp.diff(kinetic, d.v[1], 2), expected[1, 1])
    assert agrees is not as_printed


@pytest.mark.parametrize("as_printed", [False, True])
def test_3_2_joint_springs_store_energy(as_printed: bool) -> None:
    """[3.2], [3.3], [3.17], [3.18], [3.32], [3.33] have the floater's spring alone; K has the joints'."""
    d = derive(N)
    energy = d.chain.floater_stiffness * d.q[0] ** 2 / 2
    if not as_printed:
        bends = [d.q[1]] + [d.q[i + 1] - d.q[i] for i in range(1, N)]
        energy += sum(k * bend**2 / 2 for k, bend in zip(d.chain.stiffness, bends, strict=True))
    agrees = sp.hessian(energy, d.q) == sp.Matrix(stiffness_matrix(d.chain))
    assert agrees is not as_printed


def algorithm_5_1(
    chain: Chain,
    motion: Motion,
    *,
    sums_from_top: bool = False,
    mass_of_row: bool = False,
    inertia_of_row: bool = False,
) -> Floats:
    """[5.1] as loops over rows and columns 1 ... n + 1; each flag turns one printed mistake on."""
    n = chain.n
    m, length, inertia, th = (
        np.concatenate([[np.nan], x]) for x in (chain.mass, chain.length, chain.inertia, motion.theta)
    )
    matrix = np.zeros((n + 2, n + 2))  # row and column 0 unused: the print counts from 1

    def carried(link: int) -> float:
        start = 1 if sums_from_top else link + 1
        return float(m[start:].sum() + chain.end_mass)

    matrix[1, 1] = chain.floater_mass + m[1:].sum() + chain.end_mass
    for j in range(2, n + 2):
        weight = m[j - 1] / 2 + carried(j - 1)
        matrix[1, j] = matrix[j, 1] = -weight * length[j - 1] * np.sin(th[j - 1])
        own = inertia[j] if inertia_of_row else inertia[j - 1]
        matrix[j, j] = (m[j - 1] / 4 + carried(j - 1)) * length[j - 1] ** 2 + own
        for i in range(2, j):
            weight = m[i if mass_of_row else j - 1] / 2 + carried(j - 1)
            pair = weight * length[i - 1] * length[j - 1] * np.cos(th[i - 1] - th[j - 1])
            matrix[i, j] = matrix[j, i] = pair
    return matrix[1:, 1:]


def test_5_1_corrected_by_appendix_a_is_the_reference() -> None:
    chain, motion, _, _ = numeric(51)
    assert algorithm_5_1(chain, motion) == pytest.approx(inertia_matrix(chain, motion), rel=1e-13)


@pytest.mark.parametrize("mistake", ["sums_from_top", "mass_of_row"])
def test_5_1_sums_below_and_mass_of_the_lower_link(mistake: str) -> None:
    """Sums from k = 1 make the cable heavier; m_i takes the upper link's mass for the lower one's."""
    chain, motion, _, v = numeric(51)
    printed, right = algorithm_5_1(chain, motion, **{mistake: True}), inertia_matrix(chain, motion)
    assert np.abs(printed - right).max() > 1e-3 * np.abs(right).max()
    kinetic = v @ right @ v / 2
    assert abs(v @ printed @ v / 2 - kinetic) > 1e-3 * kinetic


def test_5_1_inertia_of_the_row_asks_for_a_link_too_many() -> None:
    """I_Ri with i = 2 ... n + 1: row n + 1 has no such link."""
    chain, motion, _, _ = numeric(51)
    with pytest.raises(IndexError):
        algorithm_5_1(chain, motion, inertia_of_row=True)


@pytest.mark.parametrize("as_printed", [False, True])
def test_5_2_loop_forgets_what_it_mirrored(as_printed: bool) -> None:
    """a(j,i) is set with a(i,j) and reset when the loop comes to it: C and K lose their lower half."""
    chain, _, _, _ = numeric(52)
    n, k = chain.n, chain.stiffness
    matrix = np.zeros((n + 1, n + 1))
    matrix[0, 0] = chain.floater_stiffness
    for i in range(1, n + 1):
        for j in range(1, n + 1):
            if as_printed or j >= i:
                matrix[i, j] = 0.0
            if i == j:
                matrix[i, i] = k[i - 1] + (k[i] if i < n else 0.0)
            elif j == i + 1:
                matrix[i, j] = matrix[j, i] = -k[i]
    assert np.array_equal(matrix, np.triu(stiffness_matrix(chain))) is as_printed
    assert np.array_equal(matrix, stiffness_matrix(chain)) is not as_printed


def test_5_6_and_appendix_a_differ_in_what_rest_means() -> None:
    """[5.6] G_1 = 0 is a hanging cable carried at y_m = 0, A.1 G_1 = -(sum m + m_c) g one not carried."""
    chain, motion, _, _ = numeric(56)
    weight = (chain.mass.sum() + chain.end_mass) * chain.gravity
    carried, bare = replace(chain, static_load=weight), replace(chain, static_load=0.0)
    assert gravity_vector(carried, motion)[0] == pytest.approx(0.0, abs=1e-12 * weight)
    assert gravity_vector(bare, motion)[0] == pytest.approx(-weight)


@pytest.mark.parametrize("terminal", [Terminal.ANCHOR_MASS, Terminal.FLOATER])
def test_5_7_neutral_ends_weigh_nothing(terminal: Terminal) -> None:
    """m_c g in all cases adds a moment m_c g l_i sin th_i to every link."""
    rng = np.random.default_rng(57)
    cable = random_cable(rng, 4, terminal, water=True)
    chain, motion = chain_of(cable), motion_of(*random_state(rng, cable))
    printed = gravity_vector(replace(chain, end_wet_mass=chain.end_mass), motion)
    extra = chain.end_mass * 9.81 * np.append(-1.0, chain.length * motion.sin)
    assert printed - gravity_vector(chain, motion) == pytest.approx(extra)
    assert np.abs(extra).min() > 1.0  # N, N m


def test_5_7_would_sink_the_second_floater_by_49_m() -> None:
    """6000 kg on 1200 N/m."""
    rng = np.random.default_rng(57)
    cable = random_cable(rng, 3, Terminal.FLOATER, water=True)
    chain = chain_of(replace(cable, parameters=cable.parameters | {"M_2": 6000.0, "k_m2V": 1200.0}))
    motion = motion_of(np.zeros(4), np.zeros(4))
    printed = gravity_vector(replace(chain, end_wet_mass=chain.end_mass), motion)
    missing = gravity_vector(chain, motion)[0] - printed[0]
    assert missing / chain.end_springs.stiffness[1] == pytest.approx(49.05)


def test_5_8_torque_about_i_cross_j_turns_the_wrong_way() -> None:
    """With Y down i x j points into the page, about which a force towards +x turns the cable negatively."""
    d = derive(N)
    fx, fy = d.inputs["F_cx"], d.inputs["F_cy"]
    lever = d.end - sp.Matrix([0, d.q[0]])
    about_k = lever[0] * fy - lever[1] * fx
    work = sum(d.by_virtual_work(d.end, sp.Matrix([fx, fy]))[1:])  # all links turning as one
    assert not same(about_k, work)
    assert same(-about_k, work)


def test_5_8_scaling_by_cos_alpha_is_not_projecting() -> None:
    """Projected on the link, a force has no moment on it; scaled by cos(alpha), it keeps most of it."""
    chain, motion, _, _ = numeric(58)
    force, last = np.array([200.0, 90.0]), motion.along[-1]
    scaled, on_link = force * (force @ last / np.linalg.norm(force)), (force @ last) * last
    assert motion.across[-1] @ on_link == pytest.approx(0.0, abs=1e-12)
    assert abs(motion.across[-1] @ scaled) > 1.0
    assert not np.allclose(projected(chain, motion, force)[1:-1], virtual_work(chain, motion, force)[1:-1])


def test_5_8_no_vertical_force_reaches_floater_1() -> None:
    chain, motion, _, _ = numeric(58)
    lift = np.array([0.0, -2000.0])
    assert projected(chain, motion, lift)[0] == 0.0
    assert virtual_work(chain, motion, lift)[0] == -2000.0


def test_5_9_torques_reverse_under_compression() -> None:
    """Pushed along a slightly bent cable, every link but the last is turned against the push."""
    chain, _, _, _ = numeric(59, n=4)
    motion = motion_of(np.array([0.0, 0.1, 0.1, 0.1, 0.1]), np.zeros(5))
    push = np.array([0.0, -300.0])
    exact, printed = virtual_work(chain, motion, push)[1:], projected(chain, motion, push)[1:]
    assert np.all(exact > 0)
    assert np.all(printed[:-1] < 0) and printed[-1] > 0


@pytest.mark.parametrize(("sign", "moves"), [(-1, "right"), (+1, "left")])
def test_5_9_f_m2_is_minus_the_force_on_the_terminal(sign: int, moves: str) -> None:
    """F_m2 has no formula; read as +F, 200 N to the right would move the load left."""
    rng = np.random.default_rng(59)
    cable = random_cable(rng, 6, Terminal.LOAD, water=False)
    reference, rest = Reference(cable, terminal_rule="projected"), np.zeros(7)
    a = reference.acceleration(rest, rest, {"F_cx": -sign * 200.0})
    tip = cable.links.length @ a[1:]  # x_c'' of a hanging cable at rest
    assert (tip > 0) == (moves == "right")


@pytest.mark.parametrize("as_printed", [False, True])
def test_5_10_torque_on_the_last_link_is_assigned(as_printed: bool) -> None:
    """T_e(i+1) = tau_i for i < n only: the link that the force acts on is left out."""
    chain, motion, _, _ = numeric(60)
    force = np.array([200.0, -90.0])
    torques: Array = virtual_work(chain, motion, force)[1:]
    T_e = np.zeros(chain.n + 1)
    for i in range(1, chain.n if as_printed else chain.n + 1):
        T_e[i] = torques[i - 1]
    assert (T_e[-1] == pytest.approx(torques[-1])) is not as_printed
    assert abs(torques[-1]) > 1.0  # N m


def test_table_6_2_rotary_inertia_turns_with_the_last_link() -> None:
    """I_Rc = 50 kg m^2 is in no printed equation; its energy is I_Rc th_n'^2/2."""
    rng = np.random.default_rng(62)
    cable = random_cable(rng, 4, Terminal.LOAD, water=False)
    q, v = random_state(rng, cable)
    energies = []
    for inertia in (0.0, 50.0):
        chain = chain_of(replace(cable, parameters=cable.parameters | {"I_Rc": inertia}))
        energies.append(v @ inertia_matrix(chain, motion_of(q, v)) @ v / 2)
    assert energies[1] - energies[0] == pytest.approx(50.0 * v[-1] ** 2 / 2, rel=1e-9)
    assert energies[1] > energies[0]


def _without_ends(chain: Chain) -> Any:
    """Links as bare masses: no rotary inertia, no terminal, no floater."""
    zero = sp.Integer(0)
    return replace(chain, inertia=chain.inertia * zero, end_mass=zero, floater_mass=zero)
