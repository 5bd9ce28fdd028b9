"""From what is wrong with a scene to lines for a person: file, key, value, and what is allowed."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from cablefmu.errors import SceneError
from cablefmu.scene_schema import Spec
from cablefmu.scene_table import MARKS, Table
from cablefmu.units import Measure

__all__ = ["Mistake", "MistakeFoundError", "mistakes_of", "nearest", "scene_error"]

_MAX_LINES = 50
_LONGEST_VALUE = 60
_NOTHING = object()


@dataclass(frozen=True, slots=True)
class Mistake:
    """One line of a `SceneError`, less the file's name."""

    key: str
    """Dotted key, empty for the scene as a whole."""
    text: str
    value: object = _NOTHING
    """What the file has there; a whole table is not shown."""

    def line(self) -> str:
        shown = "" if self.value is _NOTHING or isinstance(self.value, dict) else f" = {_show(self.value)}"
        return f"{self.key}{shown}: {self.text}" if self.key else self.text


class MistakeFoundError(Exception):
    """Carries a `Mistake` from where numbers are worked out to where the file's name is known."""

    def __init__(self, mistake: Mistake) -> None:
        super().__init__(mistake.line())
        self.mistake = mistake


def scene_error(source: str, mistakes: Iterable[Mistake]) -> SceneError:
    """Put all mistakes of one file into one error, a line each."""
    lines = [f"{source}: {mistake.line()}" for mistake in mistakes]
    if len(lines) > _MAX_LINES:
        lines = [*lines[:_MAX_LINES], f"{source}: ... and {len(lines) - _MAX_LINES} more mistakes"]
    return SceneError("\n".join(lines))


def nearest(word: str, allowed: Iterable[str]) -> str:
    """What to answer to a name that does not exist: the most similar one, and all that do."""
    names = list(allowed)
    match = difflib.get_close_matches(word.lower(), [name.lower() for name in names], n=1, cutoff=0.6)
    near = next((f'the nearest is "{name}"; ' for name in names if match and name.lower() == match[0]), "")
    return f"{near}allowed: {', '.join(names)}"


def mistakes_of(error: ValidationError, root: type[BaseModel] = Spec) -> list[Mistake]:
    """Translate what pydantic found while it read a table of type `root`."""
    return [_mistake(dict(details), root) for details in error.errors(include_url=False)]


def _mistake(details: dict[str, Any], root: type[BaseModel]) -> Mistake:
    loc: tuple[int | str, ...] = details["loc"]
    context: dict[str, Any] = details.get("ctx", {})
    value = details["input"]
    if details["type"] == "invalid_key":
        return Mistake(_key(loc[:-1]), f"keys are texts, and {loc[-1]!r} is none")
    key = _key(loc)
    match details["type"]:
        case "missing" if isinstance(loc[-1], int):
            return Mistake(_key(loc[:-1]), "a list with 2 entries (x and y) is expected", value)
        case "missing":
            return Mistake(key, f"this key is missing; {_wanted(loc, root)}")
        case "extra_forbidden":
            return Mistake(
                key, f"unknown key; {nearest(str(loc[-1]), _tables_at(loc[:-1], root)[0].model_fields)}", value
            )
        case "union_tag_invalid" | "union_tag_not_found":
            name = context["discriminator"].strip("'")
            allowed = re.findall(r"'([^']*)'", context.get("expected_tags", "")) or [
                tag for model in _tables_at(loc, root) for tag in _tags(model)
            ]
            given = value.get(name, _NOTHING) if isinstance(value, dict) else _NOTHING
            text = f"this key is missing; allowed: {', '.join(allowed)}"
            return Mistake(
                f"{key}.{name}", text if given is _NOTHING else nearest(_show(given).strip('"'), allowed), given
            )
        case "literal_error":
            return Mistake(key, nearest(_show(value).strip('"'), re.findall(r"'([^']*)'", context["expected"])), value)
        case "model_type" | "model_attributes_type" | "dict_type":
            return Mistake(key, "a table is expected", value)
        case "tuple_type" | "list_type":
            return Mistake(key, "a list is expected", value)
        case "string_type":
            return Mistake(key, "a text is expected", value)
        case "bool_type":
            return Mistake(key, "true or false is expected", value)
        case "int_type" | "greater_than_equal":
            return Mistake(key, "a whole number from 1, or a name, is expected", value)
        case "too_short" | "too_long":
            entries = "2 entries (x and y)" if loc[-1] == "position" else "at least one entry"
            return Mistake(key, f"a list with {entries} is expected", value)
    return Mistake(key, str(details["msg"]), value)


# --------------------------------------------------------------------------------------------------- places


def _key(loc: tuple[int | str, ...]) -> str:
    """Dotted key of an error's place, without the branches that pydantic took."""
    parts: list[str] = []
    for part, is_key in _steps(loc):
        if isinstance(part, int):
            parts[-1] += f", entry {part + 1}"
        elif is_key:
            parts.append(part if re.fullmatch(r"[A-Za-z0-9_-]+", part) else _show(part))
    return ".".join(parts)


def _steps(loc: tuple[int | str, ...]) -> Iterable[tuple[int | str, bool]]:
    """Each entry of a location, and whether it is a key of the file."""
    for k, part in enumerate(loc):
        # After a table of several kinds stands the kind; a mark only stands inside.
        is_kind = (k == 1 and loc[0] in _OF_KINDS and part in _KINDS) or (k > 0 and loc[k - 1] == "<table>")
        yield part, not (isinstance(part, str) and (is_kind or (part in MARKS and k >= 2)))


def _tables_at(loc: tuple[int | str, ...], root: type[BaseModel]) -> list[type[BaseModel]]:
    """The models that may read the table at a location: one, unless its kind is still open."""
    choices: list[type[BaseModel]] = [root]
    for part, is_key in _steps(loc):
        if isinstance(part, str) and is_key:
            choices = _models_in(choices[0].model_fields[part].annotation)
        elif isinstance(part, str) and part not in MARKS:
            choices = [model for model in choices if part in _tags(model)]
    return choices


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return [annotation]
    return [model for argument in get_args(annotation) for model in _models_in(argument)]


def _tags(model: type[BaseModel]) -> tuple[str, ...]:
    """The kinds (or signals) that a table stands for."""
    return tuple(
        tag
        for name in ("kind", "signal")
        if name in model.model_fields
        for tag in get_args(model.model_fields[name].annotation)
    )


def _all_tags(key: str) -> list[str]:
    return [tag for model in _models_in(Spec.model_fields[key].annotation) for tag in _tags(model)]


def _wanted(loc: tuple[int | str, ...], root: type[BaseModel]) -> str:
    """What belongs to a key that is missing."""
    field = _tables_at(loc[:-1], root)[0].model_fields[str(loc[-1])]
    measures = _measures_in(field.annotation, field.metadata)
    if measures:
        return measures[0].expected
    tags = [repr(arg).replace("'", '"') for arg in get_args(field.annotation) if isinstance(arg, str | int)]
    if tags:
        return "allowed: " + ", ".join(tags)
    if _models_in(field.annotation):
        return f"a table [{_key(loc)}] is expected"
    return (field.description or "a value is expected").rstrip(".")


def _measures_in(annotation: Any, metadata: Iterable[Any] = ()) -> list[Measure]:
    own = [entry for entry in metadata if isinstance(entry, Measure)]
    inner = getattr(annotation, "__metadata__", ())
    found = [entry for entry in inner if isinstance(entry, Measure)]
    return own + found + [m for argument in get_args(annotation) for m in _measures_in(argument)]


def _show(value: object) -> str:
    """A value much as it stands in the file, on one line and short."""
    try:
        if isinstance(value, str | bool | float | int | list):
            text = json.dumps(value, ensure_ascii=False, default=str)
        else:
            text = str(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, lists in lists in lists ...
        return "(too long to show)"
    text = "".join(c if c.isprintable() else "\ufffd" for c in text)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 4] + " ..."


_OF_KINDS = ("top", "terminal", "shape")
"""Tables of several kinds."""
_KINDS = frozenset(tag for key in _OF_KINDS for tag in _all_tags(key))
