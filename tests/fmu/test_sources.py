"""The sources in the archive: complete, ours to the byte, and good for a library, whoever compiles them.

Here with zig (Clang); those marked `system` with GCC, as `fmpy compile` does it. What is compared is bits: nothing is
fused and nothing comes from libm, whatever the compiler and its flags.
"""

from __future__ import annotations

import ctypes
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath

import lief
import numpy as np
import pytest
from fmpy.model_description import read_build_description
from lxml import etree

from cablefmu.fmu.archive import build_fmu, write_zip
from cablefmu.fmu.platforms import this_platform
from cablefmu.scene import Scene, load_scene
from cablefmu.simulate import simulate
from tests.fmu_helpers import SCENES, small_scene
from tests.kernel.library import ROOT, toolchain
from tests.platforms.machines import MACHINES, Machine, run_of

both = pytest.mark.parametrize("fmi", [2, 3])

FOREIGN = {2: {"fmi2Functions.h"}, 3: {"fmi3Functions.h"}}
"""The importer's; what they include themselves is his as well."""
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
AS_A_LIBRARY = "-DFMI3_OVERRIDE_FUNCTION_PREFIX=1"
"""What buildDescription.xml has; in FMI 2 the importer's header sees to it."""
RUNS = ("heave-60-water", "seabed-pin-60", "free-12-air")
STOP = 2.0
"""[s]"""
EXPLICIT, IMPLICIT = 2, 3


def unpacked(path: Path, folder: Path) -> Path:
    """The archive's sources below `folder`."""
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            if name.startswith("sources/"):
                archive.extract(name, folder)
    return folder / "sources"


def files_of(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def folder_of(tmp_path: Path) -> Callable[[int, str], Path]:
    """Version, name of the scene -> its FMU's sources, unpacked."""

    def build(fmi: int, name: str = "load") -> Path:
        scene = Scene.from_text(SCENES["load"], name=name)
        return unpacked(
            build_fmu(scene, tmp_path / f"{name}.fmu", fmi=fmi, platforms=[this_platform()]), tmp_path / name
        )

    return build


def listed(path: Path, fmi: int) -> set[tuple[str, ...]]:
    """The files to be compiled, as each interface of the FMU says it."""
    if fmi == 3:
        sets = [configuration.sourceFileSets[0] for configuration in read_build_description(str(path))]
        return {tuple(file_set.sourceFiles) for file_set in sets}
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("modelDescription.xml"))
    interfaces = [root.find(name) for name in ("ModelExchange", "CoSimulation")]
    return {tuple(file.get("name") for file in found.iterfind("SourceFiles/File")) for found in interfaces}


@both
def test_two_files_are_to_be_compiled(fmi: int, tmp_path: Path) -> None:
    """FMPy has checked modelDescription.xml (test_archive.py); here buildDescription.xml against FMI's schema."""
    path = build_fmu(small_scene("load-volume"), tmp_path / "x.fmu", fmi=fmi)
    assert listed(path, fmi) == {("load_volume.c", "load_volume_avx2.c")}
    with zipfile.ZipFile(path) as archive:
        assert ("sources/buildDescription.xml" in archive.namelist()) == (fmi == 3)


def test_the_build_description_names_the_fmu_and_how_its_functions_lose_their_prefix(tmp_path: Path) -> None:
    path = build_fmu(small_scene("load-volume"), tmp_path / "x.fmu", fmi=3)
    (configuration,) = read_build_description(str(path), validate=True)
    assert configuration.modelIdentifier == "load_volume"
    (file_set,) = configuration.sourceFileSets
    assert file_set.language == "C11"
    (definition,) = file_set.preprocessorDefinitions
    assert f"-D{definition.name}={definition.value}" == AS_A_LIBRARY and definition.optional


def included(folder: Path, name: str) -> Iterator[str]:
    """Files that a file includes in quotes: relative to itself, or to the folder, which the importer names."""
    for include in re.findall(r'^#include "([^"]+)"', (folder / name).read_text(encoding="utf-8"), re.M):
        beside = (folder / name).parent / include
        yield beside.resolve().relative_to(folder.resolve()).as_posix() if beside.exists() else include


@both
def test_all_that_is_included_is_there_and_nothing_else(fmi: int, folder_of: Callable[..., Path]) -> None:
    folder = folder_of(fmi)
    there = set(files_of(folder))
    seen: set[str] = set()
    waiting = ["load.c", "load_avx2.c", "fmi/unit.h"]
    while waiting:
        name = waiting.pop()
        if name in seen or name in FOREIGN[fmi]:
            continue
        seen.add(name)
        waiting += included(folder, name)
    assert seen == there - {"buildDescription.xml"}
    assert not [
        name
        for name in there
        if re.match(rf"(fmi{fmi}(Functions|.*Types).*\.h|fmi{5 - fmi})", PurePosixPath(name).name)
    ]
    assert "kernel/chain.c" in there and f"fmi/fmi{fmi}.c" in there


@both
def test_files_are_those_of_the_repository(fmi: int, folder_of: Callable[..., Path]) -> None:
    written = {"load.c", "load_avx2.c", "names.h", "buildDescription.xml"}
    ours = {name: content for name, content in files_of(folder_of(fmi)).items() if name not in written}
    assert ours == {name: (ROOT / "fmu_src" / name).read_bytes() for name in ours}
    assert set(ours) == {
        path.relative_to(ROOT / "fmu_src").as_posix() for path in toolchain().fmu_sources()
        if not path.name.startswith(f"fmi{5 - fmi}")
    }  # fmt: skip


def api(fmi: int) -> set[str]:
    text = (toolchain().fmi_headers() / f"fmi{fmi}FunctionTypes.h").read_text(encoding="utf-8")
    types = set(re.findall(rf"\b(fmi{fmi}[A-Z]\w+?)TYPE\b", text))
    return {name for name in types if not name.endswith("Callback")}


def exported(path: Path) -> set[str]:
    elf = lief.ELF.parse(str(path))
    return {str(symbol.name) for symbol in elf.exported_symbols}


@both
def test_a_library_of_them_exports_the_api_and_wants_no_libm(
    fmi: int, folder_of: Callable[..., Path], tmp_path: Path
) -> None:
    folder = folder_of(fmi)
    sources = [folder / "load.c", folder / "load_avx2.c"]
    flags = ["-shared", "-fPIC", "-O1", AS_A_LIBRARY]
    toolchain().compile_library(tmp_path / "load.so", sources, flags, target="x86_64-linux-gnu.2.17")
    assert exported(tmp_path / "load.so") == api(fmi)
    elf = lief.ELF.parse(str(tmp_path / "load.so"))
    assert set(elf.libraries) == {"libc.so.6"}


def header_that_prefixes(folder: Path) -> Path:
    """FMI 2's own way with FMI2_FUNCTION_PREFIX, which FMPy's header leaves out [FMI 2.0.1, fmi2Functions.h]."""
    text = (toolchain().fmi_headers() / "fmi2Functions.h").read_text(encoding="utf-8")
    never = "#define fmi2FullName(name) name"
    assert text.count(never) == 1
    pasted = (
        "#define fmi2Paste(a, b) a##b\n#define fmi2PasteB(a, b) fmi2Paste(a, b)\n"
        "#define fmi2FullName(name) fmi2PasteB(FMI2_FUNCTION_PREFIX, name)"
    )
    folder.mkdir()
    (folder / "fmi2Functions.h").write_text(text.replace(never, pasted), encoding="utf-8")
    return folder


@both
def test_two_fmus_in_one_program_do_not_collide(fmi: int, folder_of: Callable[..., Path], tmp_path: Path) -> None:
    """Linked into one file, where a name that both define would be an error; each is called by its own names."""
    names = ("first", "second")
    sources = [folder_of(fmi, name) / file for name in names for file in (f"{name}.c", f"{name}_avx2.c")]
    headers = ["-isystem", str(header_that_prefixes(tmp_path / "headers"))]
    visible = '-DFMI3_Export=__attribute__((visibility("default")))'  # else nobody outside sees functions with a prefix
    toolchain().compile_library(tmp_path / "both.so", sources, ["-shared", "-fPIC", "-O0", *headers, visible])
    library = ctypes.CDLL(str(tmp_path / "both.so"))
    for name in names:
        version = getattr(library, f"{name}_fmi{fmi}GetVersion")
        version.restype = ctypes.c_char_p
        assert version() == f"{fmi}.0".encode()


# --- with the system's compiler ---


def gcc(folder: Path, *flags: str) -> None:
    headers = ["-isystem", str(toolchain().fmi_headers())]
    command = ["gcc", "-std=c11", *STRICT, *headers, AS_A_LIBRARY, *flags, "load.c", "load_avx2.c"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)


@pytest.mark.system
@pytest.mark.parametrize("level", ["-O0", "-O2", "-O3"])
@both
def test_gcc_has_nothing_to_say(fmi: int, level: str, folder_of: Callable[..., Path], tmp_path: Path) -> None:
    """No warning, and no libm, which it would call for roots."""
    gcc(folder_of(fmi), level, "-shared", "-fPIC", "-Wl,-z,defs", "-o", str(tmp_path / "load.so"))
    assert exported(tmp_path / "load.so") >= api(fmi)


@pytest.mark.system
@pytest.mark.parametrize("flag", ["-ffast-math", "-march=x86-64-v3"])
def test_flags_that_would_change_numbers(flag: str, folder_of: Callable[..., Path], tmp_path: Path) -> None:
    """Without infinities and digits it is refused; where the processor could fuse, nothing is fused."""
    folder = folder_of(3)
    if flag == "-ffast-math":
        with pytest.raises(subprocess.CalledProcessError) as refused:
            gcc(folder, flag, "-fsyntax-only")
        assert "compile without it" in refused.value.stderr
        return
    gcc(folder, flag, "-O3", "-S")
    assert not re.findall(r"\bvfn?m\w+", (folder / "load.s").read_text() + (folder / "load_avx2.s").read_text())


@pytest.mark.system
@pytest.mark.parametrize(
    "machine", [machine for machine in MACHINES if "linux" in machine.platform], ids=lambda found: found.platform
)
def test_clang_gives_the_same_bits_on_another_processor(
    machine: Machine, folder_of: Callable[..., Path], tmp_path: Path
) -> None:
    """That for aarch64 has roots and fused operations of its own."""
    library = tmp_path / "load.so"
    sources = [folder_of(2) / "load.c", folder_of(2) / "load_avx2.c"]
    toolchain().compile_library(
        library, sources, ["-shared", "-fPIC", "-O2"], target=toolchain().TARGETS[machine.platform][0]
    )
    for name in RUNS:
        (tmp_path / name).mkdir()
        for solver in (EXPLICIT, IMPLICIT):
            run = run_of(load_scene(name), tmp_path / name, solver, STOP, 0.1)
            expected, found = MACHINES[0].run(run, tmp_path), machine.run(run, tmp_path, library=library)
            assert np.isfinite(expected).all() and np.any(expected[-1] != expected[0])
            assert found.tobytes() == expected.tobytes(), (name, solver)


@pytest.fixture(scope="module", params=[2, 3])
def compiled(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[int, bytes]:
    """Version, and the library that `fmpy compile` made of an FMU's sources in place of the one that came with it."""
    folder = tmp_path_factory.mktemp(f"compiled-{request.param}")
    path = build_fmu(small_scene("load"), folder / "load.fmu", fmi=request.param)
    before = libraries(path)
    command = [sys.executable, "-m", "fmpy", "compile", "--all-warnings", "--warning-as-error", str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"apt-get install cmake make gcc? {done.stdout}{done.stderr}"
    after = libraries(path)
    assert set(after) == set(before)
    (changed,) = (name for name in after if after[name] != before[name])
    assert changed.split("/")[1] == ("linux64" if request.param == 2 else this_platform())
    return request.param, after[changed]


def libraries(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if re.match("binaries/.*[^/]$", name)}


@pytest.mark.system
@pytest.mark.parametrize(("interface", "solver"), [("cs", "explicit"), ("cs", "implicit"), ("me", "automatic")])
@pytest.mark.parametrize("name", RUNS)
def test_what_fmpy_compiles_gives_the_same_bits(
    name: str, interface: str, solver: str, compiled: tuple[int, bytes], tmp_path: Path
) -> None:
    fmi, library = compiled
    shipped = build_fmu(name, tmp_path / "shipped.fmu", fmi=fmi, platforms=[this_platform()])
    with zipfile.ZipFile(shipped) as archive:
        members = {member: archive.read(member) for member in archive.namelist()}
    (place,) = libraries(shipped)
    write_zip(tmp_path / "ours.fmu", {**members, place: library})
    expected, found = (
        simulate(path, interface=interface, stop_time=STOP, parameters={"solver": solver}, record=["theta", "omega"])
        for path in (shipped, tmp_path / "ours.fmu")
    )
    assert set(found) == set(expected) and "tension_max" in found
    for variable in expected:
        values = expected[variable].values
        assert np.isfinite(values).all()
        assert found[variable].values.tobytes() == values.tobytes(), variable
    assert np.ptp(expected["theta"].values, axis=0).max() > 0.1  # [rad]: it moves
