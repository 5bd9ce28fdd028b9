"""A coupling as a system structure of the Open Simulation Platform: OspSystemStructure.xml beside the FMUs."""

from __future__ import annotations

import shutil
from pathlib import Path
from xml.etree import ElementTree as ET

from ..files import check_writable, replacing
from .export_ssp import values_of
from .system import System

__all__ = ["STRUCTURE", "write_osp"]

STRUCTURE = "OspSystemStructure.xml"
_SPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"


def write_osp(system: System, folder: Path) -> Path:
    """Write the coupling into a folder: its structure and every FMU as NAME.fmu, existing files replaced.

    Returns the path of the structure.

    Raises
    ------
    OptionError
        If the folder cannot be written to.
    """
    path = folder / STRUCTURE
    check_writable(path)
    for name, model in system.models.items():
        with replacing(folder / f"{name}.fmu") as temporary:
            shutil.copyfile(model.path, temporary)
    root = _structure(system)
    ET.indent(root, "  ")
    with replacing(path) as temporary:
        temporary.write_bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n")
    return path


def _structure(system: System) -> ET.Element:
    root = ET.Element("OspSystemStructure", xmlns=_SPACE, version="0.1")
    ET.SubElement(root, "StartTime").text = "0.0"
    ET.SubElement(root, "BaseStepSize").text = repr(system.settings.step)
    ET.SubElement(root, "Algorithm").text = "fixedStep"
    simulators = ET.SubElement(root, "Simulators")
    for name, model in system.models.items():
        simulator = ET.SubElement(simulators, "Simulator", name=name, source=f"{name}.fmu")
        values = list(values_of(model))
        initial = ET.SubElement(simulator, "InitialValues") if values else simulator
        for variable, kind, value in values:
            word = str(value).lower() if isinstance(value, bool) else str(value)
            ET.SubElement(ET.SubElement(initial, "InitialValue", variable=variable), kind, value=word)
    scaled = [(f"gain_{k}", c) for k, c in enumerate(system.connections, start=1) if c.gain != 1.0 or c.offset]
    if scaled:
        functions = ET.SubElement(root, "Functions")
        for name, connection in scaled:
            numbers = {"name": name, "factor": repr(connection.gain), "offset": repr(connection.offset)}
            ET.SubElement(functions, "LinearTransformation", numbers)
    connections = ET.SubElement(root, "Connections")
    names = {connection: name for name, connection in scaled}
    for connection in system.connections:
        ends = [("Variable", "simulator", connection.source), ("Variable", "simulator", connection.target)]
        if connection not in names:
            element = ET.SubElement(connections, "VariableConnection")
            for _, _, end in ends:
                ET.SubElement(element, "Variable", simulator=end.model, name=end.name)
            continue
        function = names[connection]
        into = ET.SubElement(connections, "SignalConnection")
        ET.SubElement(into, "Variable", simulator=connection.source.model, name=connection.source.name)
        ET.SubElement(into, "Signal", function=function, name="in")
        out = ET.SubElement(connections, "SignalConnection")
        ET.SubElement(out, "Signal", function=function, name="out")
        ET.SubElement(out, "Variable", simulator=connection.target.model, name=connection.target.name)
    return root
