"""Floating bodies as meshes of their wetted hulls, for Capytaine. SI, z up, still water at z = 0."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import capytaine as cpt
import numpy as np
import numpy.typing as npt

DENSITY = 1000.0
"""Of the water of all shipped scenes [kg/m3]."""


@dataclass(frozen=True)
class Hull:
    """A body that floats, and meshes of it."""

    what: str
    mesh: Callable[[int], cpt.Mesh]
    """Of the wetted hull; the size of its panels falls with 1/n."""
    fineness: tuple[int, int, int]
    """The three n of a computation, rising."""
    lid: float | None
    """Size of the panels of the lid, times n [m]; None where all irregular frequencies lie above the band."""
    draft: float
    """[m]"""
    waterplane: float
    """[m2]"""
    volume: float
    """Displaced [m3]."""
    omega: npt.NDArray[np.float64]
    """Angular frequencies of a database, shape (k,) [rad/s]."""
    points: tuple[float, ...]
    """Where the elevation tells most of the force: distances fore and aft, beside the middle [m]."""


def revolved(profile: list[tuple[float, float]], around: int) -> cpt.Mesh:
    """A surface of revolution about z, of (radius, z) from the waterline down to the axis, in `around` sectors.

    Polygons inside circles would lose volume and waterplane; their radius is enlarged so that both are those of the
    circle.
    """
    sector = 2.0 * math.pi / around
    larger = math.sqrt(sector / math.sin(sector))
    angles = sector * np.arange(around)
    vertices = [(larger * r * math.cos(angle), larger * r * math.sin(angle), z) for r, z in profile for angle in angles]
    ahead = (np.arange(around) + 1) % around
    faces = [
        (ring * around + j, (ring + 1) * around + j, (ring + 1) * around + ahead[j], ring * around + ahead[j])
        for ring in range(len(profile) - 1)
        for j in range(around)
    ]
    return cpt.Mesh(vertices=np.array(vertices), faces=np.array(faces))


def cylinder(radius: float, draft: float) -> Callable[[int], cpt.Mesh]:
    """Meshes of a vertical truncated cylinder."""

    def mesh(n: int) -> cpt.Mesh:
        side = [(radius, -draft * k / n) for k in range(n)]
        return revolved([*side, *((radius * (1.0 - k / n), -draft) for k in range(n + 1))], 4 * n)

    return mesh


def hemisphere(radius: float) -> Callable[[int], cpt.Mesh]:
    """Meshes of half a sphere, centre in the still water."""

    def mesh(n: int) -> cpt.Mesh:
        angles = 0.5 * math.pi * np.arange(n + 1) / n
        return revolved([(radius * math.cos(a), -radius * math.sin(a)) for a in angles], 4 * n)

    return mesh


def box(length: float, width: float, draft: float) -> Callable[[int], cpt.Mesh]:
    """Meshes of a box, its length along the waves, with n/2 panels to the metre."""

    def mesh(n: int) -> cpt.Mesh:
        resolution = tuple(max(2, round(0.5 * n * size)) for size in (length, width, draft))
        return cpt.mesh_parallelepiped(
            size=(length, width, draft), center=(0.0, 0.0, -0.5 * draft), resolution=resolution, missing_sides={"top"}
        )

    return mesh


def _buoy() -> Hull:
    radius, mass = 1.2, 6000.0
    plane = math.pi * radius**2
    draft = mass / DENSITY / plane
    return Hull(
        f"vertical truncated cylinder, radius {radius} m, draft {draft:.4f} m", cylinder(radius, draft), (8, 12, 16),
        radius, draft, plane, mass / DENSITY, np.arange(1, 61) * 0.1, (0.6, 1.2),
    )  # fmt: skip


def _barge() -> Hull:
    length, width, draft = 16.0, 10.0, 2.0
    return Hull(
        f"box, {length} m along the waves, {width} m wide, draft {draft} m", box(length, width, draft), (2, 3, 4),
        None, draft, length * width, length * width * draft, np.arange(1, 43) * 0.05, (2.0, 5.0, 8.0),
    )  # fmt: skip


HULLS = {"buoy": _buoy(), "barge": _barge()}
"""What ships, by name; the buoy has the mass of the dissertation's floater."""
