"""One FMU instance of a coupling through FMPy, with one face for FMI 2 and FMI 3."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import chdir
from typing import Any

from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

from ..drive import fmi2_callbacks
from ..errors import FmuError, RunError
from ..reals import Reals
from .extrapolation import Polynomial
from .models import REAL, Model
from .schema import Value

__all__ = ["Partner", "make_partner"]

_KEPT = 20  # messages of an FMU that are remembered: the last is told when it fails


class Partner(ABC):
    """An instance between instantiate and free; values by name."""

    def __init__(self, model: Model, inputs: Sequence[str]) -> None:
        self.model = model
        self.inputs = list(inputs)
        self.outputs = model.names("output")
        self.messages: deque[str] = deque(maxlen=_KEPT)
        self._input_references = [self._reference(name) for name in self.inputs]
        self._inputs = self._reals(self.inputs)
        self._outputs = self._reals(self.outputs)
        slopes = [model.slopes(name) for name in self.inputs]
        self._sloping = [len(names) for names in slopes]
        self._slopes = self._reals([name for names in slopes for name in names])
        self._interpolated = [model.interpolates(name) for name in self.inputs]
        self.fmu: Any = None
        self._is_dead = False

    # --- life cycle ---

    def enter_initialisation(self, stop: float, tolerance: float) -> None:
        """Set parameters and constant inputs, and go where inputs can be tried."""
        values = {**self.model.spec.parameters, **self.model.constants}
        self._call("setting parameters", self._set_all, values)
        self._call("entering initialization mode", self._enter, stop, tolerance)
        self._call("setting constant inputs", self._set_all, self.model.constants)

    def exit_initialisation(self) -> None:
        self._call("leaving initialization mode", self.fmu.exitInitializationMode)

    def terminate(self) -> None:
        self._call("ending", self.fmu.terminate)

    def close(self) -> None:
        """Free the instance and its library."""
        fmu, self.fmu = self.fmu, None
        if fmu is None or fmu.component is None:
            return
        # PythonFMU's library lets go of its interpreter when the process ends, after its own statics are gone, and so
        # writes to freed memory. Done here, there is nothing left to let go of.
        let_go = getattr(fmu.dll, "finalizePythonInterpreter", None)
        if not self._is_dead:
            getattr(fmu, f"fmi{self.model.fmi}FreeInstance")(fmu.component)
        if let_go is not None:
            let_go()
        if not self._is_dead:
            fmu.freeLibrary()

    # --- values ---

    def set(self, values: Sequence[float]) -> None:
        """Set the connected inputs."""
        self._check(self.inputs, values, "input")
        if self.inputs:
            self._call("setting inputs", self._inputs.set, self.fmu, values)

    def get(self) -> list[float]:
        """All real outputs.

        Raises
        ------
        RunError
            If one is not a finite number.
        """
        values: list[float] = self._call("reading outputs", self._outputs.get, self.fmu)
        self._check(self.outputs, values, "output")
        return values

    # --- stepping ---

    def _set_slopes(self, time: float, polynomials: Sequence[Polynomial]) -> None:
        """Set the inputs that are other inputs' derivatives."""
        values: list[float] = []
        for count, polynomial in zip(self._sloping, polynomials, strict=True):
            if count:
                values += [*polynomial.derivatives(time), 0.0, 0.0][:count]
        if values:
            self._call("setting slopes", self._slopes.set, self.fmu, values)

    def step(self, time: float, end: float, polynomials: Sequence[Polynomial], *, is_final: bool) -> None:
        """From `time` to `end` with these inputs; `is_final`: nobody will go back before `time`."""
        now = [p(time) if follows else p(end) for p, follows in zip(polynomials, self._interpolated, strict=True)]
        self.set(now)
        self._set_slopes(time, polynomials)
        self._follow(time, polynomials)
        self._call(f"its step from t = {time:.12g} s", self._step, time, end - time, is_final)

    @abstractmethod
    def save(self) -> Any:
        """A copy of the complete state."""

    @abstractmethod
    def restore(self, state: Any) -> None:
        """Go back to a state; it can be gone back to again."""

    def forget(self, state: Any) -> None:
        """Free a state."""
        if not self._is_dead:
            self._call("freeing a state", self._free, state)

    # --- what the versions do differently ---

    @abstractmethod
    def _free(self, state: Any) -> None: ...

    @abstractmethod
    def _set_all(self, values: Mapping[str, Value]) -> None: ...

    @abstractmethod
    def _enter(self, stop: float, tolerance: float) -> None: ...

    @abstractmethod
    def _follow(self, time: float, polynomials: Sequence[Polynomial]) -> None: ...

    @abstractmethod
    def _step(self, time: float, size: float, is_final: bool) -> None: ...

    # --- shared ---

    def _reference(self, name: str) -> int:
        return int(self.model.variables[name].valueReference)

    def _reals(self, names: Sequence[str]) -> Reals:
        return Reals(self.model.fmi, [self._reference(name) for name in names])

    def _load(self, kind: type, instantiate: Callable[[Any], None]) -> None:
        """The library for this platform, and an instance."""
        description = self.model.description
        try:
            with chdir("."):  # FMPy stays in the library's folder if it cannot load it
                fmu = kind(
                    guid=description.guid, unzipDirectory=str(self.model.folder),
                    modelIdentifier=description.coSimulation.modelIdentifier, instanceName=self.model.name,
                )  # fmt: skip
            instantiate(fmu)
        except Exception as error:  # FMPy raises a bare Exception where there is none, ctypes an OSError
            said = self.messages[-1] if self.messages else error
            raise FmuError(f"model {self.model.name}: its FMU cannot be loaded: {said}") from None
        self.fmu = fmu

    def _call(self, what: str, function: Callable[..., Any], *arguments: Any) -> Any:
        try:
            return function(*arguments)
        except FMICallException as error:
            self._is_dead = error.status >= fmi2.fmi2Fatal  # FMI forbids every further call, freeing included
            said = self.messages[-1] if self.messages else "it gave no reason"
            raise RunError(f"model {self.model.name} failed in {what}: {said}") from None

    def _check(self, names: Sequence[str], values: Sequence[float], kind: str) -> None:
        if not all(map(math.isfinite, values)):
            name, value = next(pair for pair in zip(names, values, strict=True) if not math.isfinite(pair[1]))
            raise RunError(f"{kind} {self.model.name}.{name} = {value}: a finite number is expected")

    def _typed(self, values: Mapping[str, Value]) -> dict[str, tuple[list[int], list[Any]]]:
        """References and values by the types that FMI knows."""
        typed: dict[str, tuple[list[int], list[Any]]] = {}
        for name, value in values.items():
            variable = self.model.variables[name]
            kind = "Real" if variable.type in REAL else variable.type
            if kind == "Enumeration":
                value = next(int(item.value) for item in variable.declaredType.items if item.name == value)
            references, listed = typed.setdefault(kind, ([], []))
            references.append(variable.valueReference)
            listed.append(float(value) if kind == "Real" else value)
        return typed


class _Fmi2(Partner):
    """FMI 2: inputs follow their derivatives."""

    def __init__(self, model: Model, inputs: Sequence[str]) -> None:
        super().__init__(model, inputs)
        callbacks = self._callbacks = fmi2_callbacks(self.messages)  # must outlive the instance
        # pythonfmu keeps even its errors to itself when logging is off.
        self._load(fmi2.FMU2Slave, lambda fmu: fmu.instantiate(callbacks=callbacks, loggingOn=True))

    def save(self) -> Any:
        return self._call("saving its state", self.fmu.getFMUstate)

    def restore(self, state: Any) -> None:
        self._call("going back to a state", self.fmu.setFMUstate, state)

    def _free(self, state: Any) -> None:
        self.fmu.freeFMUstate(state)

    def _enter(self, stop: float, tolerance: float) -> None:
        self.fmu.setupExperiment(tolerance=tolerance, startTime=0.0, stopTime=stop)
        self.fmu.enterInitializationMode()

    def _set_all(self, values: Mapping[str, Value]) -> None:
        setters = {"Real": self.fmu.setReal, "Boolean": self.fmu.setBoolean, "String": self.fmu.setString}
        for kind, (references, listed) in self._typed(values).items():
            setters.get(kind, self.fmu.setInteger)(references, listed)

    def _follow(self, time: float, polynomials: Sequence[Polynomial]) -> None:
        if not self.model.description.coSimulation.canInterpolateInputs:
            return
        references, orders, values = [], [], []
        for reference, polynomial in zip(self._input_references, polynomials, strict=True):
            for order, value in enumerate(polynomial.derivatives(time), start=1):
                references.append(reference)
                orders.append(order)
                values.append(value)
        if references:
            self._call("setting slopes", self.fmu.setRealInputDerivatives, references, orders, values)

    def _step(self, time: float, size: float, is_final: bool) -> None:
        self.fmu.doStep(time, size, int(is_final))


class _Fmi3(Partner):
    """FMI 3: inputs are asked for inside a step (intermediate update)."""

    def __init__(self, model: Model, inputs: Sequence[str]) -> None:
        super().__init__(model, inputs)
        self._followed = [r for r, follows in zip(self._input_references, self._interpolated, strict=True) if follows]
        self._following: list[Polynomial] = []

        def log(environment: Any, status: int, category: bytes, message: bytes) -> None:
            self.messages.append(message.decode("utf-8", "replace"))

        def update(environment: Any, time: float, may_set: bool, *_: Any) -> None:
            if may_set and self._following:
                self.fmu.setFloat64(self._followed, [polynomial(time) for polynomial in self._following])

        asked = {"requiredIntermediateVariables": self._followed, "intermediateUpdate": update}
        self._load(
            fmi3.FMU3Slave,
            lambda fmu: fmu.instantiate(logMessage=log, loggingOn=True, **(asked if self._followed else {})),
        )

    def save(self) -> Any:
        return self._call("saving its state", self.fmu.getFMUState)

    def restore(self, state: Any) -> None:
        self._call("going back to a state", self.fmu.setFMUState, state)

    def _free(self, state: Any) -> None:
        self.fmu.freeFMUState(state)

    def _enter(self, stop: float, tolerance: float) -> None:
        self.fmu.enterInitializationMode(tolerance=tolerance, startTime=0.0, stopTime=stop)

    def _set_all(self, values: Mapping[str, Value]) -> None:
        for kind, (references, listed) in self._typed(values).items():
            name = {"Real": "Float64", "Enumeration": "Int64"}.get(kind, kind)
            getattr(self.fmu, f"set{name}")(references, listed)

    def _follow(self, time: float, polynomials: Sequence[Polynomial]) -> None:
        self._following = [p for p, follows in zip(polynomials, self._interpolated, strict=True) if follows]

    def _step(self, time: float, size: float, is_final: bool) -> None:
        _, ended, _, reached = self.fmu.doStep(time, size, is_final)
        if ended:
            raise RunError(f"model {self.model.name} ended the run at t = {reached:.12g} s")


def make_partner(model: Model, inputs: Sequence[str]) -> Partner:
    """Instantiate a model whose connected inputs are these.

    Raises
    ------
    FmuError
        If it cannot be loaded or instantiated, with its own message.
    """
    return (_Fmi2 if model.fmi == 2 else _Fmi3)(model, inputs)
