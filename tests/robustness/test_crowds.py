"""Instances share nothing: in turn, or in threads, each gives the bits that it gives alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.robustness.building import compile_with_zig, copy_of_sources, run

SHARED_ARRAYS = {"fmi/instance.c": ("double *next = instance->block;",
                                    "static double shared[100000]; double *next = shared;")}  # fmt: skip
"""A defect for the tests to find: all instances compute in the same arrays."""

crowds = pytest.mark.parametrize(("task", "number"), [("interleaved", 100), ("threads", 8)])


@crowds
def test_a_crowd_computes_as_each_alone(task: str, number: int, shipped_host: Path, words: list[str]) -> None:
    """Scenes of every kind, both versions of FMI, Co-Simulation and Model Exchange, all at once."""
    result = run(shipped_host, task, words, number=number)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.fixture(scope="module")
def sharing_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sharing")
    return compile_with_zig(folder / "host", sources=copy_of_sources(folder, SHARED_ARRAYS))


@crowds
def test_shared_arrays_would_be_found(task: str, number: int, sharing_host: Path, words: list[str]) -> None:
    """Threads may crash on a half-written state before they can compare."""
    result = run(sharing_host, task, words, number=number)
    assert result.returncode != 0
    assert task == "threads" or "not the bits of an instance alone" in result.stderr
