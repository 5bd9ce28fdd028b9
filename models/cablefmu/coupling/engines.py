"""Who steps a coupling: the master of this package, libcosim, or FMPy's SSP runner.

The other two take what the export says, and of [coupling] step and stop time alone: both are Jacobi with held inputs.
What they cannot do is refused before the run.
"""

from __future__ import annotations

import tempfile
import time as clock
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, read_ssv

from ..errors import OptionError, RunError
from .export_osp import STRUCTURE, write_osp
from .export_ssp import values_of, write_ssp
from .results import make_dataset, recorded
from .run import Progress, run_system
from .system import System

__all__ = ["ENGINES", "run_with"]

_NANO = 1e-9  # libcosim counts time in whole nanoseconds


def run_with(engine: str, system: System, progress: Progress | None = None) -> xr.Dataset:
    """Run a coupling with an engine of `ENGINES`.

    Raises
    ------
    OptionError
        With one line for everything that the engine cannot do of this coupling, or if it is not installed.
    RunError
        If the run could not go on.
    """
    return ENGINES[engine](system, progress)


def _by_libcosim(system: System, progress: Progress | None) -> xr.Dataset:
    try:
        from libcosimpy import CosimExecution, CosimLogging, CosimObserver
        from libcosimpy._internal import get_last_error_message
    except ImportError:
        raise OptionError("engine = libcosim: is not installed; pip install 'cablefmu[engines]' is expected") from None
    _refuse("libcosim", [*_jacobi_alone(system), *_of_libcosim(system)])
    settings, started = system.settings, clock.perf_counter()
    CosimLogging.log_output_level(CosimLogging.CosimLogLevel.FATAL)
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        write_osp(system, Path(folder))
        execution = CosimExecution.CosimExecution.from_osp_config_file(str(Path(folder) / STRUCTURE))
        observer = CosimObserver.CosimObserver.create_last_value()
        execution.add_observer(observer)
        columns = _columns(system, execution)
        times: list[float] = []
        rows: list[list[float]] = []
        failure = None
        for time in _whole_times(system)[1:]:  # it initialises in its first step: of the start it says nothing
            if not execution.step():
                failure = f"libcosim: the step to t = {time:.12g} s failed: {get_last_error_message()}"
                break
            times.append(time)
            rows.append([x for slave, references in columns for x in observer.last_real_values(slave, references)])
            if progress:
                progress(time, settings.stop_time)
        del observer, execution
    if failure is not None and not times:
        raise RunError(failure)
    result = _dataset(system, "libcosim", times, rows, clock.perf_counter() - started)
    if failure is None:
        return result
    raise RunError(failure, time=times[-1], partial=result)


def _columns(system: System, execution: Any) -> list[tuple[int, list[int]]]:
    """Every model's number in libcosim, and the references of its outputs."""
    return [
        (
            execution.slave_index_from_instance_name(name),
            [int(model.variables[output].valueReference) for output in model.names("output")],
        )
        for name, model in system.models.items()
    ]


def _by_fmpy(system: System, progress: Progress | None) -> xr.Dataset:
    _refuse("fmpy-ssp", [*_jacobi_alone(system), *_of_fmpy(system)])
    settings, started = system.settings, clock.perf_counter()
    times = _whole_times(system)
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        path = write_ssp(system, Path(folder) / "coupling.ssp")
        try:
            # Its loop adds up steps: half a step less than the stop time ends it after the right number of them.
            rows = simulate_ssp(
                str(path),
                stop_time=settings.stop_time - 0.5 * settings.step,
                step_size=settings.step,
                parameter_set=_parameters(system, path),
            )
        except Exception as error:  # FMPy raises what it meets
            raise RunError(f"fmpy-ssp: {error}") from None
    if progress:
        progress(settings.stop_time, settings.stop_time)
    # A row of time t holds what was said at the end of the step from t on; of the start it holds nothing.
    names = [str(variable) for variable in recorded(system)]
    table = np.column_stack([rows[name] for name in names]).tolist()
    return _dataset(system, "fmpy-ssp", times[1:], table, clock.perf_counter() - started)


def _parameters(system: System, path: Path) -> ParameterSet:
    """Values of all models by MODEL.NAME: FMPy's runner does not look for them by itself."""
    values = ParameterSet()
    for name in system.models:
        for parameter in read_ssv(str(path), resource=f"resources/{name}.ssv").parameters:
            parameter.name = f"{name}.{parameter.name}"
            values.parameters.append(parameter)
    return values


def _refuse(engine: str, reasons: list[str]) -> None:
    if reasons:
        raise OptionError("\n".join(f"engine = {engine}: {reason}" for reason in reasons))


def _jacobi_alone(system: System) -> Iterator[str]:
    settings = system.settings
    if settings.algorithm != "jacobi":
        yield f'algorithm = "{settings.algorithm}" is not in it; "jacobi" is expected'
    if settings.extrapolation:
        yield f"extrapolation = {settings.extrapolation}: it holds inputs; 0 is expected"
    if settings.adaptive:
        yield "its steps have one length; leave adaptive out"
    steps = settings.stop_time / settings.step
    if abs(steps - round(steps)) > 1e-9 * steps:
        yield f"stop_time = {settings.stop_time} s: a multiple of the step is expected"
    for model in system.models.values():
        if model.fmi != 2:
            yield f"model {model.name} is of FMI {model.fmi}; 2 is expected"


def _of_libcosim(system: System) -> Iterator[str]:
    size = system.settings.step / _NANO
    if abs(size - round(size)) > 1e-6:
        yield f"step = {system.settings.step} s: a whole number of nanoseconds is expected"
    for name, model in system.models.items():
        for parameter in model.spec.parameters:
            if model.variables[parameter].type == "Enumeration":
                yield f"model {name}: parameter {parameter} is an enumeration, which it does not know; leave it out"


def _of_fmpy(system: System) -> Iterator[str]:
    for connection in system.connections:
        for name, used in (("gain", connection.gain != 1.0), ("offset", connection.offset != 0.0)):
            if used:
                yield f"connection {connection}: it knows no {name}"
    names = list(system.models)
    for name in names:
        longer = [other for other in names if other != name and other.startswith(name)]
        if longer and any(True for _ in values_of(system.models[longer[0]])):
            yield f"model {name}: it takes parameters of {longer[0]} for its own, whose name begins alike; rename one"


def _whole_times(system: System) -> list[float]:
    settings = system.settings
    return [k * settings.step for k in range(round(settings.stop_time / settings.step))] + [settings.stop_time]


def _dataset(system: System, engine: str, times: list[float], rows: list[list[float]], run_time: float) -> xr.Dataset:
    steps = len(times)
    statistics = {"notes": "", "steps": steps, "evaluations": steps, "rejected": 0, "run_time": run_time}
    return make_dataset(system, times, rows, engine, statistics, powers=False)


ENGINES: Mapping[str, Callable[[System, Progress | None], xr.Dataset]] = {
    "own": run_system, "libcosim": _by_libcosim, "fmpy-ssp": _by_fmpy,
}  # fmt: skip
