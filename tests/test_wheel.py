"""Wheel and sdist: what they hold, and that each installs and runs where there is no compiler, nor is one asked for."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import cablefmu
from cablefmu import __version__
from cablefmu.fmu.platforms import PLATFORMS
from cablefmu.provenance import version_text
from tests.kernel.library import ROOT, toolchain

pytestmark = pytest.mark.slow  # three environments with all that the package needs

FOLDERS = ("docs", "fmu_src", "models", "tests")
FILES = ("CHANGELOG.md", "LICENSE", "README.md", "hatch_build.py", "pyproject.toml", "build/README.md", ".gitignore")
SUFFIX = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}
BINARIES = {
    *(f"{on}/{stem}{SUFFIX[on.partition('-')[2]]}" for on in PLATFORMS for stem in ("cable", "kernel")),
    *(f"{name}/source_hash.txt" for name in PLATFORMS),
    "universal-darwin/cable.dylib", "SHA256SUMS", "LICENSE", "THIRD_PARTY.txt", "variables.def",
    *(f"partners/{path.name}" for path in (ROOT / "fmu_src" / "partners").glob("*.py")),
    *(
        f"sources/{folder}/{path.name}"
        for folder in ("kernel", "fmi") for path in (ROOT / "fmu_src" / folder).iterdir()
        if path.suffix in {".c", ".h", ".def"}
    ),
}  # fmt: skip
"""What the package holds below binaries/, which git does not know."""
COMPILERS = ("cc", "gcc", "clang", "tcc", "zig", "c++", "ld")
STOP = 2.0
"""[s]"""


@dataclass(frozen=True)
class Built:
    """A copy of the tree, and what was made of it."""

    tree: Path
    wheel: Path
    sdist: Path


def copy_of_tree(folder: Path) -> Path:
    """As a fresh clone is after its libraries were compiled; and one file beside them that belongs to nobody."""
    for name in FOLDERS:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "binaries"))
    held = folder / "models" / "cablefmu" / "binaries"
    pairs = [(ROOT / name, folder / name) for name in FILES]
    shipped = ROOT / "models" / "cablefmu" / "binaries"
    for source, copy in [*pairs, *((shipped / name, held / name) for name in toolchain().products())]:
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, copy)
    (held / "partners" / "left_over.pyc").write_bytes(b"?")
    return folder


def run(*command: str | Path, at: Path, path: Path | None = None) -> str:
    """What the command prints; its PATH is `path` alone if one is given."""
    own = {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV"}
    environment = {name: value for name, value in os.environ.items() if name not in own}
    if path:
        environment["PATH"] = str(path)
    done = subprocess.run([*map(str, command)], cwd=at, env=environment, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    folder = tmp_path_factory.mktemp("built")
    tree = copy_of_tree(folder / "tree")
    run(sys.executable, "-m", "build", "--sdist", "--wheel", "--outdir", folder / "dist", tree, at=folder)
    (wheel,), (sdist,) = (folder / "dist").glob("*.whl"), (folder / "dist").glob("*.tar.gz")
    return Built(tree, wheel, sdist)


def files_below(folder: Path) -> set[str]:
    return {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and not {"binaries", "__pycache__"}.intersection(path.relative_to(folder).parts)
    }


def test_the_wheel_holds_the_package_and_nothing_else(built: Built) -> None:
    assert built.wheel.name == f"cablefmu-{__version__}-py3-none-any.whl"
    with zipfile.ZipFile(built.wheel) as archive:
        names = set(archive.namelist())
        recorded = archive.read("cablefmu/binaries/SHA256SUMS")
    about = f"cablefmu-{__version__}.dist-info/"
    licences = {"licenses/LICENSE", "licenses/fmu_src/THIRD_PARTY.txt"}
    package = {name.removeprefix("cablefmu/") for name in names if not name.startswith(about)}
    assert package == files_below(built.tree / "models" / "cablefmu") | {f"binaries/{name}" for name in BINARIES}
    assert package > {f"scenes/{name}.toml" for name in cablefmu.shipped_scenes()} and "py.typed" in package
    assert {name.removeprefix(about) for name in names if name.startswith(about)} == {
        "METADATA", "WHEEL", "RECORD", "entry_points.txt", *licences,
    }  # fmt: skip
    assert recorded == (ROOT / "models" / "cablefmu" / "binaries" / "SHA256SUMS").read_bytes()


def test_the_sdist_holds_sources_tests_and_binaries(built: Built) -> None:
    with tarfile.open(built.sdist) as archive:
        top = f"cablefmu-{__version__}/"
        names = {member.name.removeprefix(top) for member in archive.getmembers() if member.isfile()}
    sources = {f"{folder}/{name}" for folder in FOLDERS for name in files_below(built.tree / folder)}
    assert names == sources | {*FILES, "PKG-INFO"} | {f"models/cablefmu/binaries/{name}" for name in BINARIES}


def test_the_wheel_made_of_the_sdist_is_the_same_to_the_byte(built: Built, tmp_path: Path) -> None:
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", tmp_path, built.sdist, at=tmp_path)
    assert (tmp_path / built.wheel.name).read_bytes() == built.wheel.read_bytes()


@pytest.mark.parametrize("kind", ["wheel", "sdist", "editable"])
def test_it_installs_and_runs_without_a_compiler(kind: str, built: Built, tmp_path: Path) -> None:
    venv.create(tmp_path / "env", with_pip=True)
    programs = tmp_path / "env" / "bin"
    assert [name for name in COMPILERS if shutil.which(name, path=str(programs))] == []
    what = {"wheel": [built.wheel], "sdist": [built.sdist], "editable": ["-e", built.tree]}[kind]
    log = run(programs / "python", "-m", "pip", "install", "-v", "--no-compile", *what, at=tmp_path, path=programs)
    assert "numpy" in log and "ziglang" not in log
    assert ("hatchling" in log) == (kind != "wheel")  # so that what a build asks for is in the log

    def command(*words: str) -> str:
        return run(programs / "cablefmu", *words, at=tmp_path, path=programs)

    assert command("--version") == version_text() + "\n"
    command("run", "free-60-water", "--stop-time", str(STOP))  # the README's first, cut short
    header, *_, last = (tmp_path / "build" / "free-60-water.csv").read_text(encoding="utf-8").splitlines()
    expected = cablefmu.simulate("free-60-water", stop_time=STOP)
    found = dict(zip(header.split(","), map(float, last.split(",")), strict=True))
    assert found.pop("time") == STOP and len(found) > 8
    np.testing.assert_array_equal(list(found.values()), [expected[name].values[-1] for name in found])
