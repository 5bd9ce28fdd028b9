"""From what is wrong with a coupling to lines for a person, all of one file in one error."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError

from ..errors import CouplingError
from ..scene_mistakes import Mistake, nearest
from . import schema

__all__ = ["coupling_error", "mistakes_of"]

_TABLES: dict[str, type[BaseModel]] = {
    "": schema.FileSpec, "coupling": schema.CouplingSpec, "iteration": schema.IterationSpec,
    "adaptive": schema.AdaptiveSpec, "model": schema.ModelSpec, "connection": schema.ConnectionSpec,
    "power": schema.PowerSpec,
}  # fmt: skip
_EXPECTED = {
    "string_type": "a text is expected",
    "bool_type": "true or false is expected",
    "model_type": "a table is expected",
    "dict_type": "a table is expected",
    "tuple_type": "a list is expected",
}
_PATTERNS = {
    "from": 'MODEL.OUTPUT is expected, for example "vessel.vx"',
    "to": 'MODEL.INPUT is expected, for example "cable.vx_1"',
    "flow": 'MODEL.OUTPUT is expected, for example "vessel.vx"',
    "effort": 'MODEL.OUTPUT is expected, for example "cable.F_1x"',
    "name": "a name of letters, digits, - and _ that begins with a letter is expected",
    "ports": 'MODEL or MODEL.TERMINAL is expected twice, for example ["vessel", "cable.floater_1"]',
}


def coupling_error(source: str, mistakes: Iterable[Mistake]) -> CouplingError:
    """All mistakes of one file in one error, a line each."""
    return CouplingError("\n".join(f"{source}: {mistake.line()}" for mistake in mistakes))


def mistakes_of(error: ValidationError) -> list[Mistake]:
    """What pydantic found; of a value of several allowed kinds the first refusal stands for all."""
    found: dict[str, Mistake] = {}
    for details in error.errors(include_url=False):
        if details["type"] == "too_short" and details["input"]:
            continue  # entries that were refused themselves do not count
        mistake = _mistake(dict(details))
        found.setdefault(mistake.key, mistake)
    return list(found.values())


def _mistake(details: dict[str, Any]) -> Mistake:
    location: tuple[int | str, ...] = details["loc"]
    key, value, kind = _key(location), details["input"], details["type"]
    names = [part for part in location if isinstance(part, str)]
    last = names[-1] if names else ""
    if "parameters" in names:
        return Mistake(key, "a number, true or false, or a text is expected", value)
    if location == ("model",) and kind in ("missing", "too_short"):
        return Mistake(key, "at least one table [[model]] is expected")
    if last == "ports":
        return Mistake(key, _PATTERNS[last], value)
    if kind == "missing":
        return Mistake(key, "this key is missing")
    if kind == "extra_forbidden":
        table = _TABLES[names[-2] if len(names) > 1 else ""]
        keys = [field.alias or name for name, field in table.model_fields.items()]
        return Mistake(key, f"unknown key; {nearest(last, keys)}", value)
    if kind == "literal_error":
        given = value if isinstance(value, str) else repr(value)
        return Mistake(
            key, nearest(given, re.findall(r"[\w-]+", details["ctx"]["expected"].replace(" or ", " "))), value
        )
    if kind == "string_pattern_mismatch":
        return Mistake(key, _PATTERNS[last], value)
    if kind in ("greater_than_equal", "less_than_equal", "int_type", "int_from_float"):
        expected = "0, 1 or 2" if last == "extrapolation" else "a whole number from 1 to 1000"
        return Mistake(key, f"{expected} is expected", value)
    return Mistake(key, _EXPECTED.get(kind, str(details["msg"])), value)


def _key(location: tuple[int | str, ...]) -> str:
    """Dotted key; tables of a list by their number."""
    parts: list[str] = []
    for part in location:
        if isinstance(part, int):
            parts[-1] += f" {part + 1}"
        elif parts and parts[-1].startswith("parameters"):
            parts.append(part)
            break  # the branches of a value's kinds
        else:
            parts.append(part)
    return ".".join(parts)
