"""The accelerations of a case's FMU beside the dense equation, at states of its own motion.

References by the own solver share the kernel's right-hand side, and what the FMU's resource says, with the run that
they judge. So that is compared by itself: `SPOTS` states of the motion, the start and the end among them, are put into
the FMU (Model Exchange), and its accelerations may differ from those of the dissertation's matrices in long doubles by

    MULTIPLE (what rounding the state to doubles changes + what rounding its forces and torques does to a link alone)

all in m/s^2, a link's as that of one end about the other. The first counts where large forces cancel: near rest, or
against a spring of 1e10 N/m. The second, epsilon l (torque + l R) / I, counts where a light or short link hangs in a
heavy cable: what acts on it would give it a million times the acceleration that it has, and the kernel eliminates it
from there. Without extremes it is all some 1e-9 of the largest acceleration or less.
"""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract

from .cable import Cable, Floats
from .drive import Fmi2ModelExchange, Fmi3ModelExchange
from .feed import Feed
from .fmu.archive import Archive, open_fmu
from .reference import Reference
from .reference.long_double import long_double_acceleration
from .scene import Scene
from .simulate import simulate

__all__ = ["MOST_LINKS", "MULTIPLE", "SPOTS", "acceleration_share"]

SPOTS = 5
MULTIPLE = 1000.0
MOST_LINKS = 120
"""Beyond, the dense equation takes too long."""

_EPSILON = float(np.finfo(float).eps)


def acceleration_share(scene: Scene, fmu: Path) -> float:
    """Largest error of an acceleration at any spot, over what is allowed there.

    Parameters
    ----------
    scene, fmu
        What is in the FMU, and the FMU.

    Raises
    ------
    RunError
        If the FMU could not go on.
    """
    motion = simulate(fmu, step=scene.stop_time / (SPOTS - 1), record=["y_m1", "theta", "v_m1", "omega"])
    states = np.column_stack([motion[name].transpose("time", ...) for name in ("y_m1", "theta", "v_m1", "omega")])
    forces = [{name: signal(t) for name, signal in scene.signals.items()} for t in motion["time"].values]
    found = _accelerations(open_fmu(fmu), states, forces)
    half = scene.cable.n + 1
    spots = zip(states, forces, found, strict=True)
    return max(_share(scene.cable, x[:half], x[half:], inputs, a) for x, inputs, a in spots)


def _accelerations(archive: Archive, states: Floats, forces: list[dict[str, float]]) -> Floats:
    """What the FMU says, a row per state, shape (spots, n + 1) [m/s^2, rad/s^2]."""
    kinds: dict[int, type[Fmi2ModelExchange | Fmi3ModelExchange]] = {2: Fmi2ModelExchange, 3: Fmi3ModelExchange}
    half = states.shape[1] // 2
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        extract(str(archive.path), unzipdir=folder)
        driver = kinds[archive.fmi](archive.description, folder, Feed(dict(archive.scene.signals)))
        names = ["der(v_m1)", *(f"der(omega[{i}])" for i in range(1, half))]
        references = [driver.reference[name] for name in names]
        found = []
        try:
            driver.start(0.0, 1.0, 1e-6, {}, {})
            for x, inputs in zip(states, forces, strict=True):
                driver.set_inputs([inputs[name] for name in driver.feed.names])
                row = np.ascontiguousarray(x)
                driver.fmu.setContinuousStates(row.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), len(row))
                found.append(driver.get(references))
        finally:
            driver.close()
    return np.array(found)


def _share(cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float], found: Floats) -> float:
    arms = np.concatenate([[1.0], cable.links.length])

    def largest(accelerations: Any) -> float:
        return float(np.max(np.abs(arms * accelerations)))

    exact = long_double_acceleration(cable, q, v, inputs)
    rng, rounded = np.random.default_rng(1), 0.0
    for _ in range(2):
        one, other = (
            np.asarray(x, np.longdouble) + _EPSILON * (1.0 + np.abs(x)) * rng.standard_normal(len(x)) for x in (q, v)
        )
        rounded = max(rounded, largest(long_double_acceleration(cable, one, other, inputs) - exact))
    error = largest(found - exact)
    if error == 0.0:
        return 0.0
    allowed = MULTIPLE * (rounded + _EPSILON * _alone(cable, q, v, inputs))
    return error / allowed if allowed > 0.0 and np.isfinite(error) else np.inf


def _alone(cable: Cable, q: Floats, v: Floats, inputs: Mapping[str, float]) -> float:
    """The largest acceleration that a link would have if each of its forces and torques acted on it alone [m/s^2]."""
    links = cable.links
    turned, turning = (np.diff(x[1:], prepend=0.0) for x in (q, v))
    torque = np.abs(links.joint_stiffness * turned) + np.abs(links.joint_damping * turning)
    torque[:-1] += torque[1:]
    pull = np.max(np.hypot(*Reference(cable).joint_forces(q, v, inputs).T))
    return float(np.max(links.length * (torque + links.length * pull) / links.inertia))
