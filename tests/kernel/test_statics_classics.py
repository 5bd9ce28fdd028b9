"""Equilibria with known answers: the catenary, the elastica, Euler's column."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Floats, Terminal
from tests.kernel.library import Kernel
from tests.kernel.resting import end_of, start
from tests.validation.cables import GRAVITY, cantilever, links_of
from tests.validation.catenary import links_for
from tests.validation.checks import read_table
from tests.validation.elastica import departures

RIGID = 1e15
"""Stiffness of a top that does not heave [N/m]: below 1e-10 m for 1e5 N."""

SUSPENDED = read_table("catenary_inextensible")
LOADS = read_table("elastica_cantilever_tip_load")


def slack(row: dict[str, float], n: int) -> Cable:
    """n limp links between a fixed top and a pin."""
    length, weight = row["L_m"], row["L_m"] * row["w_N_per_m"]
    return Cable(
        name="catenary",
        links=links_of(n, length, weight / GRAVITY),
        terminal=Terminal.PIN,
        drag=Drag.NONE,
        parameters={"g": GRAVITY, "M_1": 6000.0, "k_m1": RIGID, "c_m1": 0.0, "static_load": 0.0},
        inputs=("u_m1",),
        position=np.zeros(n + 1),
        velocity=np.zeros(n + 1),
        rest_position=(row["x_m"], row["z_m"]),
    )


def smooth(row: dict[str, float], along: Floats) -> Floats:
    """Points of the inextensible catenary at arc lengths from the top, shape (..., 2) [m].

    With T = hypot(H, V - w s): x = H/w (asinh(V/H) - asinh((V - w s)/H)), y = (T(0) - T(s))/w.
    """
    pull, top, w = row["H_N"], row["V_top_N"], row["w_N_per_m"]
    up = top - w * along
    x = pull / w * (np.arcsinh(top / pull) - np.arcsinh(up / pull))
    return np.column_stack([x, (np.hypot(pull, top) - np.hypot(pull, up)) / w])


def catenary_errors(library: ctypes.CDLL, row: dict[str, float], n: int) -> tuple[float, float]:
    """Largest distance of a quarter point from the smooth curve over L; error of the pull at the top over it."""
    cable = slack(row, n)
    kernel = Kernel(library, cable)
    status, q, _, _ = kernel.equilibrium(start("zigzag", n), {})
    assert status == 0
    steps = row["L_m"] / n * np.column_stack([np.sin(q[1:]), np.cos(q[1:])])
    nodes = np.cumsum(np.vstack([[0.0, q[0]], steps]), axis=0)
    quarter = np.arange(4) * n // 4
    off = np.hypot(*(nodes[quarter] - smooth(row, quarter * row["L_m"] / n)).T).max() / row["L_m"]
    # The floater carries what the cable pulls it down with; the pull is that at the top joint, from R there.
    pulled = -RIGID * q[0]
    outputs = kernel.outputs(q, np.zeros_like(q), {})
    along = outputs["tension_top"]  # T cos(phi), phi half a link's turn: pulled = V, so H follows
    angle = q[1]
    horizontal = (along - abs(pulled) * np.cos(angle)) / np.sin(angle)
    return float(off), float(abs(np.hypot(horizontal, pulled) - row["T_top_N"]) / row["T_top_N"])


@pytest.mark.parametrize("row", SUSPENDED, ids=lambda row: f"{row['x_m']:g}-{row['z_m']:g}-{row['L_m']:g}")
def test_links_between_two_points_approach_the_catenary_with_their_length_squared(
    library: ctypes.CDLL, row: dict[str, float]
) -> None:
    """From links of an eighth of the sharpest radius on, twice and four times as many."""
    n = links_for(row)
    errors = np.array([catenary_errors(library, row, k * n) for k in (1, 2, 4)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all(orders > 1.9) and np.all(orders < 2.1), (errors, orders)


def beam(n: int, *, wall: float = 2.0) -> Cable:
    """10 m, EI = 628.3 N m^2, clamped to a top that does not heave either."""
    cable = cantilever(n, 10.0, 628.3, wall=wall)
    return replace(cable, parameters=cable.parameters | {"M_1": 1.0, "k_m1": RIGID})


@pytest.mark.parametrize("row", LOADS, ids=lambda row: f"{row['PL2_over_EI']:g}")
@pytest.mark.parametrize("name", ["hanging", "nearly inverted", "coil"])
def test_a_cantilever_bends_as_the_elastica_does(library: ctypes.CDLL, row: dict[str, float], name: str) -> None:
    """c/n^2 off, c from the linearised elastica; the tolerance is the next even term and the table's last digit, as in
    tests/validation/elastica.py. A coil comes to the same, as there is only one equilibrium below a = 10."""
    n, a = 40, row["PL2_over_EI"]
    status, q, _, _ = Kernel(library, beam(n)).equilibrium(start(name, n), {"F_cx": a * 628.3 / 100.0})
    assert status == 0
    found = np.array([np.sin(q[1:]).mean(), np.cos(q[1:]).mean(), q[-1]])
    table = np.array([row["w_over_L"], row["x_over_L"], row["theta_tip_rad"]])
    np.testing.assert_allclose(found, table + departures(a)[1] / n**2, rtol=0.0, atol=(1.0 + a) / n**4 + 1e-8)


@pytest.mark.parametrize("n", [2, 5, 40, 200])
def test_a_column_buckles_at_its_load(library: ctypes.CDLL, n: int) -> None:
    """Compressed exactly along itself, a clamped column stays straight below its critical load, and does not above.

    th_{i+1} - 2 th_i + th_{i-1} = -(P l^2/EI) th_i with th_0 = -th_1 at the wall (half a link's compliance) and
    th_{n+1} = th_n at the free end has th_i = sin((i - 1/2) pi / 2n) for P l^2/EI = 4 sin^2(pi / 4n), which is
    Euler's pi^2 EI / 4 L^2 for many links. Above it the tip turns by a with P/P_critical = 1 + a^2/8 + O(a^4) on the
    elastica (Timoshenko and Gere, Theory of Elastic Stability, 2.7); the eight is of many links.
    """
    cable, length = beam(n), 10.0 / n
    critical = 628.3 / length**2 * 4.0 * np.sin(np.pi / (4 * n)) ** 2
    kernel = Kernel(library, cable)
    status, q, _, _ = kernel.equilibrium(start("hanging", n), {"F_cy": -0.999 * critical})
    assert status == 0
    assert np.abs(q[1:]).max() < 1e-9
    status, q, _, _ = kernel.equilibrium(start("hanging", n), {"F_cy": -1.001 * critical})
    assert status == 0
    tip = abs(q[-1]) / np.sin((n - 0.5) * np.pi / (2 * n))  # to that of the shape where it has its largest angle
    assert tip == pytest.approx(np.sqrt(8 * 0.001), rel=0.002 if n >= 40 else 0.1)


def test_a_column_far_beyond_its_load_turns_over(library: ctypes.CDLL) -> None:
    """Tip angle 176 degrees at 9.116 times the critical load: Timoshenko and Gere, table 2-4."""
    n = 200
    critical = np.pi**2 * 628.3 / 400.0
    kernel = Kernel(library, beam(n))
    for degrees, ratio in ((20, 1.015), (60, 1.152), (100, 1.518), (140, 2.541), (160, 4.029), (176, 9.116)):
        status, q, _, _ = kernel.equilibrium(start("hanging", n), {"F_cy": -ratio * critical})
        assert status == 0
        # the ratio's last digit, and 1/n^2 of what bends
        room = {20: 0.4, 60: 0.15, 100: 0.1, 140: 0.1, 160: 0.1, 176: 0.1}[degrees]
        assert np.rad2deg(abs(q[-1])) == pytest.approx(degrees, abs=room)


@pytest.mark.parametrize(("share", "stands"), [(0.99, True), (1.01, False)])
def test_a_heavy_column_buckles_under_its_own_weight(library: ctypes.CDLL, share: float, stands: bool) -> None:
    """Greenhill (1881): q L^3/EI = 7.8373, 9/4 times the square of the first zero of Bessel's J_-1/3. Upside down, with
    weights pulling upwards on a beam that is clamped above; 60 links change it by some 1/60^2."""
    column = beam(60)
    critical = 7.8373 * 628.3 / 1000.0 * (10.0 / column.links.mass.sum())
    upwards = replace(column, parameters=column.parameters | {"g": -share * critical})
    status, q, _, _ = Kernel(library, upwards).equilibrium(start("hanging", 60), {})
    assert status == 0
    assert (np.abs(q[1:]).max() < 1e-9) == stands


@pytest.mark.parametrize("n", [1, 3, 40])
def test_limp_links_fall_from_standing_on_their_head(library: ctypes.CDLL, n: int) -> None:
    """Exactly upright, where forces balance."""
    heavy = replace(beam(n), parameters=beam(n).parameters | {"g": GRAVITY, "m_c": 5.0})
    limp = replace(heavy, links=replace(heavy.links, joint_stiffness=np.zeros(n)))
    status, q, _, _ = Kernel(library, limp).equilibrium(start("inverted", n), {})
    assert status == 0
    assert end_of(limp, q)[1] == pytest.approx(10.0, abs=1e-9)
