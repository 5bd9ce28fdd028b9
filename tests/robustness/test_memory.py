"""Memory: all of it given back, none of it taken but in Instantiate, and a message when there is none."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from tests.robustness.building import compile_with_zig, copy_of_sources, run

FORGOTTEN_FILE = {"fmi/instance.c": ("    resource_free(&instance->resource);\n", "")}
"""Defects for the tests to find: Free forgets the resource file's content,"""
SILENT = {"fmi/fmi3.c": ('        log_message(&blank, STATUS_ERROR, "out of memory");\n', "")}
"""and Instantiate returns NULL without a word."""
LOST_IMAGE = {"fmi/state.c": ("    free(state->image);\n    free(state);\n", "    free(state);\n")}
LOST_STATES = {"fmi/instance.c": ("    states_free(instance);\n", "")}
"""A state freed by half; states that nobody freed kept beyond their instance;"""
LOST_CHAIN = {
    "fmi/image.c": ("    instance->linear_is_lent = true; /* what the solver left there was of another state */\n", "")
}
LOST_SLOPE = {"fmi/image.c": ("    if (needed.slope) pass_doubles(stream, vectors.slope, states);\n", "")}
"""and parts of the state forgotten."""


def test_a_lack_of_memory_is_said(counting_host: Path, words: list[str]) -> None:
    """Each request in turn is refused: NULL, one message, everything given back, then it works.

    Six requests: the adapter's record, the instance, the path, the file, its content, the arrays; and two for a state:
    its record and its image.
    """
    result = run(counting_host, "scarce", words)
    assert (result.returncode, result.stderr) == (0, "")
    said = [line.split(": ", 1) for line in result.stdout.splitlines()]
    assert all(message.endswith("out of memory") for _, message in said)
    assert list(Counter(api for api, _ in said).values()) == [6 + 2] * 5


def test_silence_would_be_found(tmp_path: Path, words: list[str]) -> None:
    host = compile_with_zig(tmp_path / "host", sources=copy_of_sources(tmp_path, SILENT))
    assert "not one message for a lack of memory: FMI 3 Co-Simulation" in run(host, "scarce", words).stderr


def test_memory_does_not_grow(shipped_host: Path, words: list[str]) -> None:
    """100,000 times Instantiate, initialize, Reset and Free; 64 pages of slack for what counts them (host.c)."""
    result = run(shipped_host, "growth", words, number=100_000)
    assert (result.returncode, result.stderr) == (0, ""), result.stdout


def test_a_million_cycles(shipped_host: Path, words: list[str]) -> None:
    """Save, step, restore, through every API: the bits of the first cycle, and no memory but that of the first."""
    result = run(shipped_host, "cycles", words, number=1_000_000)
    assert (result.returncode, result.stderr) == (0, ""), result.stdout


@pytest.mark.parametrize(("defect", "says"), [
    (LOST_IMAGE, "memory lost by a state"), (LOST_STATES, "memory was not given back"),
])  # fmt: skip
def test_lost_states_would_be_found(
    defect: dict[str, tuple[str, str]], says: str, tmp_path: Path, words: list[str]
) -> None:
    host = compile_with_zig(tmp_path / "host", sources=copy_of_sources(tmp_path, defect))
    task = "scarce" if defect is LOST_IMAGE else "tour"
    assert says in run(host, task, words).stderr


@pytest.mark.parametrize("defect", [LOST_CHAIN, LOST_SLOPE], ids=["chain", "slope"])
def test_other_bits_would_be_found(defect: dict[str, tuple[str, str]], tmp_path: Path, words: list[str]) -> None:
    host = compile_with_zig(tmp_path / "host", sources=copy_of_sources(tmp_path, defect))
    assert "not the bits of" in run(host, "tour", words).stderr


@pytest.mark.parametrize(("task", "says"), [("growth", "memory has grown"), ("tour", "memory was not given back")])
def test_a_leak_would_be_found(task: str, says: str, tmp_path: Path, words: list[str]) -> None:
    host = compile_with_zig(tmp_path / "host", sources=copy_of_sources(tmp_path, FORGOTTEN_FILE))
    assert says in run(host, task, words, number=2_000).stderr
