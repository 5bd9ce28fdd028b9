"""The JSON Schema for editors says the same as the models."""

from __future__ import annotations

import json
import re
import tomllib
from importlib import resources
from typing import Any

import jsonschema
import pytest

from cablefmu.scene_schema import OUTPUTS, STATICS, inputs_of, schema_text

PACKAGE = resources.files("cablefmu")
SCENES = sorted(entry.name for entry in (PACKAGE / "scenes").iterdir() if entry.name.endswith(".toml"))


@pytest.fixture(scope="module")
def validator() -> Any:
    schema = json.loads((PACKAGE / "scene.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_schema_that_ships_is_current() -> None:
    shipped = (PACKAGE / "scene.schema.json").read_text(encoding="utf-8")
    assert shipped == schema_text(), "write cablefmu.scene_schema.schema_text() to scene.schema.json"


@pytest.mark.parametrize("name", SCENES)
def test_shipped_scenes_are_valid(name: str, validator: Any) -> None:
    validator.validate(tomllib.loads((PACKAGE / "scenes" / name).read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ("cable", "links", 0),
        ("cable", "lenght", 3),
        ("cable", "link_length", [1.0]),  # besides length
        ("cable", "diameter", "0.02"),
        ("water", "density", -1.0),
        ("water", "drag_per_link", 200.0),  # besides Cd
        ("terminal", "kind", "anchor"),
        ("top", "kind", "boat"),
        ("top", "kind", "motion"),  # with a mass
        ("shape", "angle", True),
        ("run", "tolerance", 1.0),
        ("run", "solver", "stiff"),
        ("run", "initial", "rest"),
        ("run", "record", ["x_c"]),
        ("run", "record", "nodes"),
        ("outputs", "solver", "no"),
    ],
)
def test_editors_are_warned(table: str, key: str, value: object, validator: Any) -> None:
    scene = tomllib.loads((PACKAGE / "scenes" / "free-12-water.toml").read_text(encoding="utf-8"))
    scene.setdefault(table, {})[key] = value
    assert not validator.is_valid(scene)


def test_inputs_and_outputs_have_the_names_that_users_rely_on() -> None:
    def under(terminal: str, *, forced: bool = False, top: str = "floater", surges: bool = False) -> tuple[str, ...]:
        return inputs_of(top, surges, terminal, forced)

    assert under("load") == ("u_m1", "F_cx", "F_cy")
    assert under("floater") == ("u_m1", "u_m2")
    assert under("floater", forced=True) == ("u_m1", "u_m2", "F_cx")
    assert under("anchor-mass") == under("anchor-spring") == under("pin") == ("u_m1",)
    assert under("load", surges=True) == ("u_m1", "F_cx", "F_cy", "u_m1x")
    moved = {end: tuple(f"{kind}{axis}_{end}" for kind in ("", "v", "a") for axis in "xy") for end in (1, 2)}
    assert under("motion") == ("u_m1", *moved[2])
    assert under("load", top="motion") == ("F_cx", "F_cy", *moved[1])
    assert under("motion", top="motion") == (*moved[1], *moved[2])
    assert OUTPUTS[:6] == ("y_m1", "v_m1", "x_c", "y_c", "vx_c", "vy_c")
    assert OUTPUTS[6:10] == ("tension_top", "tension_end", "tension_max", "energy")


def test_outputs_of_an_equilibrium_are_those_of_the_table_of_variables() -> None:
    text = (PACKAGE / "binaries" / "variables.def").read_text(encoding="utf-8")
    names = re.findall(r"^STATICS\((\w+)", text, re.MULTILINE)
    assert [f"statics.{name}" for name in names] == list(STATICS)
