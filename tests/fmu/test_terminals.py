"""The ports of the cable: valid by FMI's schema, of variables that there are, none where nothing can be connected."""

from __future__ import annotations

import io
import zipfile
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import fmpy
import pytest
from fmpy import read_model_description
from lxml import etree
from PIL import Image

from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.terminals import icon_png, ports_of
from cablefmu.fmu.variables import variables_of
from cablefmu.scene import Scene, shipped_scenes
from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS, SCENES, small_scene

both = pytest.mark.parametrize("fmi", [2, 3])
ASSETS = Path(__file__).parents[2] / "models" / "cablefmu" / "fmu" / "assets"

FLOATER_1 = {"F_y": ("u_m1", "inflow"), "y": ("y_m1", "signal"), "vy": ("v_m1", "signal")}
MOTION = {name: (f"{name}_c", "signal") for name in ("x", "y", "vx", "vy")}
LOAD = {"F_x": ("F_cx", "signal"), "F_y": ("F_cy", "signal"), **MOTION}


def vessel(end: int) -> dict[str, tuple[str, str]]:
    """Of an end whose motion is given: everything, and the force on the vessel."""
    members = ("x", "y", "vx", "vy", "ax", "ay", "F_x", "F_y")
    return {
        member: (member.replace("_", f"_{end}") if "_" in member else f"{member}_{end}", "signal") for member in members
    }


PORTS: dict[str, dict[str, dict[str, tuple[str, str]]]] = {
    "air": {"floater_1": FLOATER_1, "load": LOAD},
    "load": {"floater_1": FLOATER_1, "load": LOAD},
    "load-volume": {"floater_1": FLOATER_1, "load": LOAD},
    "anchor-mass": {"floater_1": FLOATER_1},
    "anchor-spring": {"floater_1": FLOATER_1},
    "pin": {"floater_1": FLOATER_1},
    "floater": {
        "floater_1": FLOATER_1,
        "floater_2": {"F_x": ("F_cx", "signal"), "F_y": ("u_m2", "signal"), **MOTION},
    },
    "surge": {
        "floater_1": {
            "F_x": ("u_m1x", "signal"),
            "F_y": ("u_m1", "signal"),
            "x": ("x_m1", "signal"),
            "y": ("y_m1", "signal"),
            "vx": ("vx_m1", "signal"),
            "vy": ("v_m1", "signal"),
        },
    },
    "moved": {"vessel_1": vessel(1), "load": LOAD},
    "between": {"vessel_1": vessel(1), "vessel_2": vessel(2)},
}
"""Terminal -> member -> variable and kind, of every small scene. A pair of forces is two signals."""


@cache
def schema() -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"))


def members(root: ET.Element) -> dict[str, dict[str, tuple[str | None, str | None]]]:
    """Terminal -> member -> variable and kind, as written."""
    return {
        str(terminal.get("name")): {
            str(member.get("memberName")): (member.get("variableName"), member.get("variableKind"))
            for member in terminal.iter("TerminalMemberVariable")
        }
        for terminal in root.iter("Terminal")
    }


@both
@pytest.mark.parametrize("name", shipped_scenes())
def test_every_shipped_scene_meets_the_schema_and_names_what_it_has(name: str, fmi: int, tmp_path: Path) -> None:
    path = build_fmu(name, tmp_path / "x.fmu", fmi=fmi)
    with zipfile.ZipFile(path) as archive:
        text = archive.read("terminalsAndIcons/terminalsAndIcons.xml")
        names = set(archive.namelist())
    schema().validate(etree.fromstring(text))
    assert [str(error) for error in schema().error_log] == []
    root = ET.fromstring(text)
    causality = {v.name: v.causality for v in read_model_description(str(path)).modelVariables}
    found = members(root)
    assert found
    for terminal in found.values():
        # FMI allows these; ours are inputs and outputs.
        assert {causality[str(variable)] for variable, _ in terminal.values()} <= {"input", "output"}
    for drawn in root.iter("TerminalGraphicalRepresentation"):
        assert {f"terminalsAndIcons/{drawn.get('iconBaseName')}.{suffix}" for suffix in ("png", "svg")} < names
    assert {"terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"} < names
    assert ("model.png" in names) == (fmi == 2)


@both
@pytest.mark.parametrize("kind", KINDS)
def test_members_of_every_kind(kind: str, fmi: int, unpacked: Unpacked) -> None:
    root = ET.parse(unpacked(kind, fmi) / "terminalsAndIcons" / "terminalsAndIcons.xml").getroot()
    assert members(root) == PORTS[kind]
    assert {terminal.get("matchingRule") for terminal in root.iter("Terminal")} == {"bus"}


def test_a_second_floater_without_a_sideways_force_takes_a_flow() -> None:
    text = SCENES["floater"].replace("horizontal_force = true\n", "")
    cable = Scene.from_text(text, name="floater").cable
    end = ports_of(cable, variables_of(cable))[-1]
    assert (end.name, end.forces, end.kind_of_forces) == ("floater_2", {"u_m2": "F_y"}, "inflow")


def test_dropped_outputs_leave_their_members_out() -> None:
    cable = small_scene("load").cable
    ports = ports_of(cable, variables_of(cable, ("y_m1", "x_c", "vy_c")))
    assert [port.motion for port in ports] == [{"v_m1": "vy"}, {"y_c": "y", "vx_c": "vx"}]


def test_what_a_vessel_takes_is_no_inflow_of_the_cable() -> None:
    """A single one neither: it is what the cable gives, and FMI's inflows are what a component takes."""
    cable = small_scene("moved").cable
    port = ports_of(cable, variables_of(cable, ("F_1x",)))[0]
    assert (port.forces, port.kind_of_forces) == ({"F_1y": "F_y"}, "signal")


def test_a_port_with_nothing_is_left_out() -> None:
    cable = small_scene("load").cable
    variables = [v for v in variables_of(cable, ("y_m1", "v_m1")) if v.name != "u_m1"]
    assert [port.name for port in ports_of(cable, variables)] == ["load"]


@pytest.mark.parametrize(("name", "side"), [("icon", 128), ("port", 32)])
def test_pictures_are_those_of_their_drawings(name: str, side: int) -> None:
    """In the middle of each circle the colour that the SVG gives it, and nothing in the corners."""
    drawing = etree.parse(ASSETS / f"{name}.svg").getroot()
    picture = Image.open(io.BytesIO((ASSETS / f"{name}.png").read_bytes())).convert("RGBA")
    assert picture.size == (side, side)
    assert drawing.get("viewBox") == f"0 0 {side} {side}"
    circles = list(drawing.iter("{*}circle"))
    assert circles
    for circle in circles:
        pixel = picture.getpixel((int(circle.get("cx") or 0), int(circle.get("cy") or 0)))
        assert pixel == (*bytes.fromhex(str(circle.get("fill")).removeprefix("#")), 255)
    assert [picture.getpixel((x, y))[3] for x in (0, side - 1) for y in (0, side - 1)] == [0] * 4  # type: ignore[index]


def test_the_icon_of_fmi_2_is_that_of_fmi_3() -> None:
    assert icon_png() == (ASSETS / "icon.png").read_bytes()
