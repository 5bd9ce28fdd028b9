"""Scene files: from a TOML text to a `Cable` and the settings of its run.

A scene is a file of the user's or one of those that ship (`shipped_scenes`). Its text travels inside the FMU
that is made of it, together with the files that it names, so a scene can also be made from a text in memory.
Whatever is wrong with it is said at once, in one `SceneError`.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cablefmu.assembly import assemble
from cablefmu.cable import Cable
from cablefmu.errors import SceneError
from cablefmu.files import is_path
from cablefmu.scene_inputs import CsvInput, build_signal, with_derivatives
from cablefmu.scene_mistakes import Mistake, MistakeFoundError, mistakes_of, nearest, scene_error
from cablefmu.scene_schema import MAX_LINKS, Spec
from cablefmu.scene_table import Context
from cablefmu.signals import Constant, CsvError, Signal

__all__ = ["Scene", "load_scene", "shipped_scenes"]

_NAME = re.compile(r"[A-Za-z0-9_-]+")
_LARGEST_FILE = 100_000_000
# A picture shows about thirty shapes unless the scene says otherwise.
_FRAMES = 30


@dataclass(frozen=True, eq=False)
class Scene:
    """One scene: what its file says, and what that amounts to."""

    name: str
    """Stem of the file: letters, digits, - and _."""
    text: str
    """The TOML as written."""
    path: Path | None
    """Where it came from, None for a text in memory."""
    files: Mapping[str, bytes]
    """Content of the CSV files that it names, by the names it gives them."""
    spec: Spec
    cable: Cable
    signals: Mapping[str, Signal]
    """Every input of the cable over time [N; m, m/s, m/s^2]; constant at its start where the scene names none."""

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        name: str,
        files: Mapping[str, bytes] | None = None,
        source: str | None = None,
        path: Path | None = None,
    ) -> Scene:
        """Make a scene from a text in memory.

        Parameters
        ----------
        text
            The TOML.
        name
            Name of the scene: letters, digits, - and _.
        files
            Content of the CSV files that it names.
        source
            What messages call it; `name`.toml by default.
        path
            Where it came from.

        Raises
        ------
        SceneError
            With one line for every mistake.
        """
        known = dict(files or {})

        def read(file: str) -> bytes:
            if file not in known:
                raise CsvError("there is no such file")
            return known[file]

        return _make(text, name, source or f"{name}.toml", path, read)

    @property
    def description(self) -> str:
        """One line, for lists."""
        return self.spec.description

    @property
    def dropped_outputs(self) -> tuple[str, ...]:
        """Names of the outputs that the scene does without."""
        return self.spec.outputs.dropped

    @property
    def stop_time(self) -> float:
        """[s]"""
        return self.spec.run.stop_time

    @property
    def step(self) -> float:
        """Communication step and output interval [s]."""
        return self.spec.run.step

    @property
    def tolerance(self) -> float:
        """Relative tolerance of the solver."""
        return self.spec.run.tolerance

    @property
    def record(self) -> tuple[str, ...]:
        """What a run records beside the outputs."""
        return self.spec.run.record

    @property
    def frame_interval(self) -> float:
        """Between the shapes in a picture [s]."""
        given = self.spec.run.frame_interval
        return given if given is not None else self.stop_time / _FRAMES


def shipped_scenes() -> list[str]:
    """Names of the scenes that ship, sorted by kind and then by number of links."""
    files = (entry.name for entry in _shipped_folder().iterdir())
    return sorted((file.removesuffix(".toml") for file in files if file.endswith(".toml")), key=_by_size)


def _by_size(name: str) -> list[tuple[str, int]]:
    """Sort key with timing-20 before timing-100."""
    return [(word, int(digits or 0)) for word, digits in re.findall(r"(\D*)(\d*)", name)]


def load_scene(name_or_path: str | Path) -> Scene:
    """Load a scene that ships, by its name, or a TOML file, by its path.

    Parameters
    ----------
    name_or_path
        What ends in .toml or has a folder in it is a path, everything else a name.

    Raises
    ------
    SceneError
        If there is no such scene, or with one line for every mistake in it.
    """
    asked = str(name_or_path)
    if is_path(name_or_path):
        path = Path(name_or_path)
        text = _decode(_read_file(path, path.name), asked)
        return _make(text, path.stem, asked, path, lambda file: _read_beside(path, file))
    if asked not in shipped_scenes():
        known = nearest(asked, shipped_scenes())
        raise SceneError(f'no scene "{asked[:60]}" ships; {known}; or give the path of a .toml file')
    text = _decode((_shipped_folder() / f"{asked}.toml").read_bytes(), asked)
    return Scene.from_text(text, name=asked)


def _shipped_folder() -> Any:
    return resources.files("cablefmu") / "scenes"


# -------------------------------------------------------------------------------------------------- reading


def _read_file(path: Path, shown: str) -> bytes:
    """Content of a regular file of sensible size."""
    try:
        if not path.is_file():
            raise SceneError(f"{path}: there is no such file")
        if path.stat().st_size > _LARGEST_FILE:
            raise SceneError(f"{path}: {shown} is larger than {_LARGEST_FILE // 1_000_000} MB")
        return path.read_bytes()
    except (OSError, ValueError) as error:
        raise SceneError(f"{path}: cannot be read: {error}") from None


def _read_beside(scene: Path, file: str) -> bytes:
    try:
        return _read_file(scene.parent / file, file)
    except SceneError as error:
        raise CsvError(str(error).partition(": ")[2]) from None


def _decode(data: bytes, source: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneError(f"{source}: a text in UTF-8 is expected; byte {error.start} is not part of one") from None


def _parse(text: str, source: str) -> dict[str, Any]:
    try:
        data: dict[str, Any] = _bounded(tomllib.loads(text))
    except RecursionError:
        raise SceneError(f"{source}: this is not valid TOML for a scene: too deeply nested") from None
    except ValueError as error:
        raise SceneError(f"{source}: this is not valid TOML: {error}") from None
    return data


def _bounded(data: Any) -> Any:
    """Integers beyond TOML's 64 bits become infinite, as Python may refuse even to print them."""
    if isinstance(data, dict):
        return {key: _bounded(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_bounded(value) for value in data]
    return (math.inf if data > 0 else -math.inf) if isinstance(data, int) and abs(data) >= 2**63 else data


def _make(text: str, name: str, source: str, path: Path | None, read: Callable[[str], bytes]) -> Scene:
    """Parse, validate and assemble; every file is read once."""
    mistakes = []
    if not _NAME.fullmatch(name):
        mistakes.append(Mistake("", f'"{name[:60]}" cannot name a scene: letters a to z, digits, - and _ are allowed'))
    data = _parse(text, source)
    files: dict[str, bytes] = {}

    def remembered(file: str) -> bytes:
        if file not in files:
            files[file] = read(file)
        return files[file]

    try:
        spec = Spec.model_validate(data, context=Context(_link_count(data), remembered))
    except ValidationError as error:
        raise scene_error(source, mistakes + mistakes_of(error)) from None
    given = {key: build_signal(value, remembered) for key, value in dict(spec.inputs).items() if value is not None}
    given = with_derivatives(given)
    try:
        cable = assemble(name, spec, given)
    except MistakeFoundError as found:
        mistakes.append(found.mistake)
    if mistakes:
        raise scene_error(source, mistakes)
    named = {value.file for value in dict(spec.inputs).values() if isinstance(value, CsvInput)}
    signals = {key: given.get(key, Constant(cable.input_start.get(key, 0.0))) for key in cable.inputs}
    return Scene(name, text, path, {file: files[file] for file in sorted(named)}, spec, cable, signals)


def _link_count(data: Mapping[str, Any]) -> int | None:
    """Number of links if the file has a proper one, so that lists can be measured by it while all is read."""
    cable = data.get("cable")
    links = cable.get("links") if isinstance(cable, dict) else None
    proper = isinstance(links, int) and not isinstance(links, bool) and 1 <= links <= MAX_LINKS
    return links if proper else None
