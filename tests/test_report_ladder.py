"""The ladder of tolerances and the communication steps, on small scenes: orders, prices, and what is concluded."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from cablefmu.report_ladder import (
    PEERS,
    TOLERANCES,
    Row,
    communication_steps,
    held,
    held_step,
    ladder,
    longest_held,
    order,
    recommended,
)
from cablefmu.report_reference import Trusted, trusted
from cablefmu.report_runs import SOLVERS, Apart, FmuRuns, fmu_runs
from cablefmu.signals import Sine
from tests.fmu_helpers import small_scene


def quiet(_: str) -> None:
    """Says nothing."""


@pytest.fixture(scope="module")
def runs() -> Iterator[FmuRuns]:
    with fmu_runs(small_scene("load")) as made:
        yield made


@pytest.fixture(scope="module")
def reference(runs: FmuRuns) -> Trusted:
    return trusted(runs, 1e-4, 60.0)


@pytest.fixture(scope="module")
def rows(runs: FmuRuns, reference: Trusted) -> list[Row]:
    return ladder(runs, reference, 60.0, say=quiet)


def errors_of(rows: list[Row], solver: str) -> list[float]:
    return [row.error.position for row in rows if row.solver == solver and row.error is not None]


@pytest.mark.parametrize("solver", [*SOLVERS, *PEERS])
def test_every_solver_comes_closer_as_its_tolerance_falls(solver: str, rows: list[Row]) -> None:
    """From 1e-5 to 1e-9 an error falls at least a hundredfold, and ends far below the asked 1e-4 m."""
    errors = errors_of(rows, solver)
    assert len(errors) == len(TOLERANCES)
    assert errors[-1] < 1e-2 * errors[3]
    assert errors[-1] < 1e-6


@pytest.mark.parametrize("solver", [*SOLVERS, *PEERS])
def test_a_tighter_tolerance_takes_more_right_hand_sides(solver: str, rows: list[Row]) -> None:
    counts = [row.rhs for row in rows if row.solver == solver]
    assert counts[0] < counts[-1]
    assert all(row.cpu_time > 0.0 for row in rows)


def test_automatic_is_explicit_where_nothing_is_stiff(rows: list[Row]) -> None:
    np.testing.assert_allclose(errors_of(rows, "automatic"), errors_of(rows, "explicit"), rtol=0.05)


def test_what_takes_too_long_is_said_and_tighter_ones_are_not_tried(runs: FmuRuns, reference: Trusted) -> None:
    said: list[str] = []
    found = ladder(runs, reference, 1e-9, solvers=("explicit", "LSODA"), say=said.append)
    assert [row.note for row in found] == ["too slow: more than 1e-09 s of CPU time"] * 16
    assert all(row.error is None for row in found)
    assert said == ["explicit at 0.01", "LSODA at 0.01"]


# --- communication step ---


def test_held_inputs_cost_an_error_of_first_order(runs: FmuRuns, reference: Trusted) -> None:
    found = communication_steps(runs, reference, 60.0, say=quiet)
    late = [row for row in found if row.inputs == "held" and row.error is not None and row.step <= 0.02]
    assert order([row.step for row in late], [row.error.position for row in late if row.error]) == pytest.approx(
        1.0, abs=0.03
    )
    exact = [row.error.position for row in found if row.inputs == "exact" and row.error is not None]
    assert max(exact) < 1e-7, "given exactly, inputs do not care for the communication step"
    assert [row.step for row in found[:10]] == [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001]


def test_inputs_are_held_at_what_they_are_when_the_step_begins() -> None:
    scene = small_scene("load")
    force, sine = held(scene, 0.25)["u_m1"], Sine(800.0, 0.5)
    assert [force(t) for t in (0.3, 0.49, 0.5, 1.9)] == [sine(t) for t in (0.25, 0.25, 0.5, 1.75)]


def test_without_forces_that_vary_there_is_nothing_to_hold() -> None:
    from cablefmu.scene import Scene

    still = Scene.from_text(small_scene("load").text.replace("[inputs]\nu_m1", "[inputs]\nF_cx = 5\n#"), name="still")
    with fmu_runs(still) as runs:
        found = communication_steps(runs, trusted(runs, 1e-4, 60.0), 60.0, say=quiet)
    assert {row.inputs for row in found} == {"exact"}


# --- conclusions ---


def row(solver: str, position: float | None, cpu_time: float, *, step: float = 0.1, inputs: str = "exact") -> Row:
    error = None if position is None else Apart(position, 0.0, 0.0, 0.0)
    return Row(solver, 1e-6, step, inputs, error, cpu_time, 100, 10, 0.0)


def test_the_cheapest_that_is_good_enough_is_recommended() -> None:
    good = row("implicit", 5e-5, 1.0)
    rows = [row("explicit", 2e-4, 0.1), good, row("automatic", 1e-9, 2.0), row("automatic", None, 0.0)]
    assert recommended(rows, 1e-4) is good


def test_of_equals_the_most_accurate_is_recommended() -> None:
    best = row("explicit", 1e-8, 1.05)
    assert recommended([row("automatic", 9e-5, 1.0), best, row("implicit", 1e-9, 1.2)], 1e-4) is best


def test_others_solvers_and_held_inputs_are_not_recommended() -> None:
    assert recommended([row("CVode", 1e-9, 0.1), row("automatic", 1e-9, 0.1, inputs="held")], 1e-4) is None


def test_the_longest_step_that_a_host_may_hold() -> None:
    rows = [row("automatic", 1e-2 * step, 1.0, step=step, inputs="held") for step in (0.1, 0.01, 0.001)]
    found = longest_held(rows, 1.1e-4)
    assert found is not None and found.step == 0.01
    assert held_step(rows, 1.1e-4) is None, "it was tried"


def test_a_step_shorter_than_any_that_was_tried_follows_from_the_order() -> None:
    rows = [row("automatic", 0.5 * step, 1.0, step=step, inputs="held") for step in (0.1, 0.01, 0.001)]
    assert longest_held(rows, 1e-4) is None
    assert held_step(rows, 1e-4) == pytest.approx(2e-4)


def test_orders_are_exponents() -> None:
    x = [0.1, 0.2, 0.4, 0.8]
    assert order(x, [3.0 * step**2 for step in x]) == pytest.approx(2.0)
    assert order(x[:2], [1.0, 2.0]) is None
