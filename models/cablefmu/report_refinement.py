"""How many links are enough: the same continuous cable, cut into more and more of them.

What stays: length, mass, diameter and drag per length, bending stiffness, and what hangs at the ends. A joint stands
for the bending of one link's length, so its stiffness is EI / l, and its damping, which resists the rate of the
curvature (th_i - th_{i-1}) / l, goes the same way: c_i l = const. Not so the joint at the floater, which is no piece of
cable but what fastens it: its stiffness and damping stay. Made stiffer like the others, it would hold more energy the
more links there are wherever a start is bent there, and there would be no continuous cable to converge to.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from .assembly import assemble
from .cable import Cable, Floats, Links
from .errors import RunError
from .report_ladder import Said, order
from .report_runs import Course, distance, fmu_runs
from .scene import Scene
from .scene_mistakes import MistakeFoundError
from .scene_schema import AnglesShape, CableTable, WaterTable

__all__ = ["LINKS", "SHARES", "Refinement", "Step", "refined", "refinement", "unevenness"]

T = TypeVar("T", CableTable, WaterTable)

LINKS = (12, 15, 20, 30, 40, 60, 80, 120, 160, 240, 320, 480)
SHARES = (1e-2, 1e-3, 1e-4)
"""Errors for which the number of links is asked: of the cable's length, and of the largest tension."""

_TOLERANCE = 1e-8
"""Of the solver: its error is far below that of the coarsest and of the finest cable."""
_ORDERS = (0.5, 4.0)
"""Orders with which an extrapolation makes sense."""


@dataclass(frozen=True, slots=True)
class Step:
    """One number of links."""

    links: int
    position: float
    """Largest distance from the continuous cable's terminal (or floater) up to the horizon, over the length"""
    tension: float
    """Error of the largest tension, over that tension"""
    cpu_time: float
    """[s]"""


@dataclass(frozen=True, slots=True)
class Refinement:
    """Errors against the number of links."""

    steps: tuple[Step, ...]
    position_order: float | None
    """p of error ~ n^-p by least squares"""
    tension_order: float | None
    reference: str
    """What stands for the continuous cable"""
    finest: tuple[float, float]
    """Error of the finest cable: of the position over the length, of the largest tension over that"""
    enough_position: dict[float, int | None]
    """Share of `SHARES` -> least number of links that keeps it; None if none that was tried does"""
    enough_tension: dict[float, int | None]
    """The same for the largest tension"""
    note: str = ""
    """Why there is nothing, or less"""


def nothing(note: str) -> Refinement:
    """A refinement that could not be."""
    return Refinement((), None, None, "", (0.0, 0.0), {}, {}, note)


def unevenness(scene: Scene) -> str | None:
    """Why a scene's cable cannot be cut anew, None if it can."""
    for table in (scene.spec.cable, scene.spec.water):
        for key, value in dict(table or {}).items():
            if isinstance(value, tuple) and any(entry != value[0] for entry in value):
                return f"{key} differs from link to link"
    if isinstance(scene.spec.shape, AnglesShape):
        return "the start shape is given link by link"
    return None


def refined(scene: Scene, links: int) -> Scene:
    """The same continuous cable in so many links.

    Raises
    ------
    RunError
        If the cable is not even, or so few links cannot hang where the scene wants them.
    """
    reason = unevenness(scene)
    if reason is not None:
        raise RunError(f"{scene.name}: the cable cannot be cut anew: {reason}")
    spec, ratio = scene.spec, links / scene.spec.cable.links
    # of a link, hence shared out; of a joint, hence the stiffer the shorter what it stands for
    cable = _changed(spec.cable, {
        "link_length": 1.0 / ratio, "link_mass": 1.0 / ratio, "joint_stiffness": ratio, "joint_damping": ratio,
    })  # fmt: skip
    water = _changed(spec.water, {"drag_per_link": 1.0 / ratio}) if spec.water is not None else None
    spec = spec.model_copy(update={"cable": cable.model_copy(update={"links": links}), "water": water})
    try:
        return replace(scene, spec=spec, cable=_fastened(assemble(scene.name, spec, scene.signals), scene.cable.links))
    except MistakeFoundError as found:
        raise RunError(f"{scene.name} with {links} links: {found.mistake.text}") from None


def _fastened(cable: Cable, as_in: Links) -> Cable:
    """The cable with the first joint of another; where it differs from the rest, no parameter sets them all."""
    links = replace(
        cable.links,
        joint_stiffness=np.append(as_in.joint_stiffness[:1], cable.links.joint_stiffness[1:]),
        joint_damping=np.append(as_in.joint_damping[:1], cable.links.joint_damping[1:]),
    )
    joints = {"k_joint": links.joint_stiffness, "c_joint": links.joint_damping}
    uneven = {name for name, values in joints.items() if np.any(values != values[0])}
    return replace(cable, links=links, parameters={k: v for k, v in cable.parameters.items() if k not in uneven})


def _changed(table: T, factors: dict[str, float]) -> T:
    """Lists of equal entries as one number, and these numbers times their factors."""
    values: dict[str, Any] = {}
    for key, value in dict(table).items():
        value = value[0] if isinstance(value, tuple) else value
        values[key] = value * factors[key] if key in factors and value is not None else value
    return table.model_copy(update=values)


# --- errors against the number of links ---


def refinement(
    scene: Scene, horizon: float, limit: float, *, numbers: Sequence[int] = LINKS, say: Said = print
) -> Refinement:
    """Run a scene with 12 to 480 links and compare with what they converge to.

    Parameters
    ----------
    horizon
        Up to when courses are compared [s].
    limit
        CPU time of every run [s]; more links than the first that are too slow are not tried.
    numbers
        Of links, rising; the finest must come with a half and a quarter of it.
    """
    reason = unevenness(scene)
    if reason is not None:
        return nothing(f"the cable cannot be cut anew: {reason}")
    courses, note = _courses(scene, numbers, limit, say)
    finest = max(courses, default=0)
    if not all(links in courses for links in (finest // 2, finest // 4)):
        return nothing(note or "too few numbers of links ended")
    known = courses[finest].times <= horizon * (1.0 + 1e-9)
    length = float(np.sum(scene.cable.links.length))
    paths = {n: np.array([course.outputs[name][known] for name in _PLACES]) for n, course in courses.items()}
    peaks = {n: np.array([np.max(course.outputs["tension_max"][known])]) for n, course in courses.items()}
    place, peak = _errors_of(paths, lambda a, b: _off(a, b) / length), _errors_of(peaks, _relative)
    steps = tuple(Step(n, place.errors[n], peak.errors[n], courses[n].cpu_time) for n in courses if n <= finest // 2)
    inverse = [1.0 / step.links for step in steps]
    return Refinement(
        steps,
        order(inverse, [step.position for step in steps]),
        order(inverse, [step.tension for step in steps]),
        f"positions: {place.words}; largest tension: {peak.words}",
        (place.finest, peak.finest),
        _enough([(step.links, step.position + place.doubt) for step in steps]),
        _enough([(step.links, step.tension + peak.doubt) for step in steps]),
        note,
    )


_PLACES = ("x_c", "y_c", "y_m1")


def _courses(scene: Scene, numbers: Sequence[int], limit: float, say: Said) -> tuple[dict[int, Course], str]:
    """By number of links, the few first; and why some are missing."""
    courses: dict[int, Course] = {}
    note = ""
    for links in numbers:
        say(f"{links} links")
        try:
            with fmu_runs(refined(scene, links)) as runs:
                courses[links] = runs.run(tolerance=_TOLERANCE, limit=limit)
        except RunError as error:
            note = f"{links} links: {error}"
            if courses:
                break
    return courses, note


def _off(one: Floats, other: Floats) -> float:
    """Largest distance of two courses of (x_c, y_c, y_m1), shape (3, m) [m]."""
    return float(np.max(distance(dict(zip(_PLACES, one - other, strict=True)))))


def _relative(peak: Floats, other: Floats) -> float:
    return float(np.abs(peak - other)[0] / np.abs(other[0]))


@dataclass(frozen=True, slots=True)
class _Errors:
    """Of values by number of links, against what they converge to."""

    errors: dict[int, float]
    finest: float
    """Of the finest, as far as that can be known"""
    doubt: float
    """What the limit itself may be off by"""
    words: str


def _errors_of(values: Mapping[int, Floats], off: Callable[[Floats, Floats], float]) -> _Errors:
    """Against Richardson's extrapolation where the finest three that halve show an order, else against the finest.

    That one's own error is then taken as if its distance from half as many links fell with order 1/2.
    """
    n = max(values)
    fine, half, quarter = values[n], values[n // 2], values[n // 4]
    first, second = off(half, quarter), off(fine, half)
    found = float(np.log2(first / second)) if first > 0.0 and second > 0.0 else 0.0
    if not _ORDERS[0] <= found <= _ORDERS[1]:
        doubt = second / (2.0 ** _ORDERS[0] - 1.0)
        words = f"{n} links as they are, since {n // 4}, {n // 2} and {n} show no order"
        return _Errors({links: off(value, fine) for links, value in values.items()}, doubt, doubt, words)
    limit = fine + (fine - half) / (2.0**found - 1.0)
    words = f"{n // 2} and {n} links extrapolated with order {found:.2f}"
    return _Errors({links: off(value, limit) for links, value in values.items()}, off(fine, limit), 0.0, words)


def _enough(errors: Sequence[tuple[int, float]]) -> dict[float, int | None]:
    """Per share the least number of links from which on the error stays within it."""
    found: dict[float, int | None] = dict.fromkeys(SHARES)
    for share in SHARES:
        for links, error in sorted(errors, reverse=True):
            if error > share:
                break
            found[share] = links
    return found
