"""The grid of stiff and extreme cases, stress.toml: each a scene and what is changed in it.

The file is data alone. A case is a shipped scene's name and changes as a user would write them into the scene's file,
so every case can be printed as a scene of its own (`cablefmu stress --show NAME`) and run by anybody.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

from .scene import Scene, load_scene
from .scene_schema import CableTable, WaterTable

__all__ = ["Case", "grid", "grid_from"]

_OWN_KEYS = ("base", "fmi", "short", "fails")
_ALTERNATIVES = {
    "cable": CableTable.one_of,
    "water": WaterTable.one_of,
    "terminal": (("density", "volume"),),
}
"""Keys that exclude each other: one that is given takes the others' place."""


@dataclass(frozen=True)
class Case:
    """One scene of the grid."""

    name: str
    """GROUP-KEY: letters, digits and -."""
    group: str
    base: str
    """Name of the shipped scene that is changed."""
    fmi: int
    short: bool
    """Whether it belongs to the short subset."""
    fails: str
    """Why this case must end in an error; empty if it must not."""
    changes: Mapping[str, Any]
    text: str
    """The scene as a file of its own."""

    def scene(self) -> Scene:
        """The scene, checked and assembled.

        Raises
        ------
        SceneError
            If the changes do not make a scene.
        """
        return Scene.from_text(self.text, name=self.name)

    @property
    def changed(self) -> str:
        """The changes in one line, as dotted paths."""
        return ", ".join(f"{path} = {_shortened(value)}" for path, value in _flat(self.changes))


def grid() -> list[Case]:
    """All cases, in the order of the file."""
    return grid_from((resources.files("cablefmu") / "stress.toml").read_text(encoding="utf-8"))


def grid_from(text: str) -> list[Case]:
    """The cases of a grid in TOML: tables [[group]] with name, base and what all of the group have in common
    ([group.common]), and [group.cases] with one table per case."""
    groups = tomllib.loads(text)["group"]
    return [_case(group, key, changes) for group in groups for key, changes in group["cases"].items()]


def _case(group: Mapping[str, Any], key: str, own: Mapping[str, Any]) -> Case:
    name = f"{group['name']}-{key}"
    base = own.get("base", group.get("base"))
    changes = _merged(_scene_keys(group.get("common", {})), _scene_keys(own))
    scene = _merged(tomllib.loads(load_scene(base).text), changes)
    scene["description"] = f"Stress case {name}, from {base}"
    scene["run"].pop("frame_interval", None)
    return Case(
        name,
        group["name"],
        base,
        own.get("fmi", 2),
        own.get("short", False),
        own.get("fails", ""),
        changes,
        _toml(scene),
    )


def _scene_keys(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key not in _OWN_KEYS}


def _merged(into: Mapping[str, Any], changes: Mapping[str, Any], table: str = "") -> dict[str, Any]:
    """`into` with the changes. A table of another kind replaces what was there, a key those that it excludes."""
    result = dict(into)
    for key, value in changes.items():
        for alternatives in _ALTERNATIVES.get(table, ()):
            if key in alternatives:
                result = {k: v for k, v in result.items() if k not in alternatives or k == key}
        old = result.get(key)
        if isinstance(value, dict) and isinstance(old, dict) and not ({"kind", "signal"} & set(value)):
            result[key] = _merged(old, value, key)
        else:
            result[key] = value
    return result


def _flat(table: Mapping[str, Any], path: str = "") -> list[tuple[str, Any]]:
    rows: list[tuple[str, Any]] = []
    for key, value in table.items():
        rows += _flat(value, f"{path}{key}.") if isinstance(value, dict) else [(f"{path}{key}", value)]
    return rows


def _shortened(value: Any) -> str:
    if isinstance(value, list) and len(value) > 4:
        return f"[{_value(value[0])}, ..., {_value(value[-1])}]"
    return _value(value)


def _value(value: Any) -> str:
    """One value in TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(v)}" for key, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)


def _toml(scene: Mapping[str, Any]) -> str:
    """A scene's data as TOML: its own keys, then its tables."""
    lines = [f"{key} = {_value(value)}" for key, value in scene.items() if not isinstance(value, dict)]
    for name, table in scene.items():
        if isinstance(table, dict):
            lines += ["", f"[{name}]", *(f"{key} = {_value(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"
