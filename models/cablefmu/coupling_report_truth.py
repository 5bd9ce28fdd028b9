"""What coupled runs are measured against, and how good that is.

Where a coupling is a vessel with the cable that it moves, both in one FMU at a tight tolerance, checked by the dense
reference model under scipy, which shares no code with it. Else the finest runs of the coupling itself, extrapolated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from .cable import Floats
from .coupling.run import run_system
from .coupling.system import System, varied
from .coupling_report_whole import NAMES, NotOneError, whole_scene
from .errors import RunError
from .reference import integrate
from .report_reference import DENSE_LINKS
from .scene import Scene
from .simulate import simulate

__all__ = ["GRID", "Truth", "find_truth", "positions_of"]

GRID = 16
"""Parts of the file's step that the truth is known at; a cubic spline between them is for steps that vary."""
TOLERANCE = 1e-10
"""Of the FMU of the whole; a hundredth of what the FMUs of a coupling have by default."""
_DENSE_TIMES = 17
"""At so many times the dense model is asked; each ends a step."""
_FINEST = 16
"""Parts of the file's step in the finest run, where runs are extrapolated."""
_ORDER = 3
"""Of iterated and Gauss-Seidel steps with quadratic inputs."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Positions over time that are as right as can be had."""

    times: Floats
    """[s], shape (m,)"""
    positions: Mapping[str, Floats]
    """By the outputs' names, each of shape (m,) [m]"""
    good_to: float
    """Largest distance from what it was checked by [m]"""
    words: str
    """What it is, and what it was checked by"""
    is_whole: bool
    """Whether nothing in it was coupled"""

    @property
    def motion(self) -> float:
        """Of the coordinate that moves most, from its least to its largest value [m]."""
        return max(float(np.ptp(values)) for values in self.positions.values())

    def at(self, times: Floats) -> dict[str, Floats]:
        """Positions at other times [m]."""
        return {name: CubicSpline(self.times, values)(times) for name, values in self.positions.items()}


def positions_of(system: System) -> list[str]:
    """Outputs in metres, as results call them."""
    found = [
        f"{name}.{output}" for name, model in system.models.items() for output in model.names("output")
        if (unit := model.unit(output)) is not None and unit.name == "m"
    ]  # fmt: skip
    if not found:
        raise RunError(f"{system.coupling.name}: no model has an output in m, in which errors are measured")
    return found


def find_truth(system: System) -> Truth:
    """The best that there is for a coupling.

    Raises
    ------
    RunError
        If there is none.
    """
    try:
        scene, vessel, cable = whole_scene(system)
    except NotOneError as reason:
        return _extrapolated(system, str(reason))
    return _whole(system, scene, vessel, cable)


def _whole(system: System, scene: Scene, vessel: str, cable: str) -> Truth:
    wanted = set(positions_of(system))
    names = {f"{vessel}.{to}": output for output, to in NAMES.items()}
    names |= {f"{cable}.{output}": output for output in ("x_c", "y_c") if f"{cable}.{output}" in wanted}
    settings = system.settings

    def run(tolerance: float) -> xr.Dataset:
        return simulate(
            scene, stop_time=settings.stop_time, step=settings.step / GRID, tolerance=tolerance, record=list(NAMES)
        )

    fine = run(TOLERANCE)
    times = fine["time"].values
    positions = {name: fine[output].values for name, output in names.items()}
    what = f"vessel and cable in one FMU at tolerance {TOLERANCE:g}"
    if scene.cable.n > DENSE_LINKS:
        coarse = run(10.0 * TOLERANCE)
        off = max(float(np.abs(coarse[output].values - positions[name]).max()) for name, output in names.items())
        return Truth(times, positions, off, f"{what}, against itself at {10.0 * TOLERANCE:g}", True)
    chosen = np.unique(np.linspace(0, len(times) - 1, _DENSE_TIMES).round().astype(int))
    held = {name: signal(0.0) for name, signal in scene.signals.items()}
    dense = integrate(scene.cable, lambda _: held, times[chosen])
    off = max(float(np.abs(dense.outputs[output] - positions[name][chosen]).max()) for name, output in names.items())
    return Truth(times, positions, off, f"{what}, against the dense NumPy model under scipy's DOP853", True)


def _extrapolated(system: System, reason: str) -> Truth:
    """Two fine runs, and what their difference says of the limit, by Richardson."""
    algorithm = "iterated" if system.can_repeat else "gauss-seidel"
    step = system.settings.step / _FINEST
    fine, coarse = (
        run_system(varied(system, algorithm=algorithm, extrapolation=2, step=h, adaptive=None))
        for h in (step, 2.0 * step)
    )
    common = coarse["time"].values
    positions, off = {}, 0.0
    for name in positions_of(system):
        both = np.interp(common, fine["time"].values, fine[name].values)  # times of one are times of the other
        correction = (both - coarse[name].values) / (2.0**_ORDER - 1.0)
        positions[name] = both + correction
        off = max(off, float(np.abs(correction).max()))
    words = f"{algorithm} runs with quadratic inputs at {step:g} and {2.0 * step:g} s, extrapolated"
    return Truth(common, positions, off, f"{words}; no scene is the whole: {reason}", False)
