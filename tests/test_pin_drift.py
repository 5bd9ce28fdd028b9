"""A pinned FMU's end stays on its pin: to 1e-8 m if the FMU integrates, within the host's tolerance if it does."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

import cablefmu
from cablefmu.cable import Floats, Terminal
from tests.kernel.motions import make_scene

HEAVE = 'u_m1 = { signal = "sine", amplitude = "5 kN", frequency = "0.25 Hz" }'


def off_the_pin(interface: Literal["cs", "me"], tolerance: float) -> Floats:
    """Distance of P_n from its pin at every tenth of a second of a minute, from heave and angles [m], shape (601,)."""
    text = make_scene(Terminal.PIN, 12).text.replace("stop_time = 10.0", f"stop_time = 60.0\n[inputs]\n{HEAVE}")
    scene = cablefmu.Scene.from_text(text, name="pinned")
    run = cablefmu.simulate(scene, interface=interface, tolerance=tolerance, record=["theta"])
    theta, length = run["theta"].values, scene.cable.links.length
    x_0, y_0 = scene.cable.rest_position
    assert theta.shape == (601, 12) and np.ptp(run["y_m1"].values) > 0.5
    off = np.hypot(np.sin(theta) @ length - x_0, run["y_m1"].values + np.cos(theta) @ length - y_0)
    return np.asarray(off, dtype=float)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_an_fmu_that_integrates_holds_its_end(tolerance: float) -> None:
    assert off_the_pin("cs", tolerance).max() < 1e-8


def test_a_host_that_integrates_holds_it_within_its_tolerance() -> None:
    """CVode knows of no pin; what it lets slip comes back by itself, so that errors do not pile up."""
    for tolerance in (1e-6, 1e-8):
        off = off_the_pin("me", tolerance)
        assert off.max() < 100.0 * tolerance  # of angles over 240 m; measured: 9 and 17 times
        assert off[300:].max() < 3.0 * off[:300].max()
