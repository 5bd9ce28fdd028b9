"""The compiled libraries: the same bytes wherever they are compiled, hashes recorded, no one else's code in them."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import lief
import pytest

from cablefmu.fmu.platforms import PLATFORMS, library
from tests.kernel.library import ROOT, toolchain

SHIPPED = Path(str(files("cablefmu"))) / "binaries"
START_UP = {"INIT", "FINI", "INIT_ARRAY", "FINI_ARRAY", "PREINIT_ARRAY"}
"""Where code that nobody calls by name hangs in a library for Linux."""
MACH_TYPE, MACH_UNDEFINED = 0x0E, 0x00
"""N_TYPE and N_UNDF of <mach-o/nlist.h>."""
OF_THE_LINKER = {"linux": set[str](), "windows": set[str](), "darwin": {"dyld_stub_binder"}}
"""What the linker's own stubs want of the system."""


def recorded(folder: Path) -> dict[str, str]:
    """Path of each library below `folder` -> SHA-256, as the record has it."""
    lines = (folder / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    return {path: digest for digest, path in (line.split("  ") for line in lines)}


def built_elsewhere(folder: Path) -> Path:
    """The folder of binaries of a copy of the sources, made with a compiler that remembers nothing."""
    shutil.copytree(ROOT / "fmu_src", folder / "fmu_src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copyfile(ROOT / "LICENSE", folder / "LICENSE")
    caches = {f"ZIG_{which}_CACHE_DIR": str(folder / which) for which in ("GLOBAL", "LOCAL")}
    other = {"SOURCE_DATE_EPOCH": "1700000000", "TZ": "Asia/Kathmandu"}
    command = [sys.executable, str(folder / "fmu_src" / "toolchain.py")]
    done = subprocess.run(command, cwd=folder, env={**os.environ, **caches, **other}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "models" / "cablefmu" / "binaries"


def test_the_record_is_of_every_library_that_ships() -> None:
    paths = [path for stem in ("cable", "kernel") for path in SHIPPED.glob(f"*/{stem}.*")]
    names = {path.relative_to(SHIPPED).as_posix() for path in paths}
    assert {name.partition("/")[0] for name in names} == {*PLATFORMS, "universal-darwin"}
    assert recorded(SHIPPED) == {name: hashlib.sha256((SHIPPED / name).read_bytes()).hexdigest() for name in names}


@pytest.mark.slow
def test_the_same_bytes_from_another_folder(tmp_path: Path) -> None:
    """All five platforms. If they differ at once: python fmu_src/toolchain.py, ours are of other sources."""
    other = built_elsewhere(tmp_path / "a folder elsewhere, with a longer name")
    assert recorded(other) == recorded(SHIPPED)
    for name in ("LICENSE", "THIRD_PARTY.txt", "variables.def"):
        assert (other / name).read_bytes() == (SHIPPED / name).read_bytes()


def test_a_library_that_was_touched_is_compiled_again(tmp_path: Path) -> None:
    recipe, folder = toolchain(), tmp_path / "binaries"
    shutil.copytree(SHIPPED, folder)
    assert recipe.is_current(folder)
    touched = folder / "x86_64-windows" / "cable.dll"
    touched.write_bytes(touched.read_bytes()[:-1] + b"?")
    assert not recipe.platform_is_current(folder, "x86_64-windows") and not recipe.is_current(folder)
    assert recipe.platform_is_current(folder, "x86_64-linux")


def symbols_of_object(path: Path) -> tuple[set[str], set[str]]:
    """Names that an object defines for others, and that it wants of them."""
    binary = lief.parse(str(path)) or lief.COFF.parse(str(path))
    if isinstance(binary, lief.ELF.Binary):
        named = [s for s in binary.symbols if s.name and s.binding != lief.ELF.Symbol.BINDING.LOCAL]
        wanted = {str(s.name) for s in named if s.shndx == 0}
        return {str(s.name) for s in named} - wanted, wanted
    if isinstance(binary, lief.MachO.Binary):
        wanted = {str(s.name) for s in binary.symbols if s.raw_type & MACH_TYPE == MACH_UNDEFINED}
        return {str(s.name) for s in binary.symbols} - wanted, wanted
    outside = [s for s in binary.symbols if s.storage_class == lief.COFF.Symbol.STORAGE_CLASS.EXTERNAL]
    wanted = {str(s.name) for s in outside if s.section_idx == 0 and s.value == 0}
    return {str(s.name) for s in outside} - wanted, wanted


def imported(path: Path) -> set[str]:
    """Names that a library takes from the system when it is loaded."""
    binary = lief.parse(str(path))
    if isinstance(binary, lief.PE.Binary):
        return {str(entry.name) for module in binary.imports for entry in module.entries}
    return {str(symbol.name) for symbol in binary.imported_symbols}


@pytest.mark.slow
@pytest.mark.parametrize("platform", PLATFORMS)
def test_nothing_of_the_compilers_libraries_is_linked_in(platform: str, tmp_path: Path) -> None:
    """What our own objects do not define comes from the system: no archive of zig had to give a member."""
    pairs = [symbols_of_object(path) for path in toolchain().compile_objects(tmp_path, platform).values()]
    defined = set().union(*(ours for ours, _ in pairs))
    missing = {name.removeprefix("__imp_") for name in set().union(*(wanted for _, wanted in pairs)) - defined}
    stems = ("cable", "kernel")
    assert missing | OF_THE_LINKER[platform.partition("-")[2]] == set().union(
        *(imported(Path(str(library(stem, platform)))) for stem in stems)
    )
    assert {name.lstrip("_") for name in missing} > {"malloc", "free", "memcpy"}


@pytest.mark.parametrize("platform", [name for name in PLATFORMS if name.endswith("linux")])
def test_a_library_for_linux_has_no_start_up_code(platform: str) -> None:
    elf = lief.ELF.parse(str(library("cable", platform)))
    entries = {entry.tag.name for entry in elf.dynamic_entries}
    assert "NEEDED" in entries and not entries & START_UP
