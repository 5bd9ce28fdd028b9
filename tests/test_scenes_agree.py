"""Every shipped scene, end to end: FMI 2 and 3, Co-Simulation and Model Exchange, against the dense oracle.

Five answers that share no integrator and no equations of motion with each other: the FMU's own solver under
two versions of FMI, CVode on the FMU's derivatives, and the dissertation's dense matrices under scipy's DOP853.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import cablefmu
from cablefmu.cable import Floats
from cablefmu.reference import Trajectory, integrate
from cablefmu.scene import Scene, load_scene, shipped_scenes

POSITIONS = ("x_c", "y_c", "y_m1", "x_m1")
AGREEMENT = 1e-5
"""[m] over the whole run. Measured: 5e-8 m at most, but for load-lift-80."""

FORCES = ("F_1x", "F_1y", "F_2x", "F_2y")
FORCE_AGREEMENT = 1e-6
"""On vessels, of the largest over the whole run: where both ends are given, the motion shows in nothing else.
Measured: 2e-8."""

CS_TOLERANCE, ME_TOLERANCE = 1e-8, 1e-10
"""The FMU's solver; CVode, whose BDF lets more error pass for the same tolerance (8e-7 m at 1e-9)."""

EVERY = 5
"""The oracle ends a step on every fifth output time: it costs more than the four FMU runs together."""

HORIZON = {"load-lift-80": 0.7}
"""[s] Until when two starts that differ by 1e-9 rad agree, where that is shorter than the run.

The lift pushes the straight hanging cable together: it buckles, and what decides how is the smallest error."""


def _apart(names: tuple[str, ...], one: Mapping[str, Any], other: Mapping[str, Any], every: int = 1) -> Floats:
    """Largest distance in those outputs that there are, per output time; `other` has only every so many of them."""
    present = [np.abs(np.asarray(one[name])[::every] - np.asarray(other[name])) for name in names if name in one]
    return np.asarray(np.max(present, axis=0))


def _oracle(scene: Scene, times: Floats) -> Trajectory:
    breaks = [t for signal in scene.signals.values() for t in signal.breaks(0.0, scene.stop_time)]
    return integrate(
        scene.cable,
        lambda t: {name: signal(t) for name, signal in scene.signals.items()},
        times,
        breaks=breaks,
        rtol=1e-9,
        atol=1e-10,
    )


LONG = {"floaters-restrained-80", "load-lift-80", "seabed-mass-110"}
"""Under CVode or by the dense model, 20 to 70 s."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in LONG)) for name in shipped_scenes()]
)
def test_every_way_to_run_a_scene_gives_the_same_motion(name: str) -> None:
    scene = load_scene(name)
    runs = {
        (fmi, interface): cablefmu.simulate(scene, fmi=fmi, interface=interface, tolerance=tolerance)
        for fmi in (2, 3)
        for interface, tolerance in (("cs", CS_TOLERANCE), ("me", ME_TOLERANCE))
    }
    times = runs[2, "cs"]["time"].values[::EVERY]
    oracle = _oracle(scene, times).outputs
    known = times <= HORIZON.get(name, np.inf)
    largest = max((np.max(np.abs(oracle[name])) for name in FORCES if name in oracle), default=0.0)
    for (fmi, interface), run in runs.items():
        apart = _apart(POSITIONS, run, oracle, EVERY)
        assert np.max(apart[known]) < AGREEMENT, f"FMI {fmi}, {interface}"
        if largest:
            assert np.max(_apart(FORCES, run, oracle, EVERY)[known]) < FORCE_AGREEMENT * largest, (
                f"FMI {fmi}, {interface}"
            )


@pytest.mark.parametrize("name", shipped_scenes())
def test_the_horizon_is_where_two_slightly_different_starts_part(name: str) -> None:
    scene = load_scene(name)
    nudge = 1e-9 * np.random.default_rng(1).standard_normal(scene.cable.n)
    angles = scene.cable.angles_in(scene.cable.position) + nudge
    start = {f"theta[{i}]": angle for i, angle in enumerate(angles.tolist(), 1)}
    one = cablefmu.simulate(scene, tolerance=1e-11)
    other = cablefmu.simulate(scene, tolerance=1e-11, parameters=start)
    apart = _apart(POSITIONS, one, other)
    times = one["time"].values
    assert np.max(apart[times <= HORIZON.get(name, np.inf)]) < AGREEMENT
    if name in HORIZON:
        beyond = times[np.argmax(apart > AGREEMENT)]
        assert beyond == pytest.approx(HORIZON[name] + scene.step), "the stated horizon is the last time they agree"
