"""Tensions where they are known in closed form, and what a heavy end costs them."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Terminal
from cablefmu.reference.extended import extended_outputs
from tests.kernel.cases import heavy_case
from tests.kernel.library import Kernel
from tests.random_cables import random_cable

HEAVY = (1e4, 1e6, 8e8, 1e12)
"""Anchor masses [kg]"""
EXACT = 1e-12
"""Error over the largest tension, against 50 digits: rounding. Measured: 2e-14, for any mass."""


def hanging(water: bool) -> tuple[Cable, float, float]:
    """A cable of 9 unequal links, its submerged weight and its load's [N]; static_load carries both."""
    cable = random_cable(np.random.default_rng(5), 9, Terminal.LOAD, water, drag=Drag.NONE)
    p = cable.parameters
    density = p.get("rho_w", 0.0)
    volume = p["m_c"] / p["rho_c"] if "rho_c" in p else p.get("V_c", 0.0)
    links = float(np.sum(cable.links.mass - density * cable.links.volume)) * p["g"]
    load = (p["m_c"] - density * volume) * p["g"]
    return replace(cable, parameters=p | {"static_load": links + load}), links, load


@pytest.mark.parametrize("water", [False, True])
def test_hanging_at_rest_carries_what_hangs_below(library: ctypes.CDLL, water: bool) -> None:
    cable, links, load = hanging(water)
    still = np.zeros(cable.n + 1)
    kernel = Kernel(library, cable)
    # rounding of sums of ten weights, over the floater's mass and as it stands
    rounding = 1e-14 * cable.parameters["g"]
    assert kernel.acceleration(still, still, {}) == pytest.approx(still, rel=0, abs=rounding)
    pulls = kernel.outputs(still, still, {})
    assert pulls["tension_top"] == pytest.approx(links + load, rel=1e-14)
    assert pulls["tension_max"] == pulls["tension_top"]
    assert pulls["tension_end"] == pytest.approx(load, rel=1e-13)


def test_upside_down_is_compression(library: ctypes.CDLL) -> None:
    """All links up: every link is pressed, the least, the load's weight, being the largest pull."""
    cable, links, load = hanging(False)
    still, up = np.zeros(cable.n + 1), np.concatenate([[0.0], np.full(cable.n, np.pi)])
    pulls = Kernel(library, cable).outputs(up, still, {})
    # pi in doubles tips the cable by 1e-16, and joint 1 is bent by a torque of k_1 pi
    assert pulls["tension_top"] == pytest.approx(-(links + load), rel=1e-12)
    assert pulls["tension_max"] == pulls["tension_end"] == pytest.approx(-load, rel=1e-12)


@pytest.mark.parametrize("mass", HEAVY)
def test_heavy_end_costs_no_digits(library: ctypes.CDLL, mass: float) -> None:
    for draw in range(3):
        c = heavy_case(library, mass, draw)
        found, exact = c.kernel.outputs(c.q, c.v, c.inputs), extended_outputs(c.cable, c.q, c.v, c.inputs)
        room = EXACT * abs(float(exact["tension_max"]))
        for name in ("tension_top", "tension_end", "tension_max"):
            assert found[name] == pytest.approx(float(exact[name]), rel=0, abs=room), name
