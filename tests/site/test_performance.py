"""The page of costs is made of what was measured: of this tree's file if there is one, else of the one that is kept."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from docs.site.performance import performance_page

ROOT = Path(__file__).parents[2]


def test_figures_are_those_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    shutil.copyfile(ROOT / "docs" / "benchmarks.json", tmp_path / "docs" / "benchmarks.json")
    results = json.loads((tmp_path / "docs" / "benchmarks.json").read_text("utf-8"))
    page = performance_page(tmp_path)
    assert results["machine"] in page
    for row in results["table_6_6"]:
        assert f"| {row['links']} | {row['tolerance']:g} | {1e3 * row['seconds']:.1f} |" in page
    own = results["peers"]["cablefmu"]["seconds"]
    for name, peer in results["peers"].items():
        assert f"| {name} | {peer['version']} | {1e6 * peer['seconds']:.1f} | {peer['seconds'] / own:.1f} |" in page
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "benchmarks.json").write_text(json.dumps({**results, "machine": "another machine"}))
    assert "another machine" in performance_page(tmp_path)


def test_without_peers_their_tables_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    results = json.loads((ROOT / "docs" / "benchmarks.json").read_text("utf-8"))
    del results["peers"], results["moordyn"]
    (tmp_path / "docs" / "benchmarks.json").write_text(json.dumps(results))
    page = performance_page(tmp_path)
    assert "DART" not in page and "MoorDyn" not in page and "Table 6.6" in page
