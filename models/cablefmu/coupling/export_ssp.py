"""A coupling as SSP 1.0: a zip of SystemStructure.ssd, and in resources/ every model's NAME.fmu and values, NAME.ssv.

The format says what is connected with what, and values; algorithm and extrapolation are the engine's.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

from .. import __version__
from ..files import replacing
from ..fmu.archive import write_zip
from .models import REAL, Model
from .schema import Value
from .system import System

__all__ = ["values_of", "write_ssp"]

_SPACE = "http://ssp-standard.org/SSP1/"
_SSD, _SSC, _SSV = (f"{_SPACE}SystemStructure{name}" for name in ("Description", "Common", "ParameterValues"))
for prefix, space in (("ssd", _SSD), ("ssc", _SSC), ("ssv", _SSV)):
    ET.register_namespace(prefix, space)


def write_ssp(system: System, path: Path) -> Path:
    """Write the coupling; an existing file is replaced.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    members = {f"resources/{name}.fmu": model.path.read_bytes() for name, model in system.models.items()}
    members |= {f"resources/{name}.ssv": _text(_values(model)) for name, model in system.models.items()}
    members["SystemStructure.ssd"] = _text(_structure(system))
    with replacing(path) as temporary:
        write_zip(temporary, members)
    return path


def values_of(model: Model) -> Iterator[tuple[str, str, Value]]:
    """Name, SSP's type and value of what is set before the run."""
    for name, value in {**model.spec.parameters, **model.constants}.items():
        variable = model.variables[name]
        if variable.type in REAL:
            yield name, "Real", float(value)
        elif variable.type in ("Boolean", "String"):
            yield name, variable.type, value
        else:  # an enumeration as its number: importers take names of enumerations for texts
            items = variable.declaredType.items if variable.type == "Enumeration" else []
            yield name, "Integer", next((int(item.value) for item in items if item.name == value), value)


def _structure(system: System) -> ET.Element:
    settings = system.settings
    root = ET.Element(
        f"{{{_SSD}}}SystemStructureDescription",
        {"version": "1.0", "name": system.coupling.name, "generationTool": f"cablefmu {__version__}"},
    )
    whole = ET.SubElement(root, f"{{{_SSD}}}System", name=system.coupling.name, description=settings.description)
    elements = ET.SubElement(whole, f"{{{_SSD}}}Elements")
    for name, model in system.models.items():
        _add_component(elements, model, [c.target.name for c in system.connections if c.target.model == name])
    if system.connections:  # an empty list of them is not allowed
        _add_connections(ET.SubElement(whole, f"{{{_SSD}}}Connections"), system)
    experiment = {"startTime": "0.0", "stopTime": repr(settings.stop_time)}
    ET.SubElement(root, f"{{{_SSD}}}DefaultExperiment", experiment)
    return root


def _add_connections(connections: ET.Element, system: System) -> None:
    for connection in system.connections:
        source, target = connection.source, connection.target
        element = ET.SubElement(connections, f"{{{_SSD}}}Connection", {
            "startElement": source.model, "startConnector": source.name,
            "endElement": target.model, "endConnector": target.name,
        })  # fmt: skip
        if connection.gain != 1.0 or connection.offset:
            numbers = {"factor": repr(connection.gain), "offset": repr(connection.offset)}
            ET.SubElement(element, f"{{{_SSC}}}LinearTransformation", numbers)


def _add_component(elements: ET.Element, model: Model, inputs: list[str]) -> None:
    source = {"name": model.name, "source": f"resources/{model.name}.fmu", "implementation": "CoSimulation"}
    component = ET.SubElement(elements, f"{{{_SSD}}}Component", {**source, "type": "application/x-fmu-sharedlibrary"})
    # Inputs that nothing feeds are left out: some importers set every input that is listed, to 0 if need be.
    listed = [(name, "input") for name in inputs] + [(name, "output") for name in model.names("output")]
    if listed:
        connectors = ET.SubElement(component, f"{{{_SSD}}}Connectors")
        for name, kind in listed:
            connector = ET.SubElement(connectors, f"{{{_SSD}}}Connector", name=name, kind=kind)
            ET.SubElement(connector, f"{{{_SSC}}}Real")
    bindings = ET.SubElement(component, f"{{{_SSD}}}ParameterBindings")
    ET.SubElement(bindings, f"{{{_SSD}}}ParameterBinding", source=f"resources/{model.name}.ssv")


def _values(model: Model) -> ET.Element:
    root = ET.Element(f"{{{_SSV}}}ParameterSet", version="1.0", name=model.name)
    listed = ET.SubElement(root, f"{{{_SSV}}}Parameters")
    for name, kind, value in values_of(model):
        parameter = ET.SubElement(listed, f"{{{_SSV}}}Parameter", name=name)
        ET.SubElement(parameter, f"{{{_SSV}}}{kind}", value=_word(value))
    return root


def _word(value: Value) -> str:
    """As XML Schema writes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _text(root: ET.Element) -> bytes:
    ET.indent(root, "  ")
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
