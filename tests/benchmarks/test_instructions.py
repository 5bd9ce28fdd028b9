"""What a right-hand side costs in instructions: counted by callgrind, the same on every run, and not to grow unseen."""

from __future__ import annotations

import json
import platform
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

from tests.kernel.library import ROOT, toolchain

pytestmark = [
    pytest.mark.system,  # valgrind
    pytest.mark.skipif(platform.machine() != "x86_64", reason="the counts are those of x86-64 instructions"),
]

COUNTS = Path(__file__).parents[1] / "data" / "instructions.json"
"""Instructions per link; `python -m tests.benchmarks.test_instructions` measures and writes them anew."""
MARGIN = 1.03
"""The counts repeat exactly on one machine; another one's string functions in set-up differ, not these."""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_program(tmp_path_factory.mktemp("count"))


def compile_program(folder: Path, sources_in: Path = ROOT) -> Path:
    """count.c with the kernel of that folder, which may be a copy with a feature less."""
    recipe = toolchain(sources_in)
    path = folder / "count"
    flags = [flag for flag in recipe.RELEASE if flag not in ("-shared", "-s")]
    # what fed a feature that was taken out has nothing to do any more
    flags += [] if sources_in == ROOT else ["-Wno-unused"]
    sources = [sources_in / "tests" / "benchmarks" / "count.c", *recipe.kernel_sources()]
    recipe.compile_library(path, sources, flags, target=recipe.TARGETS["x86_64-linux"][0])
    return path


def instructions(program: Path, *arguments: object) -> int:
    """Of a whole run."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, *arguments]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    assert found, done.stderr
    return int(found[1])


@cache
def per_evaluation(program: Path, links: int, features: str, *what: str) -> float:
    """Instructions of one evaluation: the difference between 30 and 10 evaluations."""
    few, many = (instructions(program, links, times, features, *what) for times in (10, 30))
    return (many - few) / 20


def per_link(program: Path, links: int, features: str) -> float:
    """The same for one link of many."""
    return per_evaluation(program, links, features) / links


@pytest.mark.parametrize("case", json.loads(COUNTS.read_text(encoding="utf-8")))
def test_a_right_hand_side_costs_no_more_than_it_did(program: Path, case: dict[str, float | str]) -> None:
    found = per_link(program, int(case["links"]), str(case["features"]))
    assert found < MARGIN * float(case["per_link"])


def test_what_a_cable_does_not_have_costs_nothing(program: Path) -> None:
    """Air is cheaper than water, no springs cheaper than springs, no dampers cheaper than dampers."""
    whole, dry, slack, undamped = (per_link(program, 120, features) for features in ("wkc", "kc", "wc", "wk"))
    assert dry < whole and slack < whole and undamped < whole


@pytest.mark.parametrize("features", ["wkc", "wkcs", "kc", "wkcp", "wkcf"])
@pytest.mark.parametrize("links", [12, 120, 1000])
def test_an_adjoint_costs_at_most_five_right_hand_sides(program: Path, links: int, features: str) -> None:
    """Of all derivatives and all outputs, the linearisation included, beside the right-hand side that a host has at
    this state anyway: 2.5 to 4.6. Of derivatives alone that right-hand side is within the five: 3.0 to 4.8. One more
    at the same state costs at most two, and so does a directional derivative: 0.8 to 1.7."""
    one = per_evaluation(program, links, features)
    assert per_evaluation(program, links, features, "adjoint") <= 6.0 * one
    assert per_evaluation(program, links, features, "adjoint of states") <= 5.0 * one
    for another in ("another adjoint of states", "another directional of states"):
        assert per_evaluation(program, links, features, another) <= 2.0 * one


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        made = compile_program(Path(folder))
        cases = [(n, f) for n in (12, 120, 1000) for f in ("wkc", "")]
        rows = [{"links": n, "features": f, "per_link": round(per_link(made, n, f), 1)} for n, f in cases]
    COUNTS.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    print(COUNTS.read_text(encoding="utf-8"))
