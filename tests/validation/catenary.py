"""Cables hung between two points: the shape and pulls that scenes start from, and the kernel's tensions."""

from __future__ import annotations

import ctypes
from itertools import pairwise

import numpy as np
from scipy.integrate import quad

from cablefmu.cable import Cable, Drag, Floats, Terminal
from cablefmu.shapes import END_TOLERANCE, catenary
from tests.kernel.library import Kernel
from tests.validation.cables import FIXED, GRAVITY, links_of
from tests.validation.checks import Check, Section, read_table

__all__ = ["hanging", "links_for", "sections", "shift", "stiffness"]

Row = dict[str, float]


def links_for(row: Row) -> int:
    """Links eight times shorter than the sharpest radius of the curve, H / w; at least 240."""
    return max(240, int(np.ceil(8.0 * row["L_m"] * row["w_N_per_m"] / row["H_N"] / 40.0)) * 40)


def stiffness(row: Row) -> Floats:
    """d(H, V)/d(end) of the smooth catenary, shape (2, 2) [N/m]: the inverse of dP/d(H, V), of which see `shift`."""
    pull, top, w, length = row["H_N"], row["V_top_N"], row["w_N_per_m"], row["L_m"]
    radius = pull / w
    marks = [0.0, *(top / w + k * radius for k in (-30, -3, 0, 3, 30)), length]
    inside = sorted({min(max(mark, 0.0), length) for mark in marks})

    def integral(power: int) -> float:
        """int (V - w s)^power / T^3 ds, in pieces about the lowest point, where a slack cable turns sharply."""
        return sum(
            float(quad(lambda s: (top - w * s) ** power / np.hypot(pull, top - w * s) ** 3, *piece, epsrel=1e-11)[0])
            for piece in pairwise(inside)
        )

    across, mixed, along = integral(2), -pull * integral(1), pull**2 * integral(0)
    return np.asarray(np.linalg.inv(np.array([[across, mixed], [mixed, along]])))


def shift(row: Row) -> Floats:
    """(H, V) of n links less those of the smooth catenary, times n^2, to leading order [N].

    A discrete link points along the pull at its middle, so that the end of n links is the midpoint rule for that of
    the smooth cable, P(H, V) = int_0^L t ds with t = (H, V - w s) / T. The midpoint rule is short by
    l^2/24 (t'(L) - t'(0)), and (H, V) must make up for it: dP/d(H, V) times the shift is that.
    """
    pull, top, w, length = row["H_N"], row["V_top_N"], row["w_N_per_m"], row["L_m"]

    def slope(s: float) -> Floats:
        """dt/ds [1/m]"""
        up = top - w * s
        return np.asarray(np.array([up, -pull]) * w * pull / np.hypot(pull, up) ** 3)

    return np.asarray(stiffness(row) @ (length**2 / 24.0 * (slope(length) - slope(0.0))))


def _slack(row: Row) -> float:
    """What the port missed by `END_TOLERANCE` may change the pull by [N]."""
    return float(np.linalg.norm(stiffness(row), 2)) * END_TOLERANCE


def hanging(row: Row, n: int) -> Cable:
    """n limp links in their rest shape between a fixed floater and an anchor mass that holds as well."""
    length, weight = row["L_m"], row["L_m"] * row["w_N_per_m"]
    found = catenary(np.full(n, length / n), np.full(n, weight / n), (row["x_m"], row["z_m"]))
    return Cable(
        name="catenary",
        links=links_of(n, length, weight / GRAVITY),
        terminal=Terminal.ANCHOR_MASS,
        drag=Drag.NONE,
        parameters={"g": GRAVITY, "M_1": FIXED, "k_m1": 0.0, "c_m1": 0.0, "static_load": 0.0, "m_c": FIXED},
        inputs=("u_m1",),
        position=np.concatenate([[0.0], found.angles]),
        velocity=np.zeros(n + 1),
    )


def sections(library: ctypes.CDLL) -> list[Section]:
    rows = read_table("catenary_inextensible")
    return [_pulls(rows), _tensions(library, rows[:6])]


SOURCE = (
    "`tests/data/catenary_inextensible.csv`: the inextensible catenary between two points, from "
    "sqrt(L² - z²) = 2a sinh(x/2a), a = H/w, in 40 digits."
)


def _name(row: Row) -> str:
    return f"x = {row['x_m']:g}, z = {row['z_m']:g}, L = {row['L_m']:g} m"


def _relative_rest(row: Row, n: int) -> float:
    """Size of the next term over the leading one: the square of link over sharpest radius."""
    return float((row["L_m"] * row["w_N_per_m"] / row["H_N"] / n) ** 2)


def _pulls(rows: list[Row]) -> Section:
    checks = []
    for k, row in enumerate(rows):
        n = links_for(row)
        length = np.full(n, row["L_m"] / n)
        found = catenary(length, length * row["w_N_per_m"], (row["x_m"], row["z_m"]))
        expected = shift(row) / n**2
        size = float(np.hypot(*expected)) * _relative_rest(row, n) + _slack(row)
        for name, ours, key, derived in (
            ("H", found.horizontal, "H_N", expected[0]),
            ("V", found.vertical, "V_top_N", expected[1]),
        ):
            checks.append(Check(
                f"{_name(row)}, {n} links: {name} at the top", "N", row[key], ours, size, float(derived),
                on_page=name == "H" or k < 2,
            ))  # fmt: skip
    return Section(
        "Hanging between two points: the rest shape",
        SOURCE,
        "Rigid links with their weight at the middle are the midpoint rule for the smooth curve, so H and V "
        "differ by c/n², c from the rule's error term. Links are at most an eighth of the sharpest radius "
        "a. The tolerance is (l/a)² of the derived difference, the size of the next term, and the smooth "
        "cable's end stiffness times the 1e-9 m within which the shape meets the port.",
        tuple(checks),
    )


def _tensions(library: ctypes.CDLL, rows: list[Row]) -> Section:
    checks = []
    for row in rows:
        n = links_for(row)
        cable = hanging(row, n)
        outputs = Kernel(library, cable).outputs(cable.position, cable.velocity, {})
        expected, half = shift(row) / n**2, row["L_m"] * row["w_N_per_m"] / n / 2.0
        for key, up, total in (
            ("tension_top", row["V_top_N"], row["T_top_N"]),
            ("tension_end", row["V_end_N"], row["T_end_N"]),
        ):
            # pull changed by the shift, and projected on a link that lies off it by half a link's turn
            derived = (row["H_N"] * expected[0] + up * expected[1]) / total - (half * row["H_N"]) ** 2 / (2 * total**3)
            size = (abs(derived) + float(np.hypot(*expected))) * 4.0 * half * row["H_N"] / total**2
            checks.append(Check(
                f"{_name(row)}, {n} links: `{key}`", "N", total, outputs[key],
                size + abs(derived) * _relative_rest(row, n) + _slack(row), float(derived),
            ))  # fmt: skip
    return Section(
        "Hanging between two points: the kernel's tensions",
        SOURCE,
        "Both ports of 1e15 kg; the kernel's tensions of the rest shape. Besides the shift of (H, V) above, "
        "the print's tension is that along the link, off the pull by the half-link turn phi = (w l/2) H/T²: "
        "less by T phi²/2. The tolerance is the next term, 4 phi (the four is our choice) of the derived "
        "parts, with those of the section above.",
        tuple(checks),
    )
