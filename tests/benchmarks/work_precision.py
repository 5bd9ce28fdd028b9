"""Error against CPU time of one scene: our solver, and others on the same right-hand side.

timing-120, ten seconds. CVode (FMPy's, BDF with a dense differenced Jacobian) drives the FMU; ours and scipy's
integrators run on the kernel, the latter through Python call-backs.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import cablefmu
from cablefmu.cable import Floats
from cablefmu.scene import Scene, load_scene
from tests.kernel.library import Kernel, compile_kernel, inputs_of, load

__all__ = ["rows"]

TOLERANCES = (1e-4, 3e-5, 1e-6, 1e-8)
Row = dict[str, float | str]


def terminal(scene: Scene, q: Floats) -> Floats:
    """(x_c, y_c) of q = (y_m, theta) [m]."""
    length, theta = scene.cable.links.length, q[1:]
    return np.array([np.sum(length * np.sin(theta)), q[0] + np.sum(length * np.cos(theta))])


def timed(call: Callable[[], Floats], rounds: int) -> tuple[float, Floats]:
    """CPU seconds, the best of some rounds, and what the call gives."""
    best, found = float("inf"), np.empty(0)
    for _ in range(rounds):
        begun = time.process_time()
        found = call()
        best = min(best, time.process_time() - begun)
    return best, found


def rows(name: str = "timing-120") -> list[Row]:
    """Per solver and tolerance: CPU seconds and error of the terminal at the end [m]."""
    scene = load_scene(name)
    with tempfile.TemporaryDirectory() as folder:
        kernel = Kernel(load(compile_kernel(Path(folder))), scene.cable)
        times = np.array([0.0, scene.stop_time])
        state = np.concatenate([scene.cable.position, scene.cable.velocity])
        u = inputs_of({})
        size = scene.cable.n + 1

        def own(tolerance: float) -> Floats:
            return terminal(scene, kernel.run(times, tolerance=tolerance)[-1].q)

        def by_scipy(method: str, tolerance: float) -> Floats:
            done = solve_ivp(
                lambda t, x: kernel.derivatives(np.ascontiguousarray(x), u),
                (0.0, scene.stop_time), state, method=method, rtol=tolerance, atol=tolerance,
            )  # fmt: skip
            return terminal(scene, done.y[:size, -1])

        def by_cvode(tolerance: float) -> Floats:
            end = cablefmu.simulate(scene, interface="me", tolerance=tolerance).isel(time=-1)
            return np.array([float(end.x_c), float(end.y_c)])

        exact = own(1e-12)
        solvers: dict[str, tuple[Callable[[float], Floats], int]] = {
            "cablefmu, explicit": (own, 5),
            "scipy DOP853 on the kernel": (lambda tolerance: by_scipy("DOP853", tolerance), 2),
            "scipy LSODA on the kernel": (lambda tolerance: by_scipy("LSODA", tolerance), 1),
            "CVode (FMPy) on the FMU": (by_cvode, 1),
        }
        found: list[Row] = []
        for solver, (call, rounds) in solvers.items():
            for tolerance in TOLERANCES:
                seconds, end = timed(lambda call=call, tolerance=tolerance: call(tolerance), rounds)  # type: ignore[misc]
                error = float(np.max(np.abs(end - exact)))
                found.append({"solver": solver, "tolerance": tolerance, "seconds": seconds, "error_m": error})
    return found
