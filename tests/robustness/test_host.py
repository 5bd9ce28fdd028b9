"""The host that the tests of this folder share calls everything there is, and two compilers give it the same bits."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.kernel.library import toolchain
from tests.robustness.building import run

HERE = Path(__file__).parent


@pytest.mark.parametrize(("fmi", "count"), [(2, 44), (3, 75)])
def test_the_host_calls_every_function(fmi: int, count: int) -> None:
    header = (toolchain().fmi_headers() / f"fmi{fmi}Functions.h").read_text()
    functions = set(re.findall(rf"^\s*FMI{fmi}_Export\s+fmi{fmi}\w+TYPE\s+(fmi{fmi}\w+);", header, re.MULTILINE))
    called = set(re.findall(rf"\b(fmi{fmi}\w+)\(", "".join(path.read_text() for path in HERE.glob("*.c"))))
    assert len(functions) == count
    assert functions - called == set()


def test_the_shipped_library_is_made_of_these_sources(
    shipped_host: Path, counting_host: Path, words: list[str]
) -> None:
    """Every value, status and message of a tour: the archive's binary against the sources linked in directly."""
    shipped, counting = run(shipped_host, "tour", words), run(counting_host, "tour", words)
    assert (shipped.returncode, shipped.stderr) == (0, "")
    assert len(shipped.stdout.splitlines()) > 3000  # six scenes, five APIs, twice fifty steps
    assert counting.stdout == shipped.stdout
