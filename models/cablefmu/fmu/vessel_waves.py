"""What the FMU of a vessel in waves holds of its hydrodynamics: filters that are fitted when it is built."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ..cable import Floats
from ..errors import VesselError
from ..hydrodynamics.database import Hydrodynamics
from ..hydrodynamics.excitation import Excitation, fit_excitation
from ..hydrodynamics.radiation import Radiation, fit_radiation
from ..vessel import ExcitationTable, FloatingTable, Vessel

__all__ = ["LARGEST_ERROR", "Filters", "fitted", "in_waves", "mass_of", "places_of"]

AXES = ("x", "y")
LARGEST_ERROR = 0.02
"""Of a filter, of the largest value of the curve that it stands for."""

Filters = tuple[tuple[Radiation, ...], tuple[Excitation, ...]]


def mass_of(vessel: Vessel) -> float:
    """What moves, without water [kg]."""
    body, table = _body(vessel), vessel.table
    return table.mass if isinstance(table, FloatingTable) and table.mass is not None else body.mass


def places_of(vessel: Vessel) -> tuple[float, ...]:
    """Where elevations are inputs, along x about the rest position [m]."""
    table = vessel.table
    assert isinstance(table, FloatingTable | ExcitationTable)
    return table.points if table.points is not None else tuple(_body(vessel).points.tolist())


def in_waves(vessel: Vessel) -> dict[str, Any]:
    """What the slave reads.

    Raises
    ------
    VesselError
        If a filter is too far from the coefficients.
    """
    body, points = _body(vessel), places_of(vessel)
    radiation, excitation = fitted(body, points)
    _check(vessel.name, radiation, excitation, points)
    return {
        "points": len(points),
        "added_mass": dict(zip(AXES, body.added_mass_at_infinity.tolist(), strict=True)),
        "hydrostatic": dict(zip(AXES, body.stiffness.tolist(), strict=True)),
        "radiation": {axis: _numbers(fit, "matrix", "velocity", "output") for axis, fit in _by_axis(radiation)},
        "excitation": {
            axis: _numbers(fit, "matrix", "elevations", "signals", "output") for axis, fit in _by_axis(excitation)
        },
    }  # fmt: skip


@lru_cache(maxsize=32)
def fitted(body: Hydrodynamics, points: tuple[float, ...]) -> Filters:
    """Filters of surge and heave; a body is fitted once in a process."""
    places: Floats = np.array(points)
    return _radiation(body), tuple(fit_excitation(body, places, axis) for axis in range(2))


@lru_cache(maxsize=32)
def _radiation(body: Hydrodynamics) -> tuple[Radiation, ...]:
    """The same wherever elevations are known."""
    memory = body.memory
    return tuple(fit_radiation(body.omega, memory[:, axis]) for axis in range(2))


def _body(vessel: Vessel) -> Hydrodynamics:
    assert vessel.hydrodynamics is not None
    return vessel.hydrodynamics


def _by_axis(fits: tuple[Any, ...]) -> list[tuple[str, Any]]:
    return list(zip(AXES, fits, strict=True))


def _numbers(fit: Radiation | Excitation, *names: str) -> dict[str, Any]:
    return {name: getattr(fit, name).tolist() for name in names}


def _check(
    name: str, radiation: tuple[Radiation, ...], excitation: tuple[Excitation, ...], points: tuple[float, ...]
) -> None:
    mistakes = [
        f"{name}: the memory of radiated waves along {axis} is met to {fit.error:.1%} only; at most "
        f"{LARGEST_ERROR:.0%} is expected: do the coefficients hold irregular frequencies?"
        for axis, fit in _by_axis(radiation) if fit.error > LARGEST_ERROR
    ] + [
        f"{name}: with elevations at {', '.join(f'{x:g}' for x in points)} m the force of waves along {axis} is met to "
        f"{fit.error:.1%} only; at most {LARGEST_ERROR:.0%} is expected: other or more points are needed"
        for axis, fit in _by_axis(excitation) if fit.error > LARGEST_ERROR
    ]  # fmt: skip
    if mistakes:
        raise VesselError("\n".join(mistakes))
