"""Every number of docs/validation.md, and every row of the tables that it leaves out."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest

from cablefmu.shapes import catenary as rest_shape
from tests.kernel.library import Kernel
from tests.validation import catenary, elastica
from tests.validation.cables import FIXED
from tests.validation.checks import Check, Section, read_table
from tests.validation.frequencies import Chain

COUNTS = {
    "Hanging chain of rods": 61,
    "Hanging chain of point masses": 61,
    "Many rods: the flexible chain": 25,
    "Flexible chain with a load": 35,
    "The same, by the clock": 1,
    "Pendulum": 3,
    "Elastica, half a link's compliance at the wall": 30,
    "Elastica, a whole link's compliance at the wall": 30,
    "Cantilever that hardly bends": 10,
    "Hanging between two points: the rest shape": 20,
    "Hanging between two points: the kernel's tensions": 12,
    "A level cable sinks": 11,
    "A cable driven down at the critical angle": 15,
}
"""Section -> values: a table that was read in part would pass without a word."""


@pytest.mark.parametrize("title", COUNTS)
def test_every_value_is_the_published_one_but_for_the_derived_difference(
    sections: dict[str, Section], title: str
) -> None:
    checks = sections[title].checks
    assert [check for check in checks if not check.passes] == []
    assert len(checks) == COUNTS[title]


def test_no_section_goes_untested(sections: dict[str, Section]) -> None:
    assert list(sections) == list(COUNTS)


@pytest.mark.parametrize("ours", [1.0 + 3e-3, 1.0 - 1e-3, math.nan, math.inf])
def test_a_value_beyond_its_tolerance_fails(ours: float) -> None:
    assert not Check("", "", 1.0, ours, 1e-3, derived=1e-3).passes


def test_rods_are_always_faster_than_the_flexible_chain(library: ctypes.CDLL) -> None:
    """Rayleigh: a chain that can take fewer shapes is stiffer, in every mode, and the finer the less so."""
    exact = [row["continuous_bessel"] for row in read_table("hanging_chain_frequencies") if row["N"] == 10]
    coarse, fine, finest = (Chain(library).lambdas(n)[:10] for n in (10, 20, 40))
    assert np.all(coarse > fine)
    assert np.all(fine > finest)
    assert np.all(finest > exact)


@pytest.mark.parametrize(
    "row", read_table("catenary_inextensible")[:6], ids=lambda row: f"{row['x_m']:g}-{row['z_m']:g}"
)
def test_rest_shape_approaches_the_catenary_as_n_to_the_minus_two(row: dict[str, float]) -> None:
    """By the published pull alone. Links are a/8 at most, and the next term is (l/a)^2: 0.03 of the order."""

    def error(n: int) -> float:
        length = np.full(n, row["L_m"] / n)
        return abs(rest_shape(length, length * row["w_N_per_m"], (row["x_m"], row["z_m"])).horizontal - row["H_N"])

    assert math.log2(error(240) / error(480)) == pytest.approx(2.0, abs=0.03)


def test_rest_shape_is_at_rest_in_the_kernel(library: ctypes.CDLL) -> None:
    """No link of a hung cable turns: tolerance 1e-9 of g / l, by which a link would start that is let go."""
    for row in read_table("catenary_inextensible")[:6]:
        cable = catenary.hanging(row, 240)
        turning = Kernel(library, cable).acceleration(cable.position, cable.velocity, {})
        assert np.abs(turning).max() < 1e-9 * 9.81 / cable.links.length[0]
        assert abs(turning[0]) <= row["T_top_N"] / FIXED


@pytest.mark.parametrize(("wall", "order"), [(2.0, 2), (1.0, 1)])
def test_order_of_the_elastica_by_the_published_tips_alone(library: ctypes.CDLL, wall: float, order: int) -> None:
    """a = 1: halving the links' length; the next term changes the order by c/n with c about 1."""
    published = read_table("elastica_cantilever_tip_load")[3]["w_over_L"]
    coarse, fine = (elastica.tips(library, n, np.array([1.0]), wall=wall)[0, 0] - published for n in (20, 40))
    assert math.log2(coarse / fine) == pytest.approx(order, abs=1.0 / 20)
