"""FMUs whose slave is a Python script: packed by pythonfmu, described by this package."""

from __future__ import annotations

import hashlib
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from xml.etree import ElementTree as ET

from pythonfmu import FmuBuilder

from .. import __version__
from .description import describe
from .licence import LICENCE, slave_licence
from .resource import token_of
from .variables import Variable

__all__ = ["described", "partner_module", "partner_script", "slave_description", "slave_members", "without_traces"]


def partner_script(name: str) -> bytes:
    """A script of fmu_src/partners, which travels in the package's binaries/partners."""
    return (files("cablefmu") / "binaries" / "partners" / f"{name}.py").read_bytes()


def partner_module(name: str) -> tuple[bytes, str]:
    """A script, and its module: the same name for the same script alone, as FMUs of two versions share a process."""
    script = partner_script(name)
    return script, f"{name}_{hashlib.sha256(script).hexdigest()[:12]}"


def slave_members(script: bytes, *, module: str, beside: Mapping[str, bytes]) -> dict[str, bytes]:
    """What pythonfmu packs but its description: its library and its Python files, the slave, and the files beside it.

    Parameters
    ----------
    script
        The slave.
    module
        What its module is called in the FMU. One process may load several FMUs, and Python imports a module of one name
        only once: two different scripts must not share a name.
    beside
        Content of the files that lie in resources/ beside the script, by their names.
    """
    content = {f"{module}.py": script, **beside}
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        source, target = Path(folder) / "source", Path(folder) / "target"
        for name, data in content.items():
            file = source / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)
        path = source / f"{module}.py"
        others = [entry for entry in source.iterdir() if entry != path]
        with without_traces(module):
            packed = FmuBuilder.build_FMU(path, dest=target, project_files=others)
        with zipfile.ZipFile(packed) as archive:
            return {name: archive.read(name) for name in archive.namelist() if name != "modelDescription.xml"}


@contextmanager
def without_traces(module: str) -> Iterator[None]:
    """pythonfmu imports the script that it packs, and leaves it and its folder in this process."""
    path = sys.path.copy()
    try:
        yield
    finally:
        sys.path[:] = path
        sys.modules.pop(module, None)


def described(
    members: Mapping[str, bytes], *, name: str, description: str, variables: list[Variable]
) -> dict[str, bytes]:
    """The members of an archive that keeps its state, with its description and the licence of what is in it."""
    native = describe(
        2, name=name, description=description, token=token_of(b"".join(members[name] for name in sorted(members))),
        variables=variables,
    )  # fmt: skip
    return {**members, "modelDescription.xml": slave_description(native, keeps_state=True), LICENCE: slave_licence()}


_NEVER_OFFERED = ("canInterpolateInputs", "providesDirectionalDerivative")
_STATE = ("canGetAndSetFMUstate", "canSerializeFMUstate")


def slave_description(native: bytes, *, keeps_state: bool) -> bytes:
    """modelDescription.xml of Co-Simulation alone, made of what a native FMU's of FMI 2 would be.

    pythonfmu's own has no units, no initial unknowns, but a date.
    """
    root = ET.fromstring(native)
    root.set("generationTool", f"cablefmu {__version__} with PythonFMU {version('pythonfmu')}")
    for model_exchange in root.findall("ModelExchange"):
        root.remove(model_exchange)
    for co_simulation in root.findall("CoSimulation"):
        co_simulation.attrib |= {"needsExecutionTool": "true", "maxOutputDerivativeOrder": "0"}
        co_simulation.attrib |= dict.fromkeys(_NEVER_OFFERED, "false")
        co_simulation.attrib |= dict.fromkeys(_STATE, "true" if keeps_state else "false")
        for sources in co_simulation.findall("SourceFiles"):  # of C, which a script has none of
            co_simulation.remove(sources)
    ET.indent(root, "  ")
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
