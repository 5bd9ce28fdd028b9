"""The page of what it costs, made of what `python -m tests.benchmarks` measured."""

from __future__ import annotations

import json
from pathlib import Path

from tests.benchmarks.tables import tables

__all__ = ["performance_page"]


def performance_page(root: Path) -> str:
    """The page in Markdown: of build/benchmarks.json if this tree was measured, else of the figures that are kept."""
    own, kept = root / "build" / "benchmarks.json", root / "docs" / "benchmarks.json"
    results = json.loads((own if own.exists() else kept).read_text("utf-8"))
    versions = ", ".join(f"{name} {version}" for name, version in results["versions"].items())
    return f"""# What it costs

Measured by `python -m tests.benchmarks PYTHON` on {results["machine"]} with {versions}.
This page is made of the file that it writes. Errors are of the terminal or the whole chain against references at
tighter tolerance; other integrators and libraries solve the same equations, and are checked to give the same
accelerations before they are timed. Measure scenes of yours by `cablefmu report SCENE` ([how](report.md)).

{tables(results)}
"""
