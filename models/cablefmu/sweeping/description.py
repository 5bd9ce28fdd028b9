"""Sweep files: from a TOML text, and what options add to it, to a `Sweep` whose FMUs are not looked at yet."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import SweepError
from ..scene_mistakes import Mistake, mistakes_of
from .cases import Axes, axes_of
from .schema import FileSpec

__all__ = ["Sweep", "is_sweep_file", "make_sweep", "read_tables"]

_LARGEST_FILE = 1_000_000
_MARKS = ("scenes", "coupling", "grid", "list", "sample")
"""Keys of which a sweep file has one and no scene file has any."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """What is asked for."""

    name: str
    spec: FileSpec
    folder: Path
    """What paths in the file are relative to."""
    source: str
    """What messages call it."""
    axes: Axes


def is_sweep_file(name: str) -> bool:
    """Whether that is a TOML file of a sweep, and not one of a scene or a coupling."""
    if not name.endswith(".toml"):
        return False
    try:
        data = tomllib.loads(Path(name).read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return False  # whoever reads it as a scene says what is wrong
    return any(key in data for key in _MARKS) and "cable" not in data and not isinstance(data.get("coupling"), dict)


def read_tables(path: Path) -> dict[str, Any]:
    """What a sweep file says, unchecked.

    Raises
    ------
    SweepError
        If there is no such file, or it is not TOML.
    """
    try:
        if not path.is_file():
            raise SweepError(f"{path}: there is no such file")
        if path.stat().st_size > _LARGEST_FILE:
            raise SweepError(f"{path}: is larger than {_LARGEST_FILE // 1_000_000} MB")
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as error:
        raise SweepError(f"{path}: cannot be read: {error}") from None
    except (ValueError, RecursionError) as error:
        raise SweepError(f"{path}: this is not valid TOML: {error}") from None


def make_sweep(tables: Mapping[str, Any], *, name: str, folder: Path | None = None, source: str = "sweep") -> Sweep:
    """Check tables as a file has them.

    Parameters
    ----------
    tables
        The file's data, or the same put together from options.
    name
        What the sweep is called unless it says so itself.
    folder
        What paths in it are relative to; the present one by default.
    source
        What messages call it.

    Raises
    ------
    SweepError
        With one line for every mistake that shows without its scenes.
    """
    try:
        spec = FileSpec.model_validate(dict(tables), strict=False)
    except ValidationError as error:
        raise _error(source, [_worded(mistake) for mistake in mistakes_of(error, FileSpec)]) from None
    folder = folder or Path()
    axes, mistakes = axes_of(spec, folder)
    if mistakes:
        raise _error(source, mistakes)
    return Sweep(spec.name or name, spec, folder, source, axes)


def _worded(mistake: Mistake) -> Mistake:
    if mistake.key == "name":
        return Mistake("name", "letters, digits, - and _ are expected", mistake.value)
    if mistake.key == "sample.ranges" and mistake.value == {}:
        return Mistake("sample.ranges", "at least one range is expected, for example M_1 = [4000, 8000]")
    return mistake


def _error(source: str, mistakes: list[Mistake]) -> SweepError:
    return SweepError("\n".join(f"{source}: {mistake.line()}" for mistake in mistakes))
