"""What the doctor sees: packages and extras, damaged and missing libraries, folders that cannot be written."""

from __future__ import annotations

import hashlib
import shutil
from importlib import metadata
from pathlib import Path

import pytest

import cablefmu
from cablefmu import doctor
from cablefmu.doctor import Finding, examine
from cablefmu.fmu.platforms import PLATFORMS, this_platform
from cablefmu.provenance import version_text

REQUIRES = [
    "numpy<3,>=1.26",
    "matplotlib<4,>=3.8; extra == 'plot'",
    "cablefmu[plot]; extra == 'test'",
    "pytest>=8; extra == 'test'",
]


class Metadata(dict[str, str]):
    """As of a package that asks for Python 3.11 and has two extras."""

    def get_all(self, _: str) -> list[str]:
        return ["plot", "test"]


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """What is installed, package -> version, beside the package of REQUIRES; to be changed by the test."""
    versions = {"numpy": "2.0", "matplotlib": "3.9", "pytest": "8.0"}

    def version(name: str) -> str:
        if name not in versions:
            raise metadata.PackageNotFoundError(name)
        return versions[name]

    monkeypatch.setattr(metadata, "version", version)
    monkeypatch.setattr(metadata, "requires", lambda _: REQUIRES)
    monkeypatch.setattr(metadata, "metadata", lambda _: Metadata({"Requires-Python": ">=3.11"}))
    return versions


@pytest.fixture
def binaries(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Libraries that may be damaged: a copy that the doctor looks at."""
    shutil.copytree(Path(cablefmu.__file__).parent / "binaries", tmp_path / "binaries")
    monkeypatch.setattr(doctor, "files", lambda _: tmp_path)
    return tmp_path / "binaries"


def found(what: str, folder: Path = Path("build")) -> Finding:
    return next(finding for finding in examine(folder) if finding.what == what)


def test_all_is_well_here(tmp_path: Path) -> None:
    findings = list(examine(tmp_path))
    assert [finding.failure for finding in findings if finding.failure] == []
    assert {finding.part for finding in findings} == {"package", "extra", "platform", "machine", "partners", "files"}


def test_a_dependency_is_told_with_its_version(installed: dict[str, str]) -> None:
    assert found("numpy") == Finding("package", "numpy", "2.0")
    assert found("plot") == Finding("extra", "plot", "matplotlib 3.9")
    assert found("test") == Finding("extra", "test", "pytest 8.0")  # what it takes from others is said of those


def test_a_dependency_that_is_missing_or_of_a_wrong_version_fails(installed: dict[str, str]) -> None:
    installed["numpy"] = "1.20"
    assert found("numpy").failure == "numpy 1.20: <3,>=1.26 is expected"
    del installed["numpy"]
    assert "is not installed: pip install 'numpy<3,>=1.26' is expected" in str(found("numpy").failure)


def test_an_extra_need_not_be_there_but_its_version_must_do(installed: dict[str, str]) -> None:
    del installed["matplotlib"]
    assert found("plot") == Finding("extra", "plot", "not here: matplotlib (pip install 'cablefmu[plot]')", None, True)
    installed["matplotlib"] = "4.0"
    assert "matplotlib 4.0 (<4,>=3.8 is expected)" in str(found("plot").failure)


def test_another_python_fails(installed: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor.platform, "python_version", lambda: "3.10.2")
    assert found("Python").failure == "Python 3.10.2: >=3.11 is expected"


def test_libraries_are_told_by_the_hashes_of_version() -> None:
    for name in PLATFORMS:
        line = next(line for line in version_text().splitlines() if line.startswith(name))
        assert found(name).said == "FMU {2}, kernel {3}".format(*line.split())


@pytest.mark.parametrize("name", [*PLATFORMS, "universal-darwin"])
def test_a_damaged_library_is_found(name: str, binaries: Path) -> None:
    library = next((binaries / name).glob("cable.*"))
    content = bytearray(library.read_bytes())
    content[len(content) // 2] ^= 1
    library.write_bytes(content)
    failures = [finding.failure for finding in examine() if finding.part == "platform" and finding.failure]
    assert len(failures) == 1 and f"{name}/{library.name}: not what was compiled" in failures[0]


def test_a_library_that_is_gone_is_found(binaries: Path) -> None:
    next((binaries / this_platform()).glob("kernel.*")).unlink()
    assert "kernel" in str(found(this_platform()).failure)


def test_no_sums_no_verdict(binaries: Path) -> None:
    (binaries / "SHA256SUMS").unlink()
    assert "is missing" in str(found("SHA256SUMS").failure)


def test_a_machine_without_a_library_is_told_how_to_make_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "this_platform", lambda: "riscv64-linux")
    assert "riscv64-linux: there is no library" in str(found("this machine").failure)


def test_a_folder_that_cannot_be_written_fails_and_none_is_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "cannot be written" in str(found(f"{tmp_path}/file/build/", tmp_path / "file" / "build").failure)
    assert found(f"{tmp_path}/build/", tmp_path / "build").failure is None
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_sums_are_of_the_libraries_as_they_are() -> None:
    """Else every hash that is compared above would be one of nothing."""
    folder = Path(cablefmu.__file__).parent / "binaries"
    lines = (folder / "SHA256SUMS").read_text("ascii").splitlines()
    assert len(lines) == 2 * len(PLATFORMS) + 1
    assert all(hashlib.sha256((folder / name).read_bytes()).hexdigest() == s for s, name in map(str.split, lines))
