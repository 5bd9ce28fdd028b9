"""Others' integrators on the same equations: scipy's on the kernel's right-hand side and on the dense reference's."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from .cable import Floats
from .errors import RunError
from .kernel import KernelModel
from .reference import Reference, integrate
from .report_runs import OUTPUTS, Course, TooSlowError, course, output_times
from .scene import Scene

__all__ = ["SCIPY", "dense_course", "scipy_course"]

SCIPY: tuple[Any, ...] = ("DOP853", "Radau", "LSODA")
"""Methods of `scipy.integrate.solve_ivp` that are compared with."""

_DENSE_RTOL, _DENSE_ATOL = 1e-10, 1e-12
_DENSE_TIMES = 32
"""At so many times at most a step of the dense reference ends: each costs one."""


def scipy_course(scene: Scene, method: Any, tolerance: float, limit: float = float("inf")) -> Course:
    """Integrate the kernel's right-hand side from one jump of the forces to the next.

    Parameters
    ----------
    method, tolerance
        As for `solve_ivp`, rtol = atol = tolerance as in the FMU; output times come of the method's dense output.
    limit
        CPU time that it may take [s].

    Raises
    ------
    RunError
        If it gave up; `TooSlowError` if it took too long.
    """
    model, times = KernelModel(scene.cable), output_times(scene)
    state = np.concatenate([scene.cable.position, scene.cable.velocity])
    found = [state]
    begun = clock.process_time()
    right_side = _RightSide(scene, model, begun + limit, limit)
    marks = [0.0, *breaks_of(scene), scene.stop_time]
    for start, stop in pairwise(marks):
        right_side.stop = stop
        inside = times[(times > start) & (times <= stop)]
        asked = inside if inside.size and inside[-1] == stop else np.append(inside, stop)
        piece = solve_ivp(right_side, (start, stop), state, method=method, rtol=tolerance, atol=tolerance, t_eval=asked)
        if not piece.success or not np.all(np.isfinite(piece.y)):
            raise RunError(f"{method} gave up: {piece.message}")
        state = piece.y[:, -1]
        found += list(piece.y.T[: len(inside)])
    cpu_time = clock.process_time() - begun
    rows = [_outputs(scene, model, float(t), x) for t, x in zip(times, found, strict=True)]
    return course(times, np.array(rows), cpu_time, rhs=right_side.count)


class _RightSide:
    """f(t, x) before `stop`, where a force may jump; counts and watches the clock."""

    def __init__(self, scene: Scene, model: KernelModel, deadline: float, limit: float) -> None:
        self._scene, self._model, self._deadline, self._limit = scene, model, deadline, limit
        self.stop, self.count = scene.stop_time, 0

    def __call__(self, t: float, x: Floats) -> Floats:
        self.count += 1
        if clock.process_time() > self._deadline:
            raise TooSlowError(f"more than {self._limit:g} s of CPU time", time=t)
        before = float(np.nextafter(self.stop, -np.inf))
        return self._model.derivatives(x, self._model.forces(inputs_at(self._scene, min(t, before))))


def breaks_of(scene: Scene) -> list[float]:
    """Times inside the run at which a force or its slope jumps [s]."""
    return sorted({t for signal in scene.signals.values() for t in signal.breaks(0.0, scene.stop_time)})


def inputs_at(scene: Scene, time: float) -> dict[str, float]:
    """Forces by name [N]."""
    return {name: signal(time) for name, signal in scene.signals.items()}


def _outputs(scene: Scene, model: KernelModel, time: float, x: Floats) -> list[float]:
    values: Mapping[str, float] = model.outputs(x, model.forces(inputs_at(scene, time)))
    return [values[name] for name in OUTPUTS]


# --- the dense reference ---


class _Watched(Reference):
    """The reference model with an eye on the clock."""

    deadline, limit = float("inf"), float("inf")

    def acceleration(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> Floats:
        if clock.process_time() > self.deadline:
            raise TooSlowError(f"more than {self.limit:g} s of CPU time")
        return super().acceleration(q, v, inputs)


def dense_course(scene: Scene, limit: float = float("inf")) -> Course:
    """The dissertation's dense matrices under DOP853, at some 30 of the output times.

    Raises
    ------
    RunError
        If the integrator gave up; `TooSlowError` if it took more than `limit` [s of CPU time].
    """
    begun = clock.process_time()
    model = _Watched(scene.cable)
    model.deadline, model.limit = begun + limit, limit
    times = output_times(scene)
    every = -(-len(times) // _DENSE_TIMES)
    motion = integrate(
        model, lambda t: inputs_at(scene, t), np.union1d(times[::every], times[-1:]), breaks=breaks_of(scene),
        rtol=_DENSE_RTOL, atol=_DENSE_ATOL,
    )  # fmt: skip
    rows = np.array([motion.outputs[name] for name in OUTPUTS]).T
    return course(motion.times, rows, clock.process_time() - begun, rhs=0)
