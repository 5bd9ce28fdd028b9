"""The file of a saved run: what the run was, and the state of its FMU.

One line that says what this is, one of JSON, the image that the FMU serialized, and the SHA-256 of all that.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from .drive import Driver
from .errors import OptionError, RunError, StateError
from .files import check_writable, replacing
from .scene import Scene

__all__ = ["SavedState", "check_saved", "check_saving", "hash_of", "read_state", "resume", "write_state"]

_TITLE = b"cablefmu state 1\n"
_CHECKSUM = 32
_NOT_TOLD = ("image", "source")
_KINDS = {"scene": str, "fmi": int, "arrays": bool, "time": float, "step": float, "tolerance": float, "given": dict}


@dataclass(frozen=True, slots=True)
class SavedState:
    """A Co-Simulation run at one of its communication points."""

    scene: str
    """SHA-256 of the scene file and of the files that it names."""
    fmi: int
    arrays: bool
    """Whether the FMU has arrays, and so its number of links as a parameter."""
    time: float
    """[s]"""
    step: float
    """Communication step [s]"""
    tolerance: float
    given: Mapping[str, float | str]
    """What was set before the run: inputs among it stay constant when the run goes on."""
    image: bytes
    source: str
    """The file, for messages."""


def hash_of(scene: Scene) -> str:
    """SHA-256 of the scene's text and of the files that it names: the same forces at the same times."""
    digest = hashlib.sha256(scene.text.encode())
    for name in sorted(scene.files):
        digest.update(b"\0" + name.encode() + b"\0" + hashlib.sha256(scene.files[name]).digest())
    return digest.hexdigest()


def write_state(path: Path, state: SavedState) -> None:
    """Write the file; it is complete before it takes the place of an old one.

    Raises
    ------
    OptionError
        If it cannot be written.
    """
    told = {key: value for key, value in asdict(state).items() if key not in _NOT_TOLD}
    content = _TITLE + json.dumps(told).encode() + b"\n" + state.image
    with replacing(path) as temporary:
        temporary.write_bytes(content + hashlib.sha256(content).digest())


def read_state(path: str | Path) -> SavedState:
    """Read a file that `write_state` wrote.

    Raises
    ------
    StateError
        If it is missing, is something else, or is damaged.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise StateError(f"{path}: cannot be read ({error.strerror or error})") from None
    if not content.startswith(_TITLE):
        raise StateError(f"{path}: is not a saved state; a file from `cablefmu run --save-state` is expected")
    body, checksum = content[:-_CHECKSUM], content[-_CHECKSUM:]
    told, newline, image = body.removeprefix(_TITLE).partition(b"\n")
    if hashlib.sha256(body).digest() != checksum or not newline:
        raise StateError(f"{path}: is damaged or was cut off; the run has to be saved again")
    return SavedState(**_checked(path, told), image=image, source=str(path))


def _checked(path: str | Path, told: bytes) -> dict[str, Any]:
    """The line of JSON; its checksum is right, so only another program could have written it otherwise."""
    try:
        values = json.loads(told)
    except ValueError:
        values = None
    expected = [field.name for field in fields(SavedState) if field.name not in _NOT_TOLD]
    in_order = isinstance(values, dict) and list(values) == expected
    if not (in_order and all(isinstance(values[name], _KINDS[name]) for name in expected)):
        raise StateError(f"{path}: was not written by `cablefmu run --save-state`")
    return dict(values)


_ONLY_CS = (
    "in Model Exchange CVode integrates, and what it remembers cannot be saved; "
    "Co-Simulation (interface = cs) is expected"
)


def check_saving(path: Path, interface: str) -> None:
    """Find out before the run whether its end can be saved there.

    Raises
    ------
    OptionError
        If the run is one of Model Exchange, or the file cannot be written.
    """
    if interface == "me":
        raise OptionError(f"save state = {path}: {_ONLY_CS}")
    check_writable(path)


def check_saved(
    saved: SavedState, scene: Scene, fmi: int, interface: str, tolerance: float | None,
    given: Collection[str], inputs: Collection[str], *, arrays: bool,
) -> None:  # fmt: skip
    """Whether a run of this scene can go on from there.

    Parameters
    ----------
    saved
        What was read.
    scene, fmi, interface, tolerance
        Of the run that is to go on; tolerance None where it was not given.
    given
        Names of what the user set besides.
    inputs
        Those among all names that are inputs of the FMU.
    arrays
        Whether the FMU has arrays, and so its number of links as a parameter.

    Raises
    ------
    StateError
        If the state is of something else.
    OptionError
        If something was given that is in the state already.
    """
    if interface == "me":
        raise OptionError(f"from state = {saved.source}: {_ONLY_CS}")
    if saved.scene != hash_of(scene):
        raise StateError(f"{saved.source}: was saved of another scene than {scene.name}, or before it was edited")
    if saved.fmi != fmi:
        raise StateError(f"{saved.source}: was saved of an FMU of version {saved.fmi}; this one is of version {fmi}")
    if saved.arrays != arrays:
        what = "with arrays; that FMU is expected in place of the scene" if saved.arrays else "without arrays"
        raise StateError(f"{saved.source}: was saved of an FMU {what}")
    if tolerance is not None:
        raise OptionError(f"tolerance = {tolerance}: it is in the state ({saved.tolerance}); leave it out")
    for name in given:
        if name not in inputs:
            raise OptionError(f"set {name}: it is in the state that the run goes on from; only inputs can be set")


def resume(driver: Driver, saved: SavedState) -> None:
    """Put the state into a fresh instance.

    Raises
    ------
    StateError
        If the FMU does not take it, in its own words.
    """
    try:
        driver.resume(saved.image)
    except RunError as error:
        raise StateError(f"{saved.source}: {error}") from None
