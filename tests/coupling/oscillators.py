"""Two masses with a spring between them: two cables that hang straight, of one link each, which only heave.

A vertical link without motion across stays vertical exactly, so floater, link and load are one mass on the floater's
spring and damper. The whole is linear, and its motion known by a matrix exponential.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.linalg import expm

from cablefmu.cable import Floats
from cablefmu.coupling.description import Coupling
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.platforms import for_this_machine
from cablefmu.scene import Scene

_LINK = 7850.0 * math.pi * 0.01**2  # mass of one metre of cable [kg]
MASSES = (10.0 + _LINK + 1.0, 20.0 + _LINK + 1.0)
STIFFNESSES, DAMPINGS = (90.0, 120.0), (4.0, 6.0)
BETWEEN = 250.0  # N/m
STARTS = (0.3, -0.2)
STOP = 2.0

_SCENE = """
format = 1
description = "One link that hangs straight"
[cable]
links = 1
length = 1
diameter = 0.02
density = 7850
joint_stiffness = 10
joint_damping = 1
[top]
kind = "floater"
mass = {mass}
stiffness = {stiffness}
damping = {damping}
[terminal]
kind = "load"
mass = 1
[shape]
kind = "straight"
angle = 0
[run]
stop_time = 2
"""

_COUPLING = """
[coupling]
stop_time = 2
step = {step}
algorithm = "{algorithm}"
extrapolation = {extrapolation}
tolerance = 1e-11
{more}
[[model]]
name = "a"
fmu = "a-{fmi}.fmu"
parameters = {{ y_m1 = 0.3 }}
[[model]]
name = "b"
fmu = "b-{fmi}.fmu"
parameters = {{ y_m1 = -0.2 }}
[[model]]
name = "spring"
partner = "spring"
parameters = {{ stiffness = 250 }}
[[connection]]
from = "a.y_m1"
to = "spring.y_a"
[[connection]]
from = "a.v_m1"
to = "spring.v_a"
[[connection]]
from = "b.y_m1"
to = "spring.y_b"
[[connection]]
from = "b.v_m1"
to = "spring.v_b"
[[connection]]
from = "spring.F_a"
to = "a.u_m1"
[[connection]]
from = "spring.F_a"
to = "b.u_m1"
gain = -1
[[power]]
name = "a"
flow = "a.v_m1"
effort = "spring.F_a"
"""


def build_cables(folder: Path) -> Path:
    """Both cables as FMUs of both versions, into `folder`."""
    for name, mass, stiffness, damping in zip("ab", (10, 20), STIFFNESSES, DAMPINGS, strict=True):
        scene = Scene.from_text(_SCENE.format(mass=mass, stiffness=stiffness, damping=damping), name=name)
        for fmi in (2, 3):
            build_fmu(scene, folder / f"{name}-{fmi}.fmu", fmi=fmi, platforms=for_this_machine())
    return folder


def oscillators(
    folder: Path, *, step: float = 0.02, algorithm: str = "jacobi", extrapolation: int = 0, fmi: int = 2, more: str = ""
) -> Coupling:
    """The coupling of FMUs in `folder`; `more` goes below [coupling]."""
    text = _COUPLING.format(step=step, algorithm=algorithm, extrapolation=extrapolation, fmi=fmi, more=more)
    return Coupling.from_text(text, name="oscillators", folder=folder)


def error(result: xr.Dataset) -> float:
    """Largest distance of both masses from where they are exactly [m]."""
    found = np.column_stack([result["a.y_m1"].values, result["b.y_m1"].values])
    return float(np.abs(found - exact(result["time"].values)).max())


def exact(times: Floats) -> Floats:
    """Displacements of both masses, one row a time [m]."""
    stiffness = np.diag(STIFFNESSES) + BETWEEN * np.array([[1.0, -1.0], [-1.0, 1.0]])
    inverse = np.diag(1.0 / np.array(MASSES))
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ np.diag(DAMPINGS)]])
    start = np.array([*STARTS, 0.0, 0.0])
    return np.array([(expm(matrix * time) @ start)[:2] for time in times])
