"""The licences that travel in an FMU: ours, and those of what others have in its libraries."""

from __future__ import annotations

from importlib.metadata import distribution
from importlib.resources import files

__all__ = ["LICENCE", "licence", "slave_licence"]

LICENCE = "documentation/licenses/license.txt"
"""Where both versions of FMI want them."""

_SLAVE = """The library in binaries/
========================

It is that of pythonfmu {version} (https://github.com/NTNU-IHB/PythonFMU), whose licence follows. It holds cppfmu,
Copyright 2016-2019 SINTEF Ocean, under the Mozilla Public License 2.0 (https://mozilla.org/MPL/2.0/), whose sources are
in the same place.

"""


def licence() -> bytes:
    """Of an FMU with our own libraries."""
    return _ours() + b"\n" + (files("cablefmu") / "binaries" / "THIRD_PARTY.txt").read_bytes()


def slave_licence() -> bytes:
    """Of an FMU whose slave is a Python script: its library is pythonfmu's."""
    package = distribution("pythonfmu")
    (text,) = (path.read_text(encoding="utf-8") for path in package.files or () if path.name == "LICENSE")
    return _ours() + b"\n" + _SLAVE.format(version=package.version).encode() + text.replace("\r\n", "\n").encode()


def _ours() -> bytes:
    return (files("cablefmu") / "binaries" / "LICENSE").read_bytes()
