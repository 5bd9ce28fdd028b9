"""What moves, taken from a result: the cable's nodes over time, what is at its ends, and the numbers to show beside."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from ..along import node_positions
from ..cable import Floats
from ..errors import OptionError

__all__ = ["Extent", "Motion", "Value", "check_number", "extent_of", "motion_of", "tension_range"]

_SHOWN = ("y_m1", "x_m1", "x_1", "y_1", "x_c", "y_c", "tension_top", "tension_end", "tension_max", "energy")
"""Outputs to show beside the picture, those of them that a result has."""
_AT_TOP = {"floater": "floater", "motion": "vessel"}
_AT_END = {"load": "load", "floater": "floater", "motion": "vessel"}
_PLACE_OF_TOP = {"floater": ("y_m1",), "vessel": ("x_1", "y_1")}
_COMMON = 0.995
"""Share of all tensions that colours tell apart; a single jerk would leave one colour for all the rest."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number over time."""

    name: str
    unit: str
    text: str
    """What it is."""
    values: Floats
    """Shape (times,)."""


@dataclass(frozen=True, slots=True)
class Motion:
    """One run, ready to be drawn. Frame: x to the right, y downward, origin at the rest position of the top joint."""

    name: str
    description: str
    source: str
    """Versions that made it."""
    time: Floats
    """Shape (times,) [s]."""
    x: Floats
    """Of P_0 ... P_n, shape (times, n + 1) [m]."""
    y: Floats
    tension: Floats | None
    """Pull in every link, shape (times, n) [N]."""
    values: tuple[Value, ...]
    top: str
    """What holds the cable: floater or vessel."""
    end: str
    """What is at its other end: load, anchor, floater or vessel."""
    in_water: bool
    """Whether there is a surface, at y = 0."""
    ended_early: str
    """Why the run ended before its time; empty if it did not."""


@dataclass(frozen=True, slots=True)
class Extent:
    """The rectangle that all of a motion stays in [m]."""

    left: float
    right: float
    top: float
    bottom: float


def motion_of(result: xr.Dataset, name: str) -> Motion:
    """What is drawn of a result.

    Parameters
    ----------
    result
        With `node_x` and `node_y` over (time, node), or link angles and where the top is; with `tension` over (time,
        link) for colours.
    name
        What it is called, on the page and in messages.

    Raises
    ------
    OptionError
        If it does not say where the nodes are, or not of a single moment.
    """
    scene = _scene(result)
    top = _AT_TOP.get(_kind(scene, "top"), "floater")
    if not _has_nodes(result, top):
        raise OptionError(
            f"{name}: this result does not say where the cable is; one is expected from "
            "`cablefmu run SCENE --record nodes tensions`"
        )
    time = result["time"].values.astype(float)
    if not time.size:
        raise OptionError(f"{name}: this result ends before its first row; there is nothing to show")
    x, y = node_positions(result)
    return Motion(
        name=name,
        description=str(result.attrs.get("summary", "")),
        source=str(result.attrs.get("source", "")),
        time=time,
        x=np.asarray(x, dtype=float),
        y=np.asarray(y, dtype=float),
        tension=np.asarray(result["tension"].values, dtype=float) if "tension" in result else None,
        values=tuple(_value(result, shown) for shown in _SHOWN if shown in result),
        top=top,
        end=_AT_END.get(_kind(scene, "terminal"), "anchor"),
        in_water="water" in scene,
        ended_early=str(result.attrs.get("ended_early", "")),
    )


def _has_nodes(result: xr.Dataset, top: str) -> bool:
    angles = "theta" in result and result["theta"].ndim == 2 and "link_length" in result.coords
    return {"node_x", "node_y"} <= set(result) or (angles and all(name in result for name in _PLACE_OF_TOP[top]))


def _scene(result: xr.Dataset) -> dict[str, Any]:
    """The scene's tables. Not validated again: only which kinds of ends it has is asked."""
    try:
        return tomllib.loads(str(result.attrs.get("scene", "")))
    except tomllib.TOMLDecodeError:
        return {}


def _kind(scene: dict[str, Any], end: str) -> str:
    table = scene.get(end)
    return str(table.get("kind", "")) if isinstance(table, dict) else ""


def _value(result: xr.Dataset, name: str) -> Value:
    attributes = result[name].attrs
    text = str(attributes.get("long_name", ""))
    return Value(name, str(attributes.get("units", "")), text, result[name].values.astype(float))


def check_number(motions: Sequence[Motion]) -> None:
    """One run, or two.

    Raises
    ------
    OptionError
        If there are none, or more.
    """
    if len(motions) not in (1, 2):
        raise OptionError(f"view: one result is expected, or two in one picture, not {len(motions)}")


def extent_of(motions: Sequence[Motion]) -> Extent:
    """The rectangle around all nodes of all times, and the surface if there is one."""
    surface = [0.0] * any(motion.in_water for motion in motions)
    return Extent(
        left=min(float(motion.x.min()) for motion in motions),
        right=max(float(motion.x.max()) for motion in motions),
        top=min([float(motion.y.min()) for motion in motions] + surface),
        bottom=max([float(motion.y.max()) for motion in motions] + surface),
    )


def tension_range(motions: Sequence[Motion]) -> tuple[float, float] | None:
    """Least and largest tension that have a colour of their own [N]; None where no run has tensions.

    Above the larger one lies one value in two hundred.
    """
    known = [motion.tension.ravel() for motion in motions if motion.tension is not None]
    if not known:
        return None
    everything = np.concatenate(known)
    low, high = float(everything.min()), float(np.quantile(everything, _COMMON))
    return low, high if high > low else low + 1.0
