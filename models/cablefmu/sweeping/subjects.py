"""What a sweep runs, opened once and run with one set of values after the other: a scene's FMU, or a coupling."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
import time as clock
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
import xarray as xr

from ..cable import Floats
from ..coupling.description import Coupling, load_coupling
from ..coupling.models import Model, wrong_values
from ..coupling.run import run_system
from ..coupling.system import System, opened
from ..errors import OptionError, RunError
from ..fmu.archive import build_fmu
from ..runner import Runner
from ..scene import load_scene
from .cases import Given
from .description import Sweep

__all__ = ["Outcome", "Output", "Package", "Subject", "packages_of"]


@dataclass(frozen=True, slots=True)
class Output:
    """One column over time."""

    name: str
    unit: str
    text: str


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one run: rows up to a failure, and its reason."""

    times: Floats
    """[s]"""
    values: Floats
    """Shape (times, outputs)"""
    reason: str
    """Empty if the run reached its stop time."""
    seconds: float


class Subject(Protocol):
    """A scene or coupling, ready to be run."""

    outputs: Sequence[Output]
    settings: Mapping[str, float | str]
    """How it is run: what else decides on results, as it is told to the user."""

    def check(self, name: str, value: float | str) -> None:
        """OptionError, if that cannot be set."""

    def run(self, given: Given) -> Outcome:
        """One case."""

    def close(self) -> None:
        """Leave nothing behind."""


class Package(Protocol):
    """What a worker needs for a subject; travels to other processes and machines."""

    @property
    def name(self) -> str:
        """What the sweep calls it."""

    @property
    def identity(self) -> str:
        """SHA-256 of all that decides on results, beside values and settings."""

    def open(self, folder: Path | None = None) -> Subject:
        """In the process that runs it; files go below `folder`."""


def packages_of(sweep: Sweep) -> list[Package]:
    """Build what a sweep runs.

    Raises
    ------
    UserError
        A scene, FMU or coupling that is not in order.
    """
    spec = sweep.spec
    if spec.coupling is not None:
        is_file = spec.coupling.endswith(".toml")
        coupling = load_coupling(sweep.folder / spec.coupling if is_file else spec.coupling)
        return [CouplingPackage(spec.coupling, replace(coupling, folder=coupling.folder.resolve()))]
    run = spec.run
    settings = (run.interface or "cs", run.stop_time, run.step, run.tolerance)
    return [ScenePackage(name, _archive(name, sweep.folder, run.fmi), *settings) for name in spec.scenes or ()]


def _archive(name: str, folder: Path, fmi: int | None) -> bytes:
    """An FMU, built of a scene or as it is: for all machines, as workers may be others."""
    if name.endswith(".fmu"):
        if fmi is not None:
            raise OptionError(f"fmi = {fmi}: {name} is an FMU, which has its version; leave it out")
        try:
            return (folder / name).read_bytes()
        except OSError as error:
            raise OptionError(f"{name}: cannot be read ({error.strerror})") from None
    scene = load_scene(folder / name if name.endswith(".toml") else name)
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as made:
        return build_fmu(scene, Path(made) / "scene.fmu", fmi=fmi or 2).read_bytes()


@dataclass(frozen=True, slots=True)
class ScenePackage:
    """A scene as its FMU."""

    name: str
    archive: bytes
    interface: str
    stop_time: float | None
    step: float | None
    tolerance: float | None

    @property
    def identity(self) -> str:
        return hashlib.sha256(self.archive).hexdigest()

    def open(self, folder: Path | None = None) -> Subject:
        return _SceneSubject(self, folder)


class _SceneSubject:
    def __init__(self, package: ScenePackage, folder: Path | None) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="cablefmu-", dir=folder))
        path = self._folder / f"{Path(package.name).stem}.fmu"
        try:
            path.write_bytes(package.archive)
            self._runner = Runner(
                path, self._folder / "fmu", interface=package.interface, stop_time=package.stop_time,
                step=package.step, tolerance=package.tolerance,
            )  # fmt: skip
        except BaseException:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise
        settings = self._runner.settings
        self.settings: Mapping[str, float | str] = {
            "interface": settings.interface, "stop time": settings.stop_time, "step": settings.step,
            "tolerance": settings.tolerance,
        }  # fmt: skip
        self.outputs: Sequence[Output] = [Output(v.name, v.unit, v.description) for v in self._runner.outputs]

    def check(self, name: str, value: float | str) -> None:
        self._runner.check(name, value)

    def run(self, given: Given) -> Outcome:
        ended = self._runner.run(given)
        rows = ended.recording.rows
        values = np.array(rows, dtype=float).reshape(len(rows), len(ended.recording.variables))
        reason = "" if ended.failure is None else str(ended.failure)
        return Outcome(np.array(ended.recording.times, dtype=float), values, reason, ended.seconds)

    def close(self) -> None:
        self._runner.close()
        shutil.rmtree(self._folder, ignore_errors=True)


@dataclass(frozen=True, slots=True)
class CouplingPackage:
    """A coupling as its file, which must find its own files where the workers are."""

    name: str
    coupling: Coupling

    @property
    def identity(self) -> str:
        """Of the file and of its FMUs; those in Python say when they were made, but for what they are made of."""
        digest = hashlib.sha256(self.coupling.text.encode())
        with opened(self.coupling, elsewhere=True) as system:
            for name, model in system.models.items():
                digest.update(name.encode())
                resources = model.folder / "resources"
                is_python = (resources / "slavemodule.txt").is_file()
                for path in sorted(resources.rglob("*")) if is_python else [model.path]:
                    if path.is_file():
                        digest.update(path.name.encode() if is_python else b"")
                        digest.update(hashlib.sha256(path.read_bytes()).digest())
        return digest.hexdigest()

    def open(self, folder: Path | None = None) -> Subject:
        return _CouplingSubject(self.coupling)


class _CouplingSubject:
    """MODEL.NAME sets a parameter, a start value or an input that nothing is connected to."""

    def __init__(self, coupling: Coupling) -> None:
        self._stack = ExitStack()
        self._system = self._stack.enter_context(opened(coupling))
        self.outputs: Sequence[Output] = [
            Output(f"{name}.{output}", _unit(model, output), model.variables[output].description or "")
            for name, model in self._system.models.items() for output in model.names("output")
        ]  # fmt: skip
        own = self._system.settings
        self.settings: Mapping[str, float | str] = {
            "stop time": own.stop_time, "step": own.step, "tolerance": own.tolerance
        }  # fmt: skip

    def check(self, name: str, value: float | str) -> None:
        model_name, _, variable = name.partition(".")
        models = self._system.models
        if model_name not in models or not variable:
            raise OptionError(f"set {name}: MODEL.NAME is expected, with a model of {', '.join(models)}")
        fed = {connection.target for connection in self._system.connections}
        if name in map(str, fed):
            raise OptionError(f"set {name}: it is an input that something is connected to")
        if variable in models[model_name].names("input") and isinstance(value, str):
            raise OptionError(f"set {name}={value}: a number is expected")
        for key, text, _ in wrong_values(_with(self._system, {name: value}).models[model_name]):
            if key.partition(".")[2] == variable:
                raise OptionError(f"set {name}={value}: {text}")

    def run(self, given: Given) -> Outcome:
        began, reason = clock.perf_counter(), ""
        try:
            result = run_system(_with(self._system, given))
        except RunError as error:
            if not isinstance(error.partial, xr.Dataset):
                raise
            result, reason = error.partial, str(error)
        names = [output.name for output in self.outputs]
        values = np.column_stack([result[name].values for name in names])
        return Outcome(result["time"].values, values, reason, clock.perf_counter() - began)

    def close(self) -> None:
        self._stack.close()


def _unit(model: Model, output: str) -> str:
    unit = model.unit(output)
    return unit.name if unit else ""


def _with(system: System, given: Given) -> System:
    """The same system with other values."""
    models = dict(system.models)
    for name, value in given.items():
        model_name, _, variable = name.partition(".")
        model = models[model_name]
        spec = model.spec
        if variable in model.names("input"):
            spec = spec.model_copy(update={"inputs": {**spec.inputs, variable: value}})
            model = replace(model, spec=spec, constants={**model.constants, variable: float(value)})
        else:
            spec = spec.model_copy(update={"parameters": {**spec.parameters, variable: value}})
            model = replace(model, spec=spec)
        models[model_name] = model
    return replace(system, models=models)
