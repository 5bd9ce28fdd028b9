"""Runs to be compared: one scene's FMU through FMPy with other settings each time, and what such a run leaves.

Where `simulate` makes a Dataset for people, a `Course` keeps what errors are measured in, and its price.
"""

from __future__ import annotations

import tempfile
import time as clock
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description

from .cable import Floats, Initial, Terminal, Top
from .drive import Driver, make_driver
from .errors import OptionError, RunError
from .feed import Feed
from .fmu.archive import build_fmu
from .fmu.platforms import for_this_machine
from .fmu.variables import variables_of
from .scene import Scene
from .scene_schema import OutputsTable
from .signals import Signal

__all__ = [
    "OUTPUTS",
    "SOLVERS",
    "Apart",
    "Course",
    "FmuRuns",
    "TooSlowError",
    "apart",
    "course",
    "distance",
    "fmu_runs",
    "is_measured",
    "output_times",
    "timed",
    "whole",
]

OUTPUTS = ("x_c", "y_c", "y_m1", "tension_top", "tension_max", "energy")
"""What a course keeps over time [m, N, J]."""

SOLVERS = ("explicit", "implicit", "automatic")
"""Methods of the FMU's own solver."""


class TooSlowError(RunError):
    """A run that took more CPU time than it was given."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """One run: its outputs over time, and what it cost."""

    times: Floats
    """[s], shape (m,)"""
    outputs: Mapping[str, Floats]
    """Of `OUTPUTS` by name, each of shape (m,)"""
    cpu_time: float = 0.0
    """[s], without building and unpacking the FMU"""
    rhs: int = 0
    """Right-hand sides"""
    steps: int = 0
    """Accepted steps"""
    energy_residual: float = 0.0
    """Error of the energy balance at the end [J]; the own solver's alone"""


@dataclass(frozen=True, slots=True)
class Apart:
    """How far two courses are apart, the most over the times that both have."""

    position: float
    """Of the terminal point, or of floater 1 where that is more [m]: a pinned end is never off"""
    tension: float
    """Of the pull at the top [N]"""
    tension_relative: float
    """The same over the largest pull at the top"""
    energy: float
    """[J]"""


def apart(course: Course, reference: Course, horizon: float) -> Apart:
    """Largest differences at the times up to `horizon` [s] that both courses have.

    Raises
    ------
    RunError
        If they have none but the start in common.
    """
    one, other = _common(course.times, reference.times, horizon)
    if len(one) < 2:
        raise RunError(f"there is no output time up to {horizon:g} s to compare at; a shorter step is needed")
    off = {name: course.outputs[name][one] - reference.outputs[name][other] for name in OUTPUTS}
    tension = float(np.max(np.abs(off["tension_top"])))
    largest = float(np.max(np.abs(reference.outputs["tension_top"][other])))
    return Apart(
        float(np.max(distance(off))), tension, tension / largest if largest > 0.0 else 0.0,
        float(np.max(np.abs(off["energy"]))),
    )  # fmt: skip


def distance(off: Mapping[str, Floats]) -> Floats:
    """Of the terminal points or of the floaters, whichever is more, from the differences of the outputs [m]."""
    return np.asarray(np.maximum(np.hypot(off["x_c"], off["y_c"]), np.abs(off["y_m1"])))


def _common(one: Floats, other: Floats, horizon: float) -> tuple[list[int], list[int]]:
    """Indices of the times in both, but for rounding, up to the horizon."""
    slack = 1e-9 * max(float(one[-1]), float(other[-1]))
    nearest = np.clip(np.searchsorted(other, one - slack), 0, len(other) - 1)
    matched = (np.abs(other[nearest] - one) <= slack) & (one <= horizon + slack)
    return np.flatnonzero(matched).tolist(), nearest[matched].tolist()


def output_times(scene: Scene, step: float | None = None) -> Floats:
    """0, step, 2 step, ..., and the stop time [s]; the step is the scene's unless given."""
    interval = step or scene.step
    count = int(np.ceil(scene.stop_time / interval * (1.0 - 1e-12)))
    return np.append(np.arange(count) * interval, scene.stop_time)


def timed(run: Callable[[], Course], patience: float = 0.5) -> Course:
    """The cheapest of three runs, or of those that begin within `patience` [s of CPU time]."""
    best, spent = run(), 0.0
    for _ in range(2):
        spent += best.cpu_time
        if spent >= patience:
            break
        again = run()
        best = again if again.cpu_time < best.cpu_time else best
    return best


# --- the FMU ---


class FmuRuns:
    """A scene's FMU, unpacked; every run is a new instance. Made by `fmu_runs`."""

    def __init__(self, scene: Scene, folder: Path) -> None:
        self.scene = scene
        self._folder = folder / "fmu"
        archive = build_fmu(scene, folder / f"{scene.name}.fmu", platforms=for_this_machine())
        extract(str(archive), unzipdir=str(self._folder))
        self._description = read_model_description(str(archive), validate=False)
        self._variables = {variable.name: variable for variable in variables_of(scene.cable, scene.dropped_outputs)}

    def run(
        self, *, tolerance: float, solver: str = "automatic", interface: str = "cs", step: float | None = None,
        start: Mapping[str, float] | None = None, signals: Mapping[str, Signal] | None = None,
        limit: float = float("inf"),
    ) -> Course:  # fmt: skip
        """Run the scene once.

        Parameters
        ----------
        tolerance, solver
            Of the solver; under CVode (`interface` "me") the tolerance alone.
        step
            Communication step and output interval [s]; the scene's by default.
        start
            Start values of states by name.
        signals
            Forces in place of the scene's.
        limit
            CPU time that it may take [s], looked at after every output interval.

        Raises
        ------
        RunError
            If it could not go on; `TooSlowError` if it took too long.
        """
        feed = Feed(dict(signals if signals is not None else self.scene.signals))
        wanted = [self._variables[name].reference for name in OUTPUTS]
        driver = make_driver(2, interface, self._description, str(self._folder), feed)
        times = output_times(self.scene, step)
        try:
            begun = clock.process_time()
            self._begin(driver, times[-1], tolerance, solver, start or {})
            rows = [driver.get(wanted)]
            for earlier, later in pairwise(times.tolist()):
                _advance(driver, feed, earlier, later)
                rows.append(driver.get(wanted))
                if clock.process_time() - begun > limit:
                    raise TooSlowError(f"more than {limit:g} s of CPU time", time=later)
            cpu_time = clock.process_time() - begun
            counted = driver.counters()
        finally:
            driver.close()
        return course(
            times, np.array(rows), cpu_time, rhs=int(counted["rhs"]), steps=int(counted["steps"]),
            energy_residual=float(counted.get("energy_residual", 0.0)),
        )  # fmt: skip

    def rest(self) -> Floats:
        """(y_m1, theta) that runs start from after initialisation, shape (n + 1,) [m, rad]."""
        driver = make_driver(2, "cs", self._description, str(self._folder), Feed(dict(self.scene.signals)))
        try:
            self._begin(driver, self.scene.stop_time, 1e-6, "automatic", {})
            names = ["y_m1", *(f"theta[{i}]" for i in range(1, self.scene.cable.n + 1))]
            return np.array(driver.get([self._variables[name].reference for name in names]))
        finally:
            driver.close()

    def _begin(self, driver: Driver, stop: float, tolerance: float, solver: str, start: Mapping[str, float]) -> None:
        choice = self._variables["solver"]
        assert choice.enumeration is not None  # variables.py makes it one
        numbers = {self._variables[name].reference: value for name, value in start.items()}
        driver.start(0.0, stop, tolerance, numbers, {choice.reference: choice.enumeration.value_of(solver)})


def course(
    times: Floats, rows: Floats, cpu_time: float, *, rhs: int, steps: int = 0, energy_residual: float = 0.0
) -> Course:
    """A course of rows of `OUTPUTS`, shape (m, 6).

    Raises
    ------
    RunError
        If a number in it is not finite.
    """
    if not np.all(np.isfinite(rows)):
        raise RunError("an output is not a finite number")
    return Course(times, dict(zip(OUTPUTS, rows.T, strict=True)), cpu_time, rhs, steps, energy_residual)


def _advance(driver: Driver, feed: Feed, time: float, end: float) -> None:
    """In pieces that no jump of a force lies in."""
    while time < end:
        reach = feed.next_break(time, end)
        driver.advance(time, reach)
        time = reach


@contextmanager
def fmu_runs(scene: Scene) -> Iterator[FmuRuns]:
    """Build and unpack a scene's FMU in a folder of its own, for as long as it is needed.

    Raises
    ------
    OptionError
        A scene that is not measured.
    """
    if not is_measured(scene):
        raise OptionError(
            f"scene {scene.name}: errors are measured of a terminal and of a floater that heaves alone; one with "
            'such a top, and a terminal that is not of kind "motion", is expected'
        )
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        yield FmuRuns(scene, Path(folder))


def is_measured(scene: Scene) -> bool:
    """Whether errors of this scene are measured: of ends that surge or whose motion is given they are not."""
    return scene.cable.top is Top.FLOATER and scene.cable.terminal is not Terminal.MOTION


def whole(scene: Scene) -> Scene:
    """The scene with all its outputs, and at rest in its equilibrium from the beginning if it starts from one.

    So that errors can be measured, and that a start which is a little off is not brought back by a search.
    """
    if scene.dropped_outputs:
        scene = replace(scene, spec=scene.spec.model_copy(update={"outputs": OutputsTable()}))
    if scene.cable.initial is Initial.SHAPE:
        return scene
    with fmu_runs(scene) as runs:
        rest = runs.rest()
    return replace(scene, cable=replace(scene.cable, position=rest, initial=Initial.SHAPE))
