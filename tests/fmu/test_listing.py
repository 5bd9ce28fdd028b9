"""Rows of the table of variables: links in one row, values for people."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cablefmu.fmu.listing import Row, number, rows_of
from cablefmu.fmu.variables import variables_of
from tests.fmu_helpers import small_scene


def rows(kind: str = "load") -> dict[str, Row]:
    return {row.first: row for row in rows_of(variables_of(small_scene(kind).cable))}


def test_links_share_a_row() -> None:
    found = rows()
    theta = Row("theta[1]", "theta[5]", "rad", "0.5", "Link i: angle from the downward vertical, positive towards +x")
    assert found["theta[1]"] == theta
    assert found["der(omega[1])"] == Row(
        "der(omega[1])", "der(omega[5])", "rad/s2", "", "Time derivative of omega[i]"
    )  # fmt: skip
    assert not any(row.first.endswith("[2]") for row in found.values())


def test_angles_that_differ_are_a_range() -> None:
    cable = small_scene("pin").cable
    assert rows("pin")["theta[1]"].start == f"{number(min(cable.position[1:]))} … {number(max(cable.position[1:]))}"


def test_one_variable_keeps_its_description() -> None:
    found = rows()
    assert found["u_m1"] == Row("u_m1", "u_m1", "N", "0", "Vertical force on floater 1, positive down")
    assert found["solver"].start == "automatic"
    assert found["solver.steps"].description == "Accepted steps of the built-in solver since the start"
    assert found["x_c"].start == ""


def test_a_cable_of_one_link_is_no_range() -> None:
    single = [v for v in variables_of(small_scene("load").cable) if "[" not in v.name or "[1]" in v.name]
    (row,) = [row for row in rows_of(single) if row.first == "theta[1]"]
    assert row.last == "theta[1]"
    assert row.description.startswith("Link 1: ")


def test_neighbours_that_differ_in_more_are_kept_apart() -> None:
    a, b, *_ = [v for v in variables_of(small_scene("load").cable) if v.name.startswith("theta[")]
    assert len(rows_of([a, replace(b, name="omega[2]")])) == 2


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (-2.5, "−2.5"), (8e8, "8e8"), (1e-12, "1e−12"), (-1.5e-7, "−1.5e−7"),
     (26.179938779914945, "26.179939"), (120000.0, "120000")],
)  # fmt: skip
def test_numbers(value: float, text: str) -> None:
    assert number(value) == text
