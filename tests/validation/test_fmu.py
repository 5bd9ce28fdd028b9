"""The same through the whole way from a scene file to results: FMUs of both versions, driven by a host."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu import simulate
from cablefmu.scene import Scene
from tests.validation.pendulum import ELLIPTIC
from tests.validation.sinking import DIAMETER, STEEL, depths

TOLERANCE = 1e-9
"""Of the solver"""
ADDS_UP = {"cs": 10.0, "me": 100.0}
"""How much of that a run may add up to: measured 4 for the FMU's own solver, 19 for CVode, whose multistep formulas
bound the error of a step, not of its neighbours."""

_CABLE = f"""
format = 1
description = "From a textbook"
[cable]
diameter = {DIAMETER}
density = {STEEL}
joint_stiffness = 0
joint_damping = 0
"""

_PENDULUM = """
links = 1
length = 3
[top]
kind = "floater"
mass = 1e15
stiffness = 0
damping = 0
[terminal]
kind = "load"
mass = 35
rotary_inertia = 4
[shape]
kind = "straight"
angle = "90 deg"
[run]
stop_time = 1
"""

_LEVEL = """
links = 12
length = 240
[top]
kind = "floater"
mass = 1e-12
stiffness = 0
damping = 0
static_load = 0
[terminal]
kind = "load"
mass = 1e-12
density = 7850
[water]
Cd = 1.0
[shape]
kind = "straight"
angle = "90 deg"
[run]
stop_time = 3
"""


@pytest.mark.parametrize("fmi", [2, 3])
def test_pendulum_from_90_degrees_hangs_straight_at_odd_quarters_of_the_elliptic_period(fmi: int) -> None:
    length, load, rotary = 3.0, 35.0, 4.0
    mass = STEEL * np.pi * DIAMETER**2 / 4.0 * length
    inertia = mass * length**2 / 3.0 + load * length**2 + rotary
    quarter = ELLIPTIC[90.0] * np.sqrt(inertia / ((mass / 2.0 + load) * length * 9.81))
    result = simulate(
        Scene.from_text(_CABLE + _PENDULUM, name="pendulum"),
        fmi=fmi, step=quarter, stop_time=7 * quarter, tolerance=TOLERANCE, record=["theta", "omega"],
    )  # fmt: skip
    angle, rate = result["theta"].values[1::2, 0], result["omega"].values[1::2, 0]
    assert len(angle) == 4
    assert np.abs(angle / rate).max() < ADDS_UP["cs"] * TOLERANCE


@pytest.mark.parametrize("interface", ["cs", "me"])
def test_level_cable_sinks_by_the_hyperbolic_tangent(interface: str) -> None:
    result = simulate(
        Scene.from_text(_CABLE + _LEVEL, name="level"), interface=interface, step=0.1, tolerance=TOLERANCE
    )
    depth, speed = depths(result["time"].values)
    assert np.abs(result["y_m1"].values - depth).max() < ADDS_UP[interface] * TOLERANCE
    assert np.abs(result["v_m1"].values - speed).max() < ADDS_UP[interface] * TOLERANCE
