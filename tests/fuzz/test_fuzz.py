"""A minute of fuzzing from saved files, what they cover, and that what is planted is found.

`python -m tests.fuzz` takes longer.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.building import COVERAGE, FUZZERS, SAVED, compile_fuzzers, starts, write_scenes
from tests.fuzz.running import lines_covered, run
from tests.kernel.library import toolchain
from tests.robustness.building import copy_of_sources

pytestmark = pytest.mark.system

SECONDS = {"calls": 40, "resource": 20}
LEAST_EXECUTIONS = 2000
"""In that time on a slow machine; 100,000 on a fast one."""

PLANTED = {
    "derivatives of order 0": ("calls", {
        "fmi/access.c": ("if (order < 1 || order > INPUT_ORDERS)", "if (order > INPUT_ORDERS)"),
    }),
    "inputs that survive a reset": ("calls", {
        "fmi/instance.c": ("    memcpy(instance->u, resource->input_start, sizeof instance->u);\n", ""),
    }),
    "a table of variables longer than its file": ("resource", {
        "fmi/resource.c": ("8 * doubles + 8 * (size_t)resource->variables) return",
                           "8 * doubles + 8 * (size_t)(resource->variables & 0xff)) return"),
    }),
}  # fmt: skip
"""Title -> (who finds it, file -> (old, new))."""


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_scenes(tmp_path_factory.mktemp("scenes"))


@pytest.fixture(scope="module")
def start(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Path]]:
    return starts(scenes, tmp_path_factory.mktemp("seeds"))


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sanitized")
    compile_fuzzers(folder)
    return folder


@pytest.mark.parametrize("name", FUZZERS)
def test_a_while(name: str, sanitized: Path, scenes: Path, start: dict[str, list[Path]], tmp_path: Path) -> None:
    outcome = run(sanitized / name, scenes, tmp_path / "found", start[name], seconds=SECONDS[name])
    assert outcome.crashes == [], outcome.text
    assert outcome.executions > LEAST_EXECUTIONS


def test_what_the_saved_files_cover(scenes: Path, start: dict[str, list[Path]], tmp_path: Path) -> None:
    """Nine lines of ten in every file of the adapters."""
    compile_fuzzers(tmp_path, COVERAGE)
    files = sorted((toolchain().HERE / "fmi").glob("*.c"))
    share = lines_covered({tmp_path / name: start[name] for name in FUZZERS}, scenes, files)
    assert set(share) == {path.name for path in files}
    assert {name: part for name, part in share.items() if part < 90.0} == {}


@pytest.mark.parametrize("title", PLANTED)
def test_what_is_planted_is_found(title: str, scenes: Path, start: dict[str, list[Path]], tmp_path: Path) -> None:
    name, changes = PLANTED[title]
    copy_of_sources(tmp_path / "sources", changes)
    (tmp_path / "program").mkdir()
    compile_fuzzers(tmp_path / "program", sources=tmp_path / "sources")
    outcome = run(tmp_path / "program" / name, scenes, tmp_path / "found", start[name], seconds=SECONDS[name])
    assert len(outcome.crashes) == 1, outcome.text


def test_the_saved_files_are_small() -> None:
    assert sum(path.stat().st_size for path in SAVED.iterdir()) < 300_000
