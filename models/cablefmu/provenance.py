"""Which version this is, of which sources its libraries are, and what they are to the bit."""

from __future__ import annotations

import hashlib
from importlib.resources import files
from importlib.resources.abc import Traversable

from . import __version__
from .fmu.platforms import PLATFORMS, binaries, library_name

__all__ = ["platform_hashes", "version_text"]

_DIGITS = 12
_NONE = "-"


def version_text() -> str:
    """The version, and for every platform the SHA-256 of its sources, of the FMU's library and of the kernel's.

    Each is worked out from the file itself, the first digits of what binaries/SHA256SUMS has in full; "-" where there
    is none.
    """
    rows = [("", "sources", "FMU", "kernel")]
    rows += [(name, _stamp(name), fmu, kernel) for name, fmu, kernel in platform_hashes()]
    lines = [f"{name:<16}  {source:<{_DIGITS}}  {fmu:<{_DIGITS}}  {kernel}" for name, source, fmu, kernel in rows]
    return "\n".join([f"cablefmu {__version__}", *lines])


def platform_hashes() -> list[tuple[str, str, str]]:
    """Of every platform, and of what both of Apple's share: its name, the FMU's library and the kernel's."""
    rows = [(name, _hash(library_name("cable", name)), _hash(library_name("kernel", name))) for name in PLATFORMS]
    universal = binaries(2)["darwin64"]
    return [*rows, (universal.partition("/")[0], _hash(universal), _NONE)]


def _file(name: str) -> Traversable:
    return files("cablefmu") / "binaries" / name


def _stamp(platform: str) -> str:
    """Of the C sources, the partners' scripts and the recipe, as the build has it."""
    stamp = _file(f"{platform}/source_hash.txt")
    return stamp.read_text(encoding="ascii")[:_DIGITS] if stamp.is_file() else _NONE


def _hash(name: str) -> str:
    binary = _file(name)
    return hashlib.sha256(binary.read_bytes()).hexdigest()[:_DIGITS] if binary.is_file() else _NONE
