"""A cantilever that bends far under a dead load at its tip, and what cutting it into links changes."""

from __future__ import annotations

import ctypes

import numpy as np
from scipy.integrate import solve_bvp

from cablefmu.cable import Floats
from tests.kernel.library import Kernel
from tests.validation.cables import cantilever
from tests.validation.checks import Check, Section, read_table
from tests.validation.motion import rest

__all__ = ["departures", "sections", "tips"]

LENGTH, BENDING_STIFFNESS = 10.0, 628.3
"""[m], EI [N m^2]: a steel wire rope's worth. Results are pure numbers and do not depend on them."""
LINKS = 40
QUANTITIES = ("w_over_L", "x_over_L", "theta_tip_rad")
NAMES = ("w/L", "x/L", "tip slope [rad]")
PRINTED = 1e-8
"""The last digit of the table"""


def tips(library: ctypes.CDLL, n: int, loads: Floats, *, wall: float) -> Floats:
    """(w/L, x/L, slope of the last link) for ascending a = P L^2 / EI, shape (loads, 3)."""
    cable = cantilever(n, LENGTH, BENDING_STIFFNESS, wall=wall)
    kernel, q, found = Kernel(library, cable), cable.position, []
    for load in loads:
        q = rest(kernel, q, {"F_cx": load * BENDING_STIFFNESS / LENGTH**2})
        found.append([np.sin(q[1:]).mean(), np.cos(q[1:]).mean(), q[-1]])
    return np.array(found)


def departures(load: float) -> tuple[Floats, Floats]:
    """(first, second): tips of n links less those of the elastica are first/n + O(n^-2) if the wall's joint has a whole
    link's compliance, second/n^2 + O(n^-3) if half a link's; each for (w/L, x/L, slope).

    Notes
    -----
    With L = 1 and a = P L^2/EI the elastica is th'' = -a cos th, th(0) = 0, th'(1) = 0. Moments about the links give
    (th_{i+1} - 2 th_i + th_{i-1}) n^2 = -a cos th_i exactly, so links are central differences at their middles. Put
    th_i = th + u / n^2 into that and expand:

        u'' - a u sin th = -th''''/12,   u(0) = -th''(0)/8 = a/8,   u'(1) = -th'''(1)/24 = 0

    where u(0) comes from the wall's half cell, th_1 = (M_1/EI) / (2n) with M_1 exact. Sums over links are midpoint
    rules, wrong by (f'(0) - f'(1)) / (24 n^2), and the last link's middle is off by
    th''(1) / (8 n^2) = -a cos th(1) / (8 n^2).
    A whole link's compliance turns the root by another th'(0) / (2n): u'' = a u sin th, u(0) = th'(0)/2, u'(1) = 0.
    """

    def slopes(s: Floats, y: Floats) -> Floats:
        th, k, u, du, _, _, u1, du1, _, _ = y
        fourth = -load * (-np.cos(th) * k**2 - np.sin(th) * -load * np.cos(th))
        return np.array([
            k, -load * np.cos(th),
            du, load * u * np.sin(th) - fourth / 12.0, u * np.cos(th), -u * np.sin(th),
            du1, load * u1 * np.sin(th), u1 * np.cos(th), -u1 * np.sin(th),
        ])  # fmt: skip

    def ends(left: Floats, right: Floats) -> Floats:
        return np.array([
            left[0], right[1],
            left[2] - load / 8.0, right[3], left[4], left[5],
            left[6] - left[1] / 2.0, right[7], left[8], left[9],
        ])  # fmt: skip

    mesh = np.linspace(0.0, 1.0, 41)
    guess = np.zeros((10, len(mesh)))
    guess[0] = min(load / 2.0, 1.4) * mesh * (2.0 - mesh)
    found = solve_bvp(slopes, ends, mesh, guess, tol=1e-8, max_nodes=20_000)
    assert found.success, found.message
    root, tip = found.y[:, 0], found.y[:, -1]
    second = np.array([tip[4] + root[1] / 24.0, tip[5], tip[2] - load * np.cos(tip[0]) / 8.0])
    return np.array([tip[8], tip[9], tip[6]]), second


def sections(library: ctypes.CDLL) -> list[Section]:
    rows = read_table("elastica_cantilever_tip_load")
    loads = np.array([row["PL2_over_EI"] for row in rows])
    expected = [departures(load) for load in loads]
    return [_half(library, rows, loads, expected), _whole(library, rows, loads, expected), _straight(library)]


SOURCE = (
    "`tests/data/elastica_cantilever_tip_load.csv`: inextensible elastica, clamped, dead load P across its "
    "tip, by shooting; the problem of Bisshopp and Drucker, Quart. Appl. Math. 3 (1945) 272. a = P L²/EI."
)


def _half(
    library: ctypes.CDLL, rows: list[dict[str, float]], loads: Floats, expected: list[tuple[Floats, Floats]]
) -> Section:
    found = tips(library, LINKS, loads, wall=2.0)
    checks = [
        Check(
            f"a = {row['PL2_over_EI']:g}, {name}", "", row[key], found[k, j],
            (1.0 + row["PL2_over_EI"]) / LINKS**4 + PRINTED, expected[k][1][j] / LINKS**2,
            on_page=row["PL2_over_EI"] in (1, 3, 10),
        )
        for k, row in enumerate(rows)
        for j, (key, name) in enumerate(zip(QUANTITIES, NAMES, strict=True))
    ]  # fmt: skip
    return Section(
        "Elastica, half a link's compliance at the wall",
        SOURCE,
        f"{LINKS} links, joints EI/l, the wall's joint 2EI/l, as it stands for half a link. Links then are "
        "central differences of the elastica, and the difference is c/n² with c from the linearised "
        "elastica (no fit). The tolerance is (1 + a)/n⁴, the size of the next even term, and the table's "
        "last digit.",
        tuple(checks),
    )


def _whole(
    library: ctypes.CDLL, rows: list[dict[str, float]], loads: Floats, expected: list[tuple[Floats, Floats]]
) -> Section:
    found = tips(library, LINKS, loads, wall=1.0)
    checks = [
        Check(
            f"a = {row['PL2_over_EI']:g}, {name}", "", row[key], found[k, j],
            row["PL2_over_EI"] / (2.0 * LINKS**2) + PRINTED, expected[k][0][j] / LINKS,
            on_page=row["PL2_over_EI"] in (1, 10) and j == 0,
        )
        for k, row in enumerate(rows)
        for j, (key, name) in enumerate(zip(QUANTITIES, NAMES, strict=True))
    ]  # fmt: skip
    return Section(
        "Elastica, a whole link's compliance at the wall",
        SOURCE,
        "The dissertation gives every joint the same stiffness, the first too. The root then turns by l "
        "M/(2EI) too far, and the difference is c/n, again from the linearised elastica. The tolerance is "
        "a/(2n²): half the square of that turn, at most a/(4n²) as M_1 <= sqrt(2a) EI/L, and the term of "
        "half a link, about a/(6n²).",
        tuple(checks),
    )


def _straight(library: ctypes.CDLL) -> Section:
    small, checks = 1e-4, []
    for n in (1, 2, 5, 20, 60):
        for wall, derived, name in (
            (2.0, 0.5 / n**2, "half a link"),
            (1.0, 1.5 / n + 0.5 / n**2, "a whole link"),
        ):
            found = tips(library, n, np.array([small]), wall=wall)[0, 0]
            checks.append(
                Check(
                    f"n = {n}, {name} at the wall, 3 EI w / (P L³)",
                    "",
                    1.0,
                    3.0 * found / small,
                    1e-6,
                    derived,
                )
            )
    return Section(
        "Cantilever that hardly bends",
        "w = P L³/(3 EI), any textbook.",
        "The moments are known, and the tip moves by sum P (j l)²/k over the joints: exactly 1 + 1/(2n²) "
        "times the beam's with half a link's compliance at the wall, 1 + 3/(2n) + 1/(2n²) with a whole "
        "one's. The tolerance is for a = 1e-4 being finite and for the Newton step at which the shape is "
        "taken to rest, 1e-10 rad of 1e-4.",
        tuple(checks),
    )
