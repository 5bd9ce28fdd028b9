"""Compile the FMU's binary from the C sources with the zig toolchain that PyPI's ziglang brings.

Used by the build hook when the package is installed, and by the tests for libraries with other flags.
Needs no compiler of the system. Imports nothing but the standard library.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent

MACH_X86_64, MACH_ARM64 = 0x01000007, 0x0100000C
"""CPU_TYPE_X86_64 and CPU_TYPE_ARM64 of <mach/machine.h>."""

TARGETS = {
    "x86_64-linux": ("x86_64-linux-gnu.2.17", "cable.so"),
    "aarch64-linux": ("aarch64-linux-gnu.2.17", "cable.so"),
    "x86_64-windows": ("x86_64-windows-gnu", "cable.dll"),
    "x86_64-darwin": ("x86_64-macos.11.0", "cable.dylib"),
    "aarch64-darwin": ("aarch64-macos.11.0", "cable.dylib"),
}
"""FMI 3 platform tuple -> (target of the compiler, file name of the FMU's library)."""

CABLE, KERNEL = "cable", "kernel"
"""The FMU's library, and beside it, with the same suffix: the kernel for Python, which no FMU holds."""

UNIVERSAL = ("universal-darwin", ("x86_64-darwin", "aarch64-darwin"))
"""Both of Apple's processors in one file, as FMI 2 wants it."""

STAMP = "source_hash.txt"
"""In each platform's folder: of which sources its libraries are."""

SUFFIXES = {".c", ".h", ".def"}
"""Of C sources, headers and tables."""

HASHES = "SHA256SUMS"
"""SHA-256 of every library in the folder, as sha256sum writes it and checks it."""

_SAME_ALWAYS = {"SOURCE_DATE_EPOCH": "0"}
"""The compiler's environment: a library for Windows says when it was linked, unless it is told when."""

REQUIREMENTS = ["ziglang==0.17.1", "fmpy>=0.3.23,<0.4"]
"""What compiling needs from PyPI: the compiler (pinned: its output is hashed), and FMPy for the FMI headers."""

STRICT = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
# -ffp-contract=off and -fno-math-errno: the same bits on every platform (no fused multiply-add behind our back).
_COMPILE = ["-O3", "-g0", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno"]
RELEASE = ["-s", "-shared", *_COMPILE]
_WITHOUT_START_UP_CODE = ["-nostdlib", "-nostartfiles", "-lucrtbase", "-lkernel32"]  # on Windows


def kernel_sources() -> list[Path]:
    """The cable itself: no FMI in it."""
    return sorted((HERE / "kernel").glob("*.c"))


def fmi_sources() -> list[Path]:
    """The FMI 2 and FMI 3 interfaces and what they share."""
    return sorted((HERE / "fmi").glob("*.c"))


def kernel_api_sources() -> list[Path]:
    """What Python calls of the kernel without an FMU."""
    return sorted((HERE / "kernel_api").glob("*.c"))


def fmu_sources() -> list[Path]:
    """All that an FMU's library is made of, headers and tables included."""
    return sorted(path for name in ("kernel", "fmi") for path in (HERE / name).iterdir() if path.suffix in SUFFIXES)


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


def windows_sources() -> list[Path]:
    """What a DLL without start-up code needs."""
    return sorted((HERE / "windows").glob("*.c"))


def source_hash() -> str:
    """SHA-256 over everything that the folder of binaries is made of, this recipe included."""
    digest = hashlib.sha256()
    files = sorted(
        p
        for folder in ("kernel", "fmi", "kernel_api", "windows")
        for p in (HERE / folder).iterdir()
        if p.suffix in SUFFIXES
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
    _zig([*_target(target), *STRICT, *flags, *_headers(), *map(str, sources), "-o", str(output), "-lm"])


def _zig(arguments: list[str]) -> None:
    """The compiler, which also links; its words if it fails."""
    command = [sys.executable, "-m", "ziglang", "cc", *arguments]
    result = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **_SAME_ALWAYS})
    if result.returncode:
        raise RuntimeError(f"the compiler failed:\n{result.stderr}")


def _target(target: str | None) -> list[str]:
    return ["-target", target] if target else []


def _headers() -> list[str]:
    return ["-isystem", str(fmi_headers())]


def _compile_flags(platform: str) -> list[str]:
    if not platform.endswith("windows"):
        return _COMPILE
    # Without start-up code nothing probes the stack, so frames must stay within the guard page of 4 kB.
    flags = [flag for flag in _COMPILE if flag != "-fPIC"]
    return [*flags, "-mno-stack-arg-probe", "-fno-stack-protector", "-Wframe-larger-than=4096"]


def _link_flags(platform: str, name: str) -> list[str]:
    if platform.endswith("windows"):
        return ["-s", "-shared", *_WITHOUT_START_UP_CODE]
    if platform.endswith("darwin"):  # not stripped: that would take the signature off arm64 libraries
        return ["-shared", f"-Wl,-install_name,@rpath/{name}"]
    return ["-s", "-shared", "-lm"]


def _sources(platform: str) -> tuple[list[Path], list[Path], list[Path]]:
    """What both libraries hold, and what the FMU's and the kernel's hold besides."""
    shim = windows_sources() if platform.endswith("windows") else []
    return [*kernel_sources(), *shim], fmi_sources(), kernel_api_sources()


def compile_objects(folder: Path, platform: str) -> dict[Path, Path]:
    """Every source -> its object in `folder`, for one platform."""
    target, flags = _target(TARGETS[platform][0]), [*STRICT, *_compile_flags(platform), *_headers()]
    sources = [source for group in _sources(platform) for source in group]
    objects = {source: folder / f"{k}-{source.stem}.o" for k, source in enumerate(sources)}

    def compile_one(source: Path) -> None:
        _zig([*target, *flags, "-c", str(source), "-o", str(objects[source])])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compile_one, sources))
    return objects


def build_platform(folder: Path, platform: str) -> None:
    """The FMU's library and the kernel's for one platform into `folder`; each source is compiled once."""
    target, library = TARGETS[platform]
    both, adapters, kernel_api = _sources(platform)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        objects = compile_objects(Path(name), platform)
        for output, own in ((library, adapters), (KERNEL + Path(library).suffix, kernel_api)):
            parts = [str(objects[source]) for source in [*both, *own]]
            _zig([*_target(target), *parts, "-o", str(folder / output), *_link_flags(platform, output)])
    for left_over in folder.glob("*.lib"):  # of the linker for Windows
        left_over.unlink()


def build_program(output: Path, source: Path, platform: str) -> None:
    """One C file as a program for that platform: hosts that the tests run there.

    On Windows it has no start-up code: it begins at mainCRTStartup and takes no command line.
    """
    windows = platform.endswith("windows")
    target = _target(TARGETS[platform][0])
    compiled = output.with_suffix(".o")
    _zig([*target, *STRICT, *_compile_flags(platform), *_headers(), "-c", str(source), "-o", str(compiled)])
    entry = ["-Wl,--subsystem,console", "-Wl,-e,mainCRTStartup"]
    _zig([*target, "-s", str(compiled), "-o", str(output), *([*entry, *_WITHOUT_START_UP_CODE] if windows else [])])


def join_universal(libraries: dict[int, bytes]) -> bytes:
    """One Mach-O file for several processors: a header in big-endian order, then each library on a page of its own.

    Parameters
    ----------
    libraries
        Processor type of <mach/machine.h> -> the library for it.
    """
    page, header = 1 << 14, struct.pack(">II", 0xCAFEBABE, len(libraries))
    content, offset = b"", page
    for processor, library in libraries.items():
        subtype = 3 if processor == MACH_X86_64 else 0
        header += struct.pack(">IIIII", processor, subtype, offset, len(library), 14)
        content += library.ljust(-(-len(library) // page) * page, b"\0")
        offset = page + len(content)
    return header.ljust(page, b"\0") + content


def build_binaries(folder: Path, platforms: Iterable[str] = TARGETS) -> None:
    """The libraries of these platforms into `folder`, where they are not current, and the texts."""
    for platform in platforms:
        if not platform_is_current(folder, platform):
            build_platform(folder / platform, platform)
            (folder / platform / STAMP).write_text(source_hash() + "\n")
    name, thin = UNIVERSAL
    if any(platform in platforms for platform in thin):
        x86, arm = ((folder / platform / "cable.dylib").read_bytes() for platform in thin)
        (folder / name).mkdir(exist_ok=True)
        (folder / name / "cable.dylib").write_bytes(join_universal({MACH_X86_64: x86, MACH_ARM64: arm}))
    copy_texts(folder)
    record_hashes(folder)


def record_hashes(folder: Path) -> None:
    """Write down what every library in `folder` is."""
    libraries = sorted(path for stem in (CABLE, KERNEL) for path in folder.glob(f"*/{stem}.*"))
    lines = (_hash_line(folder, path) + "\n" for path in libraries)
    (folder / HASHES).write_text("".join(lines), newline="\n")


def _hash_line(folder: Path, path: Path) -> str:
    return f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}"


def texts() -> dict[str, bytes]:
    """What is not compiled, by its path in the folder of binaries: variable table, partners, C sources, licences."""
    return {
        "LICENSE": (HERE.parent / "LICENSE").read_bytes(),
        "THIRD_PARTY.txt": (HERE / "THIRD_PARTY.txt").read_bytes(),
        "variables.def": (HERE / "kernel" / "variables.def").read_bytes(),
        **{f"partners/{path.name}": path.read_bytes() for path in partner_sources()},
        **{f"sources/{path.relative_to(HERE).as_posix()}": path.read_bytes() for path in fmu_sources()},
    }


def copy_texts(folder: Path) -> None:
    """Into `folder` what is not compiled."""
    shutil.rmtree(folder / "sources", ignore_errors=True)  # files that are gone
    for name, content in texts().items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def products() -> list[str]:
    """Every file of the folder of binaries, by its path in it: what wheel and sdist carry."""
    libraries = [
        f"{platform}/{name}"
        for platform, (_, library) in TARGETS.items()
        for name in (library, KERNEL + Path(library).suffix, STAMP)
    ]
    return sorted([*libraries, f"{UNIVERSAL[0]}/cable.dylib", HASHES, *texts()])


def platform_is_current(folder: Path, platform: str) -> bool:
    """Whether `folder` holds this platform's libraries, of the present sources and as they were compiled."""
    suffix, stamp = Path(TARGETS[platform][1]).suffix, folder / platform / STAMP
    if not stamp.is_file() or stamp.read_text().strip() != source_hash():
        return False
    return all(_is_as_recorded(folder, folder / platform / (stem + suffix)) for stem in (CABLE, KERNEL))


def _is_as_recorded(folder: Path, library: Path) -> bool:
    recorded = folder / HASHES
    return library.is_file() and recorded.is_file() and _hash_line(folder, library) in recorded.read_text().splitlines()


def is_current(folder: Path) -> bool:
    """Whether `folder` holds the binaries of the present sources, for every platform."""
    universal = _is_as_recorded(folder, folder / UNIVERSAL[0] / "cable.dylib")
    return universal and all(platform_is_current(folder, platform) for platform in TARGETS)


if __name__ == "__main__":
    # python fmu_src/toolchain.py [PLATFORM ...]: after a change of the C sources, in a development checkout; one
    # platform is quicker, and the next installation sees to the others
    build_binaries(HERE.parent / "models" / "cablefmu" / "binaries", sys.argv[1:] or TARGETS)
