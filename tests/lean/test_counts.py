"""What a scene does not have it does not pay for: by the committed counts, and counted anew."""

from __future__ import annotations

import json
import platform
from pathlib import Path
from typing import Any

import pytest

from tests.benchmarks.test_instructions import MARGIN, compile_program
from tests.lean.counts import (
    COUNTS,
    FREE,
    LINKS,
    PAGE,
    RIGHT_SIDES,
    STATICS,
    STEPPED,
    added_code,
    compile_steps,
    growth,
    per_step,
    right_side,
    shortened_program,
    tables,
    until_first_step,
)  # fmt: skip
from tests.lean.features import scene_pair
from tests.lean.without import WITHOUT

COMMITTED: dict[str, list[dict[str, Any]]] = json.loads(COUNTS.read_text(encoding="utf-8"))
MOST_GROWTH = 1.0
"""[%] that a scene may pay for the code of a feature that it does not have."""

counted = pytest.mark.skipif(platform.machine() != "x86_64", reason="the counts are those of x86-64 instructions")


def committed(part: str, **key: object) -> dict[str, Any]:
    (row,) = (row for row in COMMITTED[part] if key.items() <= row.items())
    return row


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_program(tmp_path_factory.mktemp("count"))


@pytest.fixture(scope="module")
def steps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_steps(tmp_path_factory.mktemp("steps"))


def test_the_page_shows_the_committed_counts() -> None:
    assert f"<!-- counts -->\n{tables(COMMITTED)}\n<!-- end -->" in PAGE.read_text(encoding="utf-8")


def test_every_feature_is_counted() -> None:
    assert {row["feature"] for row in COMMITTED["right-hand side"]} == set(RIGHT_SIDES)
    assert {row["code"] for row in COMMITTED["code"]} >= set(WITHOUT)
    assert {row["feature"] for row in COMMITTED["communication step"]} == set(STEPPED)


@pytest.mark.system
@counted
@pytest.mark.parametrize("links", LINKS)
@pytest.mark.parametrize("feature", RIGHT_SIDES)
def test_a_right_hand_side_without_the_feature_is_cheaper(program: Path, feature: str, links: int) -> None:
    """A pin is the exception on a short cable: eliminated from the top alone, it has no middle to meet at."""
    having, lacking = right_side(program, feature, links)
    before = committed("right-hand side", feature=feature, links=links)
    assert having < MARGIN * before["with"] and lacking < MARGIN * before["without"]
    if feature in FREE:
        assert having == lacking
    elif (feature, links) != ("pin", 12):
        assert having > lacking


@pytest.mark.system
@counted
@pytest.mark.parametrize("feature", WITHOUT)
def test_code_of_a_feature_costs_other_scenes_nothing(tmp_path: Path, program: Path, feature: str) -> None:
    """Less than 1 %, against a copy of the kernel from which that code was deleted."""
    shortened = shortened_program(tmp_path, feature)
    for links in LINKS:
        for there, deleted in added_code(program, shortened, feature, links).values():
            assert growth({"there": there, "deleted": deleted}) < MOST_GROWTH, links


@pytest.mark.system
@counted
@pytest.mark.parametrize("feature", STEPPED)
def test_a_communication_step_pays_for_no_output_but_the_energy_balance(
    steps: Path, tmp_path: Path, feature: str
) -> None:
    having, lacking = (per_step(steps, scene, tmp_path) for scene in scene_pair(feature))
    if "solver" in feature:
        assert having > lacking
    else:
        assert having == lacking


@pytest.mark.system
@counted
def test_an_equilibrium_is_paid_for_by_those_who_ask_for_it(steps: Path, tmp_path: Path) -> None:
    having, lacking = (until_first_step(steps, scene, tmp_path) for scene in scene_pair(STATICS))
    assert having > 1.1 * lacking
