"""Coupling files: from a TOML text to a `Coupling`, whose FMUs are not looked at yet."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import CouplingError
from ..files import is_path
from ..scene_mistakes import Mistake, nearest
from .mistakes import coupling_error, mistakes_of
from .schema import FileSpec

__all__ = ["Coupling", "load_coupling", "shipped_couplings"]

_NAME = re.compile(r"[A-Za-z0-9_-]+")
_LARGEST_FILE = 1_000_000


@dataclass(frozen=True, slots=True)
class Coupling:
    """One coupling: what its file says."""

    name: str
    """What results are called: of the file, or its stem."""
    text: str
    """The TOML as written."""
    source: str
    """What messages call it."""
    folder: Path
    """What paths in it are relative to."""
    spec: FileSpec

    @classmethod
    def from_text(cls, text: str, *, name: str, folder: Path | None = None, source: str | None = None) -> Coupling:
        """Make a coupling from a text in memory.

        Parameters
        ----------
        text
            The TOML.
        name
            What it is called unless it says so itself: letters, digits, - and _.
        folder
            What paths in it are relative to; the present one by default.
        source
            What messages call it; `name`.toml by default.

        Raises
        ------
        CouplingError
            With one line for every mistake that shows without its FMUs.
        """
        source = source or f"{name}.toml"
        try:
            data = tomllib.loads(text)
        except (ValueError, RecursionError) as error:
            raise CouplingError(f"{source}: this is not valid TOML: {error}") from None
        try:
            spec = FileSpec.model_validate(data, strict=False)
        except ValidationError as error:
            raise coupling_error(source, mistakes_of(error)) from None
        name = spec.coupling.name or name
        mistakes = [
            Mistake(f"model {k + 1}.name", "another model has this name; once is allowed", model.name)
            for k, model in enumerate(spec.model)
            if model.name in [before.name for before in spec.model[:k]]
        ]
        adaptive = spec.coupling.adaptive
        if adaptive and adaptive.smallest > adaptive.largest:
            text = f"at most largest = {adaptive.largest:g} s is expected"
            mistakes.append(Mistake("coupling.adaptive.smallest", text, adaptive.smallest))
        if not _NAME.fullmatch(name):
            mistakes.append(Mistake("", f'"{name[:60]}" cannot name a coupling: letters a to z, digits, - and _ can'))
        if mistakes:
            raise coupling_error(source, mistakes)
        return cls(name, text, source, folder or Path(), spec)


def shipped_couplings() -> list[str]:
    """Names of the couplings that ship."""
    return sorted(entry.name.removesuffix(".toml") for entry in _shipped().iterdir() if entry.name.endswith(".toml"))


def load_coupling(name_or_path: str | Path) -> Coupling:
    """Load a coupling that ships, by its name, or a TOML file, by its path.

    Parameters
    ----------
    name_or_path
        What ends in .toml or has a folder in it is a path, everything else a name.

    Raises
    ------
    CouplingError
        If there is no such coupling, or with one line for every mistake that shows without its FMUs.
    """
    asked = str(name_or_path)
    if not is_path(name_or_path):
        if asked not in shipped_couplings():
            known = nearest(asked, shipped_couplings())
            raise CouplingError(f'no coupling "{asked[:60]}" ships; {known}; or give the path of a .toml file')
        return Coupling.from_text((_shipped() / f"{asked}.toml").read_text(encoding="utf-8"), name=asked)
    path = Path(name_or_path)
    try:
        if not path.is_file():
            raise CouplingError(f"{path}: there is no such file")
        if path.stat().st_size > _LARGEST_FILE:
            raise CouplingError(f"{path}: is larger than {_LARGEST_FILE // 1_000_000} MB")
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise CouplingError(f"{path}: cannot be read: {error}") from None
    return Coupling.from_text(text, name=path.stem, folder=path.parent, source=asked)


def _shipped() -> Any:
    return resources.files("cablefmu") / "couplings"
