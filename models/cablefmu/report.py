"""Error against run time of a scene: what a run costs, how wrong it is, and how many links are enough."""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from . import __version__
from .errors import OptionError
from .report_ladder import (
    DEFAULT,
    PEERS,
    Row,
    Said,
    communication_steps,
    ladder,
    longest_held,
    recommended,
)
from .report_reference import Trusted, trusted
from .report_refinement import Refinement, refinement
from .report_runs import SOLVERS, fmu_runs, whole
from .scene import Scene

__all__ = ["ACCURACY", "LIMIT", "Report", "check_options", "made_on", "make_report"]

ACCURACY = 1e-4
"""Position error that a setting is recommended for [m]."""
LIMIT = 60.0
"""CPU time that a run may take [s]."""

_FINEST_ACCURACY = 1e-6
"""[m]: two starts 1e-9 rad apart are that far apart from the beginning on a cable of a kilometre."""


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """All that was measured of one scene."""

    scene: Scene
    accuracy: float
    """[m]"""
    limit: float
    """[s of CPU time]"""
    reference: Trusted
    ladder: Sequence[Row]
    communication: Sequence[Row]
    at_best_step: Sequence[Row]
    """The own solvers again, at the communication step that was cheapest among those that keep the accuracy"""
    refinement: Refinement

    @property
    def default(self) -> Row:
        """The run with the default setting."""
        return next(row for row in self.ladder if (row.solver, row.tolerance) == DEFAULT)

    @property
    def recommended(self) -> Row | None:
        """The cheapest setting that keeps the accuracy in a host that gives inputs exactly."""
        return recommended([*self.ladder, *self.communication, *self.at_best_step], self.accuracy)

    @property
    def longest_held(self) -> Row | None:
        """The longest communication step that keeps it in a host that holds inputs."""
        return longest_held(self.communication, self.accuracy)


def make_report(
    scene: Scene, *, accuracy: float = ACCURACY, limit: float = LIMIT,
    solvers: Sequence[str] = (*SOLVERS, *PEERS), say: Said = lambda _: None,
) -> Report:  # fmt: skip
    """Measure a scene.

    Parameters
    ----------
    scene
        Outputs that it drops are measured nevertheless.
    accuracy
        Position error [m] that a setting is recommended for, and beyond which two starts count as parted.
    limit
        CPU time that every single run may take [s], looked at after every output interval of an FMU's run; those
        for the reference may take a minute in any case.
    solvers
        Which to compare; the own ones, with the default setting among them, must be there.
    say
        Told what is done next.

    Raises
    ------
    OptionError
        An accuracy or limit out of range.
    RunError
        If the scene has no trusted reference.
    """
    check_options(accuracy, limit)
    scene = whole(scene)
    with fmu_runs(scene) as runs:
        say("reference and horizon")
        reference = trusted(runs, accuracy, max(limit, LIMIT))
        rows = ladder(runs, reference, limit, solvers=solvers, say=say)
        steps = communication_steps(runs, reference, limit, say=say)
        best = recommended(steps, accuracy)
        again: list[Row] = []
        if best is not None and best.step != scene.step:
            again = ladder(runs, reference, limit, step=best.step, solvers=SOLVERS, say=say)
    links = refinement(scene, reference.horizon.time, limit, say=say)
    return Report(scene, accuracy, limit, reference, rows, steps, again, links)


def check_options(accuracy: float, limit: float) -> None:
    """Refuse numbers that make no sense.

    Raises
    ------
    OptionError
        An accuracy below 1e-6 m or a limit that is not above 0.
    """
    if not (math.isfinite(accuracy) and accuracy >= _FINEST_ACCURACY):
        raise OptionError(f"accuracy = {accuracy:g}: a number of {_FINEST_ACCURACY:g} or more [m] is expected")
    if not limit > 0.0:
        raise OptionError(f"limit = {limit:g}: a number above 0 [s of CPU time] is expected")


def made_on() -> str:
    """Versions and machine, one line."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("fmpy", "numpy", "scipy"))
    return f"cablefmu {__version__}, {packages}, Python {platform.python_version()}; {_machine()}"


def _machine() -> str:
    cores = f"{os.cpu_count()} cores"
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{models[0] if models else platform.machine()}, {cores}, {platform.system()}"
