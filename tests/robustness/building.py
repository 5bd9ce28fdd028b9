"""The host in C, built with any compiler from the FMU's sources or against the FMU's own library, and run."""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from fmpy import read_model_description

from tests.kernel.library import toolchain

__all__ = ["COUNTED", "GCC", "compile_with_gcc", "compile_with_zig", "copy_of_sources", "host_sources", "run",
           "scene_words"]  # fmt: skip

HERE = Path(__file__).parent

COUNTED = [f"-D{name}=scarce_{name}" for name in ("malloc", "calloc", "free", "fopen", "fclose")]
"""The FMU's requests for memory go through scarce.c."""

_POSIX = ["-D_POSIX_C_SOURCE=200809L", "-pthread"]
GCC = ["gcc", "-g", "-O1", "-ffp-contract=off", "-fno-omit-frame-pointer"]


def host_sources() -> list[Path]:
    return sorted(HERE.glob("*.c"))


def fmu_sources() -> list[Path]:
    recipe = toolchain()
    return [*recipe.kernel_sources(), *recipe.fmi_sources()]


def copy_of_sources(folder: Path, changes: Mapping[str, tuple[str, str]]) -> list[Path]:
    """The FMU's C files in `folder`, with old text replaced by new in some: file -> (old, new)."""
    root = toolchain().HERE
    for part in ("kernel", "fmi"):
        shutil.copytree(root / part, folder / part)
    for name, (old, new) in changes.items():
        path = folder / name
        text = path.read_text()
        assert text.count(old) == 1, f"{name} no longer has this once: {old}"
        path.write_text(text.replace(old, new))
    return [path for part in ("kernel", "fmi") for path in sorted((folder / part).glob("*.c"))]


def compile_with_zig(output: Path, library: Path | None = None, sources: Sequence[Path] | None = None) -> Path:
    """As the release is compiled: from the sources with counted memory, or linked to a library of an FMU."""
    recipe = toolchain()
    target, _ = recipe.TARGETS.get(f"{platform.machine()}-{sys.platform}", (None, None))
    flags = [flag for flag in recipe.RELEASE if flag not in ("-shared", "-s")] + _POSIX
    linked = [library] if library else [*(sources or fmu_sources())]
    recipe.compile_library(output, [*host_sources(), *linked], flags + ([] if library else COUNTED), target=target)
    return output


def compile_with_gcc(output: Path, *flags: str, sources: Sequence[Path] | None = None) -> Path:
    recipe = toolchain()
    command = [*GCC, *recipe.STRICT, *_POSIX, *COUNTED, *flags, "-isystem", str(recipe.fmi_headers())]
    command += [*map(str, host_sources()), *map(str, sources or fmu_sources()), "-o", str(output), "-lm"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return output


def scene_words(folder: Path) -> list[str]:
    """What the host needs to know of an unpacked FMU, as words for its command line.

    Value references are the same in both versions of FMI, so one folder serves both APIs; 0 is the time.
    """
    description = read_model_description(str(folder))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    # A force and a mass of whatever floats or hangs.
    alike = (("u_m1", "F_cx"), ("M_1", "m_c"), ("solver",))
    known = (next(reference[name] for name in names if name in reference) for names in alike)
    numbers = (max(reference.values()) + 1, description.numberOfContinuousStates, *known)
    return [str(folder / "resources"), description.guid, *map(str, numbers)]


def run(
    host: Path, task: str, words: Sequence[str], *, number: int = 0, locale: str = "C",
    wrapper: Sequence[str] = (), environment: Mapping[str, str] | None = None, timeout: float = 300.0,
) -> subprocess.CompletedProcess[str]:  # fmt: skip
    """Run a task of the host in a process of its own, in an otherwise empty environment."""
    command = [*wrapper, str(host), task, str(number), locale, *words]
    return subprocess.run(
        command, capture_output=True, text=True, env={"PATH": "/usr/bin:/bin", **(environment or {})}, timeout=timeout
    )
