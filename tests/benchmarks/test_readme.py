"""The README's figures are those of docs/benchmarks.json, which the last measurement left."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.benchmarks.readme import renewed

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text("utf-8")
RESULTS = json.loads((ROOT / "docs" / "benchmarks.json").read_text("utf-8"))


def test_the_readme_is_up_to_date() -> None:
    assert renewed(README, RESULTS) == README, "README.md is stale: python -m tests.benchmarks.readme"


def test_figures_follow_the_file() -> None:
    other = json.loads(json.dumps(RESULTS))
    other["peers"]["DART"] |= {"seconds": 3.0 * other["peers"]["cablefmu"]["seconds"], "version": "9.9"}
    other["table_6_6"][0]["matlab_seconds"] = other["table_6_6"][1]["matlab_seconds"] = 12345
    new = set(renewed(README, other).splitlines()) - set(README.splitlines())
    assert len(new) == 2
    assert any("DART" in line and "| 9.9 |" in line and "| 3.0 |" in line for line in new)
    assert any("MATLAB" in line and "| 12345 |" in line for line in new)


def test_a_readme_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="no figures between"):
        renewed("# x\n", RESULTS)
