"""What is installed here, what it serves, and whether it is whole: what `cablefmu doctor` finds without a run."""

from __future__ import annotations

import ctypes
import hashlib
import platform
import sys
import sysconfig
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import metadata
from importlib.resources import files
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

from . import __version__
from .fmu.platforms import PLATFORMS, this_platform
from .provenance import platform_hashes

__all__ = ["Finding", "examine"]

NAME = "cablefmu"
_SHOWN = 3
"""So many packages of an extra are named with their versions, of more the number."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at."""

    part: str
    """What it belongs to: "package", "extra", "platform", ..."""
    what: str
    said: str
    """What was found."""
    failure: str | None = None
    """What is wrong and what to do, a sentence; None if nothing is."""
    is_absent: bool = False
    """Whether it is not there and need not be."""


def examine(folder: Path = Path("build")) -> Iterator[Finding]:
    """Everything that can be seen without a run; `folder` is where files are to be written."""
    yield from _packages()
    yield from _platforms()
    yield _machine()
    yield _partners()
    yield _writable(folder)


# --- packages ---


def _packages() -> Iterator[Finding]:
    yield _python()
    place = Path(str(files(NAME)))
    yield Finding("package", NAME, f"{__version__}, in {place}")
    try:
        known = metadata.metadata(NAME)
    except metadata.PackageNotFoundError:
        text = f"{place} is not installed, so what it depends on is not known: pip install cablefmu is expected"
        yield Finding("package", "dependencies", "not known", text)
        return
    asked = [Requirement(text) for text in metadata.requires(NAME) or ()]
    for requirement in asked:
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield _dependency(requirement)
    for extra in known.get_all("Provides-Extra") or ():
        yield _extra(extra, _packages_of(extra, asked))


def _python() -> Finding:
    said = f"{platform.python_version()} ({platform.python_implementation()}), {sys.executable}"
    try:
        allowed = metadata.metadata(NAME)["Requires-Python"] or ""
    except metadata.PackageNotFoundError:
        allowed = ""
    if platform.python_version() in SpecifierSet(allowed, prereleases=True):
        return Finding("package", "Python", said)
    return Finding("package", "Python", said, f"Python {platform.python_version()}: {allowed} is expected")


def _dependency(requirement: Requirement) -> Finding:
    found = _version(requirement.name)
    if found is None:
        text = f"{requirement} is not installed: pip install '{requirement}' is expected"
        return Finding("package", requirement.name, "-", text)
    if not requirement.specifier.contains(found, prereleases=True):
        text = f"{requirement.name} {found}: {requirement.specifier} is expected"
        return Finding("package", requirement.name, found, text)
    return Finding("package", requirement.name, found)


def _packages_of(extra: str, asked: Iterable[Requirement]) -> list[Requirement]:
    """What an extra adds; what it takes from other extras is said of those."""
    return [r for r in asked if r.marker and r.marker.evaluate({"extra": extra})
            and not r.marker.evaluate({"extra": ""}) and r.name != NAME]  # fmt: skip


def _extra(name: str, needed: Iterable[Requirement]) -> Finding:
    """An extra that is not there is no failure; one that is there in a version that will not do is."""
    found = {requirement: _version(requirement.name) for requirement in needed}
    missing = [requirement.name for requirement, version in found.items() if version is None]
    wrong = [
        f"{requirement.name} {version} ({requirement.specifier} is expected)"
        for requirement, version in found.items()
        if version is not None and not requirement.specifier.contains(version, prereleases=True)
    ]
    if wrong:
        text = f"extra {name}: {', '.join(wrong)}: pip install 'cablefmu[{name}]' is expected"
        return Finding("extra", name, "not these versions", text)
    if missing:
        lacking = ", ".join(missing) if len(missing) <= _SHOWN else f"{len(missing)} of {len(found)} packages"
        return Finding("extra", name, f"not here: {lacking} (pip install 'cablefmu[{name}]')", is_absent=True)
    if len(found) > _SHOWN:
        return Finding("extra", name, f"all {len(found)} packages")
    return Finding("extra", name, ", ".join(f"{requirement.name} {version}" for requirement, version in found.items()))


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


# --- platforms ---


def _platforms() -> Iterator[Finding]:
    """The libraries, as `--version` has them, each against the sum that was taken when it was compiled."""
    binaries = files(NAME) / "binaries"
    sums = binaries / "SHA256SUMS"
    if not sums.is_file():
        text = f"{sums}: is missing; the package is to be installed again (from sources: python fmu_src/toolchain.py)"
        yield Finding("platform", "SHA256SUMS", "-", text)
        return
    expected = {name: digest for digest, name in map(str.split, sums.read_text(encoding="ascii").splitlines())}
    for on, fmu, kernel in platform_hashes():
        damaged = [
            name for name, digest in expected.items() if name.startswith(f"{on}/")
            and (not (file := binaries / name).is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != digest)
        ]  # fmt: skip
        text = f"{', '.join(damaged)}: not what was compiled (SHA256SUMS); the package is to be installed again"
        yield Finding("platform", on, f"FMU {fmu}, kernel {kernel}", text if damaged else None)


def _machine() -> Finding:
    here = this_platform()
    said = f"{here}, {platform.platform()}"
    if here in PLATFORMS:
        return Finding("machine", "this machine", said)
    text = (
        f"{here}: there is no library for this machine; FMUs that are built here run on {', '.join(PLATFORMS)} "
        "(and here once `fmpy compile` has made theirs of their sources), the package's own runs do not"
    )
    return Finding("machine", "this machine", said, text)


# --- where things run and go ---


def _partners() -> Finding:
    """PythonFMU's library links no Python: it takes the one that its host already has in memory."""
    if not hasattr(ctypes.pythonapi, "Py_Initialize"):
        text = "Py_Initialize is hidden in this Python, so partner FMUs cannot run; another Python is expected"
        return Finding("partners", "Python partners", "cannot run here", text)
    return Finding("partners", "Python partners", f"run in this Python; in other hosts {_for_other_hosts()}")


def _for_other_hosts() -> str:
    name = sysconfig.get_config_var("INSTSONAME") or sysconfig.get_config_var("LDLIBRARY")
    if sys.platform == "win32":
        return f"with {Path(sys.base_prefix)} on PATH"
    if not sysconfig.get_config_var("Py_ENABLE_SHARED"):
        return "none can: this Python has no libpython"
    place = Path(str(sysconfig.get_config_var("LIBDIR"))) / str(name)
    return f"with LD_PRELOAD={place if place.exists() else name}"


def _writable(folder: Path) -> Finding:
    """Without making the folder: a look must leave nothing behind."""
    place = folder if folder.exists() else folder.absolute().parent
    try:
        with tempfile.NamedTemporaryFile(prefix=".cablefmu-", dir=place):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        text = f"{folder.absolute()}: cannot be written ({reason}); another present folder is expected, or --output"
        return Finding("files", f"{folder}/", "cannot be written", text)
    return Finding("files", f"{folder}/", f"{folder.absolute()} can be written")
