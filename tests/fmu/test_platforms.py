"""Every machine's library: where it stands in the archive, what it exports, and what it asks of the system.

Read with LIEF, which knows the three formats; what can be run here is run in tests/platforms.
"""

from __future__ import annotations

import re
import zipfile
from importlib.resources import files
from pathlib import Path

import lief
import pytest

from cablefmu.errors import OptionError
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.platforms import PLATFORMS, binaries, for_this_machine, library, this_platform
from tests.fmu_helpers import small_scene
from tests.kernel.library import toolchain

FOLDERS = {
    2: {"linux64": ".so", "aarch64-linux": ".so", "win64": ".dll", "darwin64": ".dylib"},
    3: {"x86_64-linux": ".so", "aarch64-linux": ".so", "x86_64-windows": ".dll", "x86_64-darwin": ".dylib",
        "aarch64-darwin": ".dylib"},
}  # fmt: skip
"""FMI 2.0.4 names four platforms and takes FMI 3's tuples for the rest; FMI 3.0, section 2.5.1.4."""
SYSTEM = {
    "linux": {"libc.so.6"},
    "windows": {"ucrtbase.dll"},
    "darwin": {"@rpath/cable.dylib", "/usr/lib/libSystem.B.dylib"},  # the first is its own name
}
"""All that a library may want; ucrtbase.dll is part of Windows since 10."""
OF_THE_LINKER = {"_mh_dylib_header", "__dso_handle"}
"""What zig's linker puts beside them into every library for macOS."""
NEWEST_GLIBC = (2, 17)


def path_of(platform: str) -> Path:
    return Path(str(library("cable", platform)))


def api() -> set[str]:
    """Every function of both versions, from the standards' own headers."""
    names: set[str] = set()
    for version in (2, 3):
        text = (toolchain().fmi_headers() / f"fmi{version}FunctionTypes.h").read_text(encoding="utf-8")
        types = set(re.findall(rf"\b(fmi{version}[A-Z]\w+?)TYPE\b", text))
        # call-backs are the host's
        names |= {name for name in types if not name.endswith("Callback")}
    return names


def exported(platform: str) -> set[str]:
    path = str(path_of(platform))
    if platform.endswith("linux"):
        elf = lief.ELF.parse(path)
        return {str(symbol.name) for symbol in elf.exported_symbols}
    if platform.endswith("windows"):
        pe = lief.PE.parse(path)
        table = pe.get_export()
        return {str(entry.name) for entry in table.entries}
    macho = lief.MachO.parse(path)
    return {str(symbol.name).removeprefix("_") for symbol in macho.at(0).exported_symbols} - OF_THE_LINKER


def wanted(platform: str) -> set[str]:
    path = str(path_of(platform))
    if platform.endswith("linux"):
        elf = lief.ELF.parse(path)
        return {str(name) for name in elf.libraries}
    if platform.endswith("windows"):
        pe = lief.PE.parse(path)
        return {str(wanted.name) for wanted in pe.imports}
    macho = lief.MachO.parse(path)
    return {str(wanted.name) for wanted in macho.at(0).libraries}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("links", [5, 1000])
def test_an_archive_holds_every_platform_below_a_megabyte(links: int, fmi: int, tmp_path: Path) -> None:
    scene = small_scene("load")
    if links != 5:
        scene = type(scene).from_text(scene.text.replace("links = 5", f"links = {links}"), name="load")
    path = build_fmu(scene, tmp_path / "x.fmu", fmi=fmi)
    with zipfile.ZipFile(path) as archive:
        held = {name for name in archive.namelist() if name.startswith("binaries/")}
    assert held == {f"binaries/{folder}/load{suffix}" for folder, suffix in FOLDERS[fmi].items()}
    assert path.stat().st_size < 1e6


def test_platforms_can_be_chosen(tmp_path: Path) -> None:
    path = build_fmu(small_scene("load"), tmp_path / "x.fmu", fmi=2, platforms=["aarch64-darwin", "x86_64-linux"])
    with zipfile.ZipFile(path) as archive:
        held = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert held == ["binaries/darwin64/load.dylib", "binaries/linux64/load.so"]
    assert list(binaries(3, ["x86_64-windows"])) == ["x86_64-windows"]


@pytest.mark.parametrize(("platforms", "says"), [(["windows"], "platforms = windows: one or more of"), ([], "none")])
def test_what_is_no_platform(platforms: list[str], says: str, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=says):
        build_fmu(small_scene("load"), tmp_path / "x.fmu", platforms=platforms)
    assert not list(tmp_path.iterdir())


def test_this_machine_has_one() -> None:
    assert for_this_machine() == (this_platform(),)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_library_exports_both_apis_and_nothing_else(platform: str) -> None:
    assert exported(platform) == api()
    assert len(api()) > 100


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_library_wants_the_system_alone(platform: str) -> None:
    assert wanted(platform) == SYSTEM[platform.partition("-")[2]]


@pytest.mark.parametrize("platform", [name for name in PLATFORMS if name.endswith("linux")])
def test_an_old_glibc_is_enough(platform: str) -> None:
    elf = lief.ELF.parse(str(path_of(platform)))
    versions = [
        str(symbol.symbol_version.symbol_version_auxiliary.name) for symbol in elf.imported_symbols
        if symbol.symbol_version and symbol.symbol_version.symbol_version_auxiliary
    ]  # fmt: skip
    assert versions
    assert all(tuple(map(int, name.removeprefix("GLIBC_").split("."))) <= NEWEST_GLIBC for name in versions)


def test_one_file_for_both_of_apples_processors() -> None:
    """The library of each processor, byte by byte; the one for arm64 is signed, or the system would not load it."""
    folder = Path(str(files("cablefmu"))) / "binaries"
    both = (folder / "universal-darwin" / "cable.dylib").read_bytes()
    parts = lief.MachO.parse(str(folder / "universal-darwin" / "cable.dylib"))
    assert parts.size == 2
    for k, platform in enumerate(("x86_64-darwin", "aarch64-darwin")):
        thin = path_of(platform).read_bytes()
        start = parts.at(k).fat_offset
        assert both[start : start + len(thin)] == thin and start % (1 << 14) == 0
    assert parts.at(1).header.cpu_type == lief.MachO.Header.CPU_TYPE.ARM64 and parts.at(1).has_code_signature
