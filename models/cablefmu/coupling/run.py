"""A coupled run, from its file to results.

`couple` is the table of contents: check everything, instantiate, find a start that agrees, step, and record.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from ..errors import RunError
from .control import Adaptive, Constant
from .description import Coupling, load_coupling
from .exchange import Exchange
from .initialise import initialise
from .partners import Partner, make_partner
from .results import Recording, make_dataset
from .step import make_stepper
from .system import System, opened

__all__ = ["couple", "run_system"]

Progress = Callable[[float, float], None]
"""Called with the simulated and the stop time [s]"""


def couple(coupling: Coupling | str | Path, *, progress: Progress | None = None) -> xr.Dataset:
    """Run a coupling with the master of this package.

    Parameters
    ----------
    coupling
        A coupling, the name of one that ships, or the path of a TOML file.
    progress
        Called with the simulated and the stop time [s] after every step.

    Returns
    -------
    xarray.Dataset
        Over `time` [s]: MODEL.OUTPUT of all models, power.NAME and power.NAME.residual [W]; `attrs` hold the coupling,
        its settings, versions and counters.

    Raises
    ------
    CouplingError
        With one line for every mistake in the file, or between the models.
    FmuError
        If an FMU cannot be loaded.
    RunError
        If the run could not go on; its `partial` is the Dataset up to then.
    """
    with opened(coupling if isinstance(coupling, Coupling) else load_coupling(coupling)) as system:
        return run_system(system, progress)


def run_system(system: System, progress: Progress | None = None) -> xr.Dataset:
    """Run a coupling that is in order."""
    settings, started = system.settings, clock.perf_counter()
    recording, counters = Recording(system), _Counters()
    exchange = Exchange(system.connections, system.models, settings.extrapolation)
    failure: RunError | None = None
    with _instances(system, exchange) as partners:
        may_repeat = settings.adaptive is not None and system.can_repeat
        step = make_stepper(system, partners, exchange, may_repeat=may_repeat)
        control = (
            Adaptive(system, partners, exchange, step, settings.adaptive)
            if settings.adaptive
            else Constant(system, step)
        )
        try:
            outputs = initialise(system, partners, exchange)
            start = dict(zip((c.target for c in system.connections), map(float, exchange.values(outputs)), strict=True))
            recording.add(0.0, outputs, start)
            exchange.accept(0.0, outputs)
            for begin, end, ended in control.steps():
                recording.add(end, ended.outputs, ended.inputs)
                exchange.accept(end, ended.outputs)
                counters.add(end - begin, ended.evaluations)
                if progress:
                    progress(end, settings.stop_time)
            for partner in partners.values():
                partner.terminate()
        except RunError as error:
            failure = error
    if failure is not None and not recording.times:
        raise failure
    statistics = {
        "tolerance": settings.tolerance,
        "notes": "; ".join(system.notes),
        **counters.told(control.rejected),
        "run_time": clock.perf_counter() - started,
    }
    result = make_dataset(system, recording.times, recording.rows, "own", statistics, powers=True)
    if failure is None:
        return result
    result.attrs["ended_early"] = str(failure)
    raise RunError(str(failure), time=recording.times[-1], partial=result)


@contextmanager
def _instances(system: System, exchange: Exchange) -> Iterator[dict[str, Partner]]:
    """One instance of every model, all freed at the end."""
    with ExitStack() as stack:
        partners: dict[str, Partner] = {}
        for name, model in system.models.items():
            partners[name] = make_partner(model, exchange.inputs(name))
            stack.callback(partners[name].close)
        yield partners


@dataclass(slots=True)
class _Counters:
    steps: int = 0
    evaluations: int = 0
    shortest: float = float("inf")
    longest: float = 0.0

    def add(self, size: float, evaluations: int) -> None:
        self.steps += 1
        self.evaluations += evaluations
        self.shortest, self.longest = min(self.shortest, size), max(self.longest, size)

    def told(self, rejected: int) -> dict[str, float]:
        told: dict[str, float] = {"steps": self.steps, "evaluations": self.evaluations, "rejected": rejected}
        return told | ({"shortest_step": self.shortest, "longest_step": self.longest} if self.steps else {})
