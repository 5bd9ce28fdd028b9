"""Which machines' libraries an FMU holds, and where each stands in the archive."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from importlib.resources import files
from importlib.resources.abc import Traversable

from ..errors import OptionError

__all__ = ["PLATFORMS", "binaries", "for_this_machine", "library", "this_platform"]

PLATFORMS = ("x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin")
"""Platform tuples of FMI 3, which FMI 2.0.4 takes for what has no name of its own."""

_FMI_2_NAMES = {"x86_64-linux": "linux64", "x86_64-windows": "win64"}
_DARWIN = {"x86_64-darwin", "aarch64-darwin"}
_SUFFIX = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}
_MACHINES = {"amd64": "x86_64", "arm64": "aarch64"}
_SYSTEMS = {"win32": "windows"}


def this_platform() -> str:
    """The tuple of the machine that runs this; one that is not among PLATFORMS has no libraries."""
    machine = platform.machine().lower()
    return f"{_MACHINES.get(machine, machine)}-{_SYSTEMS.get(sys.platform, sys.platform)}"


def for_this_machine() -> tuple[str, ...] | None:
    """Of an FMU that nobody else sees: our own platform; all where it has no libraries, so that the host says so."""
    return (this_platform(),) if this_platform() in PLATFORMS else None


def library_name(stem: str, on: str) -> str:
    """Of a library of the package for that platform, below its folder of binaries."""
    return f"{on}/{stem}{_SUFFIX[on.partition('-')[2]]}"


def library(stem: str, on: str) -> Traversable:
    """That library, "cable" of an FMU or "kernel" of the package itself."""
    return files("cablefmu") / "binaries" / library_name(stem, on)


def binaries(fmi: int, platforms: Iterable[str] | None = None) -> dict[str, str]:
    """Folder below binaries/ in the archive -> library among those of the package.

    Parameters
    ----------
    fmi
        2 or 3. In FMI 2 both of Apple's processors share one file, darwin64, in which Apple silicon finds its own.
    platforms
        Of PLATFORMS; all by default.

    Raises
    ------
    OptionError
        If there is no such platform, or none is given.
    """
    chosen = PLATFORMS if platforms is None else tuple(dict.fromkeys(platforms))
    unknown = [name for name in chosen if name not in PLATFORMS]
    if unknown or not chosen:
        given = ", ".join(unknown) or "none"
        raise OptionError(f"platforms = {given}: one or more of {', '.join(PLATFORMS)} are expected")
    if fmi == 3:
        return {name: library_name("cable", name) for name in chosen}
    found = {_FMI_2_NAMES.get(name, name): library_name("cable", name) for name in chosen if name not in _DARWIN}
    return found | ({"darwin64": "universal-darwin/cable.dylib"} if _DARWIN.intersection(chosen) else {})
