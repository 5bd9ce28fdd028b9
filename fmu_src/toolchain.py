"""Compile the FMU's binary from the C sources with the zig toolchain that PyPI's ziglang brings.

Used by the build hook when the package is installed, and by the tests for libraries with other flags.
Needs no compiler of the system. Imports nothing but the standard library.
"""

from __future__ import annotations

import hashlib
import importlib.util
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent

TARGETS = {"x86_64-linux": ("x86_64-linux-gnu.2.17", "cable.so")}
"""FMI 3 platform tuple -> (target of the compiler, file name of the FMU's library)."""

KERNEL = "kernel.so"
"""Beside it: the kernel for Python, which no FMU holds."""

REQUIREMENTS = ["ziglang==0.17.1", "fmpy>=0.3.23,<0.4"]
"""What compiling needs from PyPI: the compiler (pinned: its output is hashed), and FMPy for the FMI headers."""

STRICT = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
# -ffp-contract=off and -fno-math-errno: the same bits on every platform (no fused multiply-add behind our back).
RELEASE = ["-O3", "-g0", "-s", "-shared", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno"]


def kernel_sources() -> list[Path]:
    """The cable itself: no FMI in it."""
    return sorted((HERE / "kernel").glob("*.c"))


def fmi_sources() -> list[Path]:
    """The FMI 2 and FMI 3 interfaces and what they share."""
    return sorted((HERE / "fmi").glob("*.c"))


def kernel_api_sources() -> list[Path]:
    """What Python calls of the kernel without an FMU."""
    return sorted((HERE / "kernel_api").glob("*.c"))


def partner_sources() -> list[Path]:
    """FMUs in Python, which an installed package must find as well."""
    return sorted((HERE / "partners").glob("*.py"))


def fmi_headers() -> Path:
    """The folder of the FMI headers that FMPy ships.

    Raises
    ------
    RuntimeError
        If FMPy is not installed.
    """
    spec = importlib.util.find_spec("fmpy")
    if spec is None or not spec.submodule_search_locations:
        raise RuntimeError("compiling the FMU's binary needs the FMI headers: pip install fmpy")
    return Path(next(iter(spec.submodule_search_locations))) / "c-code"


def source_hash() -> str:
    """SHA-256 over everything that the folder of binaries is made of, this recipe included."""
    digest = hashlib.sha256()
    files = sorted(
        p
        for folder in ("kernel", "fmi", "kernel_api")
        for p in (HERE / folder).iterdir()
        if p.suffix in {".c", ".h", ".def"}
    )
    for path in [*files, *partner_sources(), Path(__file__)]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()


def compile_library(output: Path, sources: list[Path], flags: list[str], *, target: str | None = None) -> None:
    """Compile and link `sources` into the shared library `output`.

    Raises
    ------
    RuntimeError
        With the compiler's words, if it fails.
    """
    output.parent.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "ziglang", "cc", *(["-target", target] if target else []), *STRICT, *flags]
    command += ["-isystem", str(fmi_headers()), *map(str, sources), "-o", str(output), "-lm"]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode:
        raise RuntimeError(f"the compiler failed:\n{result.stderr}")


def build_binaries(folder: Path) -> None:
    """Every platform's library into `folder`, with the texts and the stamp that says of which sources."""
    for platform, (target, name) in TARGETS.items():
        compile_library(folder / platform / name, kernel_sources() + fmi_sources(), RELEASE, target=target)
        compile_library(folder / platform / KERNEL, kernel_sources() + kernel_api_sources(), RELEASE, target=target)
    copy_texts(folder)
    (folder / "source_hash.txt").write_text(source_hash() + "\n")


def copy_texts(folder: Path) -> None:
    """Into `folder` what is not compiled: the variable table, the partners' scripts, the licence."""
    (folder / "partners").mkdir(parents=True, exist_ok=True)
    for path in partner_sources():
        (folder / "partners" / path.name).write_bytes(path.read_bytes())
    (folder / "variables.def").write_bytes((HERE / "kernel" / "variables.def").read_bytes())
    (folder / "LICENSE").write_bytes((HERE.parent / "LICENSE").read_bytes())


def is_current(folder: Path) -> bool:
    """Whether `folder` holds the binaries of the present sources."""
    stamp = folder / "source_hash.txt"
    built = all(
        (folder / platform / library).is_file() for platform, (_, name) in TARGETS.items() for library in (name, KERNEL)
    )
    return built and stamp.is_file() and stamp.read_text().strip() == source_hash()


if __name__ == "__main__":  # python fmu_src/toolchain.py: after a change of the C sources, in a development checkout
    build_binaries(HERE.parent / "models" / "cablefmu" / "binaries")
