"""What users call from Python; what it takes is loaded when it is called."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from ..errors import OptionError
from .description import Sweep, make_sweep, read_tables

__all__ = ["Crew", "Progress", "default_folder", "needs", "open_sweep", "sweep"]

Progress = Callable[[int, int, int], None]
"""Called with the numbers of cases that are finished, that failed among them, and of all"""

_EXTRA = ("distributed", "pyarrow", "rainflow")


def needs(module: str) -> Any:
    """A module of this package that is loaded only where sweeps are.

    Raises
    ------
    OptionError
        If what it takes is not installed.
    """
    for name in _EXTRA:
        if importlib.util.find_spec(name) is None:
            raise OptionError(f"a sweep needs {name}: pip install 'cablefmu[sweep]'")
    return importlib.import_module(f"{__package__}.{module}")


@dataclass(frozen=True, slots=True)
class Crew:
    """Who runs it."""

    workers: int | None = None
    """Processes on this machine, one a core by default; 0: this process."""
    scheduler: str | None = None
    """Address of a Dask scheduler whose workers are used instead."""
    wait: float = 30.0
    """For workers that are not there [s]"""

    def check(self) -> None:
        """OptionError, if these contradict each other."""
        if self.workers is not None and not 0 <= self.workers <= 1024:
            raise OptionError(f"workers = {self.workers}: 0 (this process) to 1024 are expected")
        if self.workers is not None and self.scheduler is not None:
            raise OptionError(f"workers = {self.workers}: a scheduler has its own workers; one of them is expected")
        if not 0.0 <= self.wait <= 1e6:
            raise OptionError(f"wait = {self.wait}: a number of seconds from 0 to 1e6 is expected")


def sweep(
    what: str | Path | Mapping[str, Any], *, output: str | Path | None = None, workers: int | None = None,
    scheduler: str | None = None, wait: float = 30.0, keep_series: bool = False, restart: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:  # fmt: skip
    """Run many cases of a scene, of several, or of a coupling.

    Parameters
    ----------
    what
        The path of a sweep file, or its tables: ``{"scenes": ["heave-60-water"], "grid": {"M_1": [4000, 8000]}}``.
    output
        Folder of the store; ./build/NAME.sweep by default. What is finished in it is not run again.
    workers
        Processes on this machine, one a core by default; 0 runs everything in this process. With more, the script that
        calls this must do so below ``if __name__ == "__main__":``.
    scheduler
        Address of a Dask scheduler whose workers are used instead; they must have this version of this package.
    wait
        How long to wait for workers that are not there [s].
    keep_series
        Keep the outputs of every case over time as well (`series/` of the folder).
    restart
        Begin anew, whatever the folder holds of a sweep.
    progress
        Called with the numbers of cases that are finished, that failed among them, and of all.

    Returns
    -------
    xarray.Dataset
        Over `case`: what varied, `status`, `ended_at` [s], `reason`, and NAME.min, NAME.max, NAME.final of every
        output, NAME.equivalent of tensions, `run_time` [s].

    Raises
    ------
    UserError
        A mistake in what was given: SweepError, SceneError, CouplingError, FmuError or OptionError.
    RunError
        If it could not go on, with what is finished kept.
    """
    run = needs("run")
    if isinstance(what, Mapping):
        asked = make_sweep(what, name="sweep")
    else:
        path = Path(what)
        asked = make_sweep(read_tables(path), name=path.stem, folder=path.parent, source=str(path))
    folder = Path(output) if output is not None else default_folder(asked)
    crew = Crew(workers, scheduler, wait)
    run.run_sweep(asked, folder, crew, keep_series=keep_series, restart=restart, progress=progress)
    return open_sweep(folder)


def open_sweep(folder: str | Path) -> xr.Dataset:
    """Read what is finished of a sweep, the whole of it or not.

    Parameters
    ----------
    folder
        Of its store, ./build/NAME.sweep unless it was named.

    Returns
    -------
    xarray.Dataset
        Over `case`, see `sweep`; numbers that a failed case does not have are NaN.

    Raises
    ------
    SweepError
        If there is no sweep.
    OptionError
        If what it is kept with is not installed.
    """
    result: xr.Dataset = needs("table").open_table(Path(folder))
    return result


def default_folder(asked: Sweep) -> Path:
    return Path("build") / f"{asked.name}.sweep"
