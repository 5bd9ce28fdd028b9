"""Figures 6.1 to 6.17 of the dissertation, run anew: which scene each is of, its run, and how good that is."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from .along import node_positions
from .cable import Floats
from .errors import OptionError, RunError
from .scene import Scene, load_scene
from .simulate import simulate

__all__ = ["TIGHTER", "Error", "Exhibit", "Shown", "chosen", "exhibits", "show", "what_to_see"]

TIGHTER = 100.0
"""How many times tighter the tolerance is of the run that tells the error."""

VISIBLE = 1e-3
"""Error that a picture could begin to show [m]."""


@dataclass(frozen=True, slots=True)
class Exhibit:
    """One figure, as the table says."""

    number: str
    scene: str
    kind: str
    interval: float | None = None
    """Between two shapes [s]; none where there are no shapes."""
    names: tuple[str, ...] = ()
    """Of the variables that are drawn, where it is no picture of shapes."""
    note: str = ""


@dataclass(frozen=True, slots=True)
class Error:
    """Distance of the same point at the same time in a run at a tolerance that is `TIGHTER`."""

    largest: float
    """[m]"""
    visible_from: float | None
    """First output time at which it is beyond `VISIBLE` [s]"""


@dataclass(frozen=True, slots=True)
class Shown:
    """A figure and its run."""

    exhibit: Exhibit
    scene: Scene
    result: xr.Dataset
    error: Error | None
    """None where the tighter run did not come as far."""


@cache
def exhibits() -> tuple[Exhibit, ...]:
    """All figures, in the order of the print."""
    table = tomllib.loads((files("cablefmu") / "gallery.toml").read_text(encoding="utf-8"))
    return tuple(Exhibit(**{**row, "names": tuple(row.get("names", ()))}) for row in table["figure"])


def chosen(numbers: tuple[str, ...]) -> tuple[Exhibit, ...]:
    """Those with these numbers, in the order of the print; without any all of them.

    Raises
    ------
    OptionError
        If there is no such figure.
    """
    known = [exhibit.number for exhibit in exhibits()]
    for number in numbers:
        if number not in known:
            raise OptionError(f"figure {number}: there is none; {known[0]} to {known[-1]} are")
    return tuple(exhibit for exhibit in exhibits() if not numbers or exhibit.number in numbers)


def show(wanted: tuple[Exhibit, ...]) -> Iterator[Shown]:
    """Run what these figures are of, every scene once, and once more to tell its error."""
    seen: dict[str, Shown] = {}
    for exhibit in wanted:
        if exhibit.scene not in seen:
            scene = load_scene(exhibit.scene)
            result = _run(scene, scene.tolerance)
            seen[exhibit.scene] = Shown(exhibit, scene, result, _error(result, _run(scene, scene.tolerance / TIGHTER)))
        before = seen[exhibit.scene]
        yield Shown(exhibit, before.scene, before.result, before.error)


def _run(scene: Scene, tolerance: float) -> xr.Dataset:
    """A run that ends early is shown as far as it came."""
    try:
        return simulate(scene, tolerance=tolerance, record=["nodes", "theta"])
    except RunError as error:
        if not isinstance(error.partial, xr.Dataset):
            raise
        return error.partial


def _error(result: xr.Dataset, tighter: xr.Dataset) -> Error | None:
    if len(tighter["time"]) < len(result["time"]):
        return None
    (x, y), (other_x, other_y) = node_positions(result), node_positions(tighter)
    apart: Floats = np.hypot(x - other_x[: len(x)], y - other_y[: len(y)]).max(axis=1)
    beyond = np.flatnonzero(apart > VISIBLE)
    return Error(float(apart.max()), float(result["time"].values[beyond[0]]) if beyond.size else None)


def what_to_see(scene: Scene) -> str:
    """The paragraph of a scene file's comments that says what its run shows, without its heading; or nothing."""
    paragraphs: list[list[str]] = [[]]
    for line in scene.text.splitlines():
        if not line.startswith("#"):
            break
        words = line.removeprefix("#").strip()
        paragraphs[-1].append(words) if words else paragraphs.append([])
    texts = [" ".join(lines) for lines in paragraphs]
    return next((text.removeprefix(_HEADING) for text in texts if text.startswith(_HEADING)), "")


_HEADING = "What to see: "
