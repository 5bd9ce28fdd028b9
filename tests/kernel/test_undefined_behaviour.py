"""No undefined behaviour: the compiler's sanitizer turns any into a trap, and none springs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.kernel.library import compile_kernel

TRAPS = [
    "-O1",
    "-shared",
    "-fPIC",
    "-fsanitize=undefined",
    "-fsanitize-trap=undefined",
    "-ffp-contract=off",
    "-Wno-pass-failed",
]
CANARY = """
int canary(int value);
__attribute__((constructor)) static void sing(void)
{
    volatile int most = 2147483647;
    most = most + canary(1);
}
int canary(int value) { return value; }
"""
"""An integer overflow as soon as the library is loaded: shows that the traps are set."""


def exercise(library: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tests.kernel.exercise", str(library)]
    root = Path(__file__).parents[2]
    return subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=300)


def test_nothing_undefined_happens(tmp_path: Path) -> None:
    result = exercise(compile_kernel(tmp_path, flags=TRAPS))
    assert (result.returncode, result.stdout) == (0, "done\n"), result.stderr


def test_undefined_behaviour_would_be_seen(tmp_path: Path) -> None:
    canary = tmp_path / "canary.c"
    canary.write_text(CANARY)
    assert exercise(compile_kernel(tmp_path, flags=TRAPS, extra=[canary])).returncode < 0  # killed by a signal
