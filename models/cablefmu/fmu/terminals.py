"""terminalsAndIcons/: the ports of the cable for hosts that connect whole ports, and the icon.

FMI 3.0 defines the folder, FMI 2.0.4 took it over as it is. A terminal is one port: the force that enters there and
the motion that comes of it, under the same member names at every port. What a scene does not have is left out, and so
is a terminal without members; an anchor is no port, as nothing can be connected to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from xml.etree import ElementTree as ET

from ..cable import Cable, Terminal, Top
from .variables import Variable

__all__ = ["FOLDER", "Port", "icon_png", "ports_of", "terminals_and_icons"]

FOLDER = "terminalsAndIcons"
_PICTURES = ("icon.png", "icon.svg", "port.png", "port.svg")

_SIDE = 100.0
"""The icon reaches from -_SIDE to _SIDE both ways, y up as FMI has it."""
_PORT_SIDE = 10.0
_MILLIMETRES = 0.1
"""Size of a unit of these where a host draws to scale."""
_PLACES = {
    "floater_1": (-_SIDE, 42.0), "vessel_1": (-_SIDE, 42.0),
    "floater_2": (_SIDE, -56.0), "load": (_SIDE, -56.0), "vessel_2": (_SIDE, -56.0),
}  # fmt: skip
"""Where the ports stand at the icon's edge, beside what they belong to."""

_FORCES_1 = {"u_m1x": "F_x", "u_m1": "F_y"}
_MOTION_1 = {"x_m1": "x", "y_m1": "y", "vx_m1": "vx", "v_m1": "vy"}
_FORCES_N = {"F_cx": "F_x", "F_cy": "F_y", "u_m2": "F_y"}
_MOTION_N = {"x_c": "x", "y_c": "y", "vx_c": "vx", "vy_c": "vy"}
_ENDS = {Terminal.LOAD: "load", Terminal.FLOATER: "floater_2"}


@dataclass(frozen=True, slots=True)
class Port:
    """One end of the cable to which something can be connected."""

    name: str
    description: str
    forces: dict[str, str]
    """Inputs that enter here, or at a vessel's port outputs: variable -> member."""
    motion: dict[str, str]
    """Outputs that tell how it moves, or at a vessel's port inputs: variable -> member."""

    @property
    def kind_of_forces(self) -> str:
        """A single force that enters adds up like a current. FMI leaves vectors out of that convention: a pair is two
        signals, and so is what goes out to a vessel."""
        return "inflow" if len(self.forces) == 1 and not self.name.startswith("vessel") else "signal"


def ports_of(cable: Cable, variables: Sequence[Variable]) -> list[Port]:
    """The ports that have at least one variable.

    Parameters
    ----------
    cable
        The scene's numbers: what hangs at its end.
    variables
        Of the FMU.
    """
    inputs = {variable.name for variable in variables if variable.causality == "input"}
    outputs = {variable.name for variable in variables if variable.causality == "output"}

    def port(name: str, description: str, forces: dict[str, str], motion: dict[str, str]) -> Port:
        return Port(name, description, _only(forces, inputs), _only(motion, outputs))

    def vessel(end: int, where: str) -> Port:
        motion = {f"{kind}{axis}_{end}": f"{kind}{axis}" for kind in ("", "v", "a") for axis in "xy"}
        text = f"A vessel at the {where} of the cable: its motion, the cable's force on it"
        return Port(f"vessel_{end}", text, _only({f"F_{end}x": "F_x", f"F_{end}y": "F_y"}, outputs), motion)

    what = "force, heave, surge" if cable.top is Top.FREE else "vertical force, heave"
    heaves = cable.top is not Top.MOTION
    floater = port("floater_1", f"Floater 1, at the top of the cable: {what}", _FORCES_1, _MOTION_1)
    ports = [floater if heaves else vessel(1, "top")]
    end = _ENDS.get(cable.terminal)
    if cable.terminal is Terminal.MOTION:
        ports.append(vessel(2, "lower end"))
    if end is not None:
        what = "The load at the end of the cable" if end == "load" else "The second floater, at the end of the cable"
        ports.append(port(end, f"{what}: force, position, velocity", _FORCES_N, _MOTION_N))
    return [found for found in ports if found.forces or found.motion]


def _only(members: dict[str, str], present: set[str]) -> dict[str, str]:
    return {variable: member for variable, member in members.items() if variable in present}


def icon_png() -> bytes:
    """The icon as a picture of 128 by 128 pixels: model.png of FMI 2."""
    return _picture("icon.png")


def terminals_and_icons(cable: Cable, variables: Sequence[Variable]) -> dict[str, bytes]:
    """Content of the folder, by the names in the archive."""
    pictures = {f"{FOLDER}/{name}": _picture(name) for name in _PICTURES}
    return {f"{FOLDER}/terminalsAndIcons.xml": _description(ports_of(cable, variables)), **pictures}


def _picture(name: str) -> bytes:
    return (files("cablefmu") / "fmu" / "assets" / name).read_bytes()


def _description(ports: list[Port]) -> bytes:
    root = ET.Element("fmiTerminalsAndIcons", {"fmiVersion": "3.0"})
    drawn = ET.SubElement(root, "GraphicalRepresentation")
    whole = _extent(0.0, 0.0, _SIDE)
    ET.SubElement(drawn, "CoordinateSystem", {**whole, "suggestedScalingFactorTo_mm": repr(_MILLIMETRES)})
    ET.SubElement(drawn, "Icon", whole)
    if ports:
        listing = ET.SubElement(root, "Terminals")
        for port in ports:
            _add(listing, port)
    ET.indent(root, "  ")
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _add(listing: ET.Element, port: Port) -> None:
    # "bus": a partner that has only some of the members may be connected.
    attributes = {"name": port.name, "matchingRule": "bus", "description": f"{port.description}; x right, y down"}
    element = ET.SubElement(listing, "Terminal", attributes)
    for members, kind in ((port.forces, port.kind_of_forces), (port.motion, "signal")):
        for variable, member in members.items():
            attributes = {"variableName": variable, "memberName": member, "variableKind": kind}
            ET.SubElement(element, "TerminalMemberVariable", attributes)
    place = _extent(*_PLACES[port.name], _PORT_SIDE)
    ET.SubElement(element, "TerminalGraphicalRepresentation", {**place, "iconBaseName": "port"})


def _extent(x: float, y: float, half: float) -> dict[str, str]:
    return {"x1": repr(x - half), "y1": repr(y - half), "x2": repr(x + half), "y2": repr(y + half)}
