"""One FMU instance through FMPy, driven from one output time to the next.

Four drivers with one face: FMI 2 and 3, Co-Simulation (the FMU integrates) and Model Exchange (FMPy's
CVode integrates).
"""

from __future__ import annotations

import ctypes
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, MutableSequence, Sequence
from contextlib import chdir
from typing import Any, Protocol

from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException
from fmpy.sundials import CVodeSolver
from fmpy.sundials.libraries import sundials_cvode

from .errors import FmuError, RunError
from .feed import Feed
from .reals import Reals, Slopes

__all__ = ["Driver", "fmi2_callbacks", "make_driver"]

_SLIVER = 8.0  # units in the last place: rounding puts a jump beside an output time, and CVode takes no such step
_MEASURES = ("step_size", "error_estimate", "energy_residual")  # of the solver's health: the rest are counts
_MOST_STEPS = 1_000_000  # of CVode within one output interval; bounded work instead of a hang


class Driver(Protocol):
    """An instance between instantiate and free."""

    messages: list[str]

    def start(
        self, start: float, stop: float, tolerance: float, numbers: Mapping[int, float], choices: Mapping[int, int]
    ) -> None:
        """Initialise, with these variables set before: numbers and integers (enumerations, sizes), by reference."""

    def resize(self, choices: Mapping[int, int]) -> None:
        """Set what of these integers are sizes of arrays, before resume()."""

    def resume(self, image: bytes) -> None:
        """Instead of start(): on from a state that save() gave."""

    def save(self) -> bytes:
        """The FMU's complete state, serialized."""

    def get(self, references: Sequence[int]) -> list[float]:
        """Values of variables at the present time."""

    def advance(self, time: float, end: float) -> None:
        """From `time` to `end`, between which no force jumps."""

    def counters(self) -> dict[str, float]:
        """What the solver that ran tells of itself so far; whole numbers are int."""

    def close(self) -> None:
        """Free the instance and its library."""


class _Base(ABC):
    """What all four share: messages, variables by name, the complete state, errors as `RunError`."""

    state_functions: tuple[str, ...]
    """FMPy's names, which differ between the versions: get, set, free, serialize, deserialize."""

    def __init__(self, description: Any, feed: Feed) -> None:
        self.messages: list[str] = []
        self.feed = feed
        self.reference = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.inputs = [self.reference[name] for name in feed.names]
        self._asked: dict[tuple[int, ...], Reals] = {}
        self.fmu: Any = None

    def load(self, kind: type, description: Any, interface: Any, folder: str) -> None:
        """The library for this platform."""
        try:
            with chdir("."):  # FMPy stays in the library's folder if it cannot load it
                self.fmu = kind(
                    guid=description.guid, unzipDirectory=folder, modelIdentifier=interface.modelIdentifier,
                    instanceName=description.modelName,
                )  # fmt: skip
        except Exception as error:  # FMPy raises a bare Exception where there is none, ctypes an OSError
            raise FmuError(f"the FMU's library cannot be loaded: {error}") from None

    def close(self) -> None:
        if self.fmu is not None and self.fmu.component is not None:
            self.fmu.freeInstance()
            self.fmu = None

    def remembered(self, references: Sequence[int], make: Callable[[], Reals]) -> Reals:
        """The same variables are asked for at every output time."""
        key = tuple(references)
        if key not in self._asked:
            self._asked[key] = make()
        return self._asked[key]

    def resize(self, choices: Mapping[int, int]) -> None:  # noqa: B027
        """Nothing without arrays."""

    def failed(self, what: str) -> RunError:
        return RunError(self.messages[-1] if self.messages else f"{what} failed without a message")

    def resume(self, image: bytes) -> None:
        _, put, free, _, deserialize = (getattr(self.fmu, name) for name in self.state_functions)
        state = self._call("deserializing the state", deserialize, image)
        self._call("setting the state", put, state)
        self._call("freeing the state", free, state)

    def save(self) -> bytes:
        get, _, free, serialize, _ = (getattr(self.fmu, name) for name in self.state_functions)
        state = self._call("getting the state", get)
        image: bytes = self._call("serializing the state", serialize, state)
        self._call("freeing the state", free, state)
        return image

    def counters(self) -> dict[str, float]:
        names = [name for name in self.reference if name.startswith("solver.")]
        values = self.get([self.reference[name] for name in names])
        counted = {name.removeprefix("solver."): value for name, value in zip(names, values, strict=True)}
        return {name: value if name in _MEASURES else int(value) for name, value in counted.items()}

    @abstractmethod
    def get(self, references: Sequence[int]) -> list[float]:
        """Values of variables at the present time."""

    @abstractmethod
    def set_inputs(self, values: Sequence[float]) -> None:
        """Set every force input [N]."""

    def _call(self, what: str, function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except FMICallException:
            raise self.failed(what) from None


def fmi2_callbacks(messages: MutableSequence[str]) -> fmi2.fmi2CallbackFunctions:
    """What FMI 2 asks of a host, with a logger that adds to `messages`; to be kept as long as the instance."""

    def log(environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        # The message is a format: "100%%" means 100%.
        messages.append(message.decode("utf-8", "replace").replace("%%", "%"))

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
    return callbacks


class _Fmi2(_Base):
    """Life cycle and variables of FMI 2."""

    state_functions = ("getFMUstate", "setFMUstate", "freeFMUstate", "serializeFMUstate", "deSerializeFMUstate")

    def instantiate(self, kind: type, description: Any, interface: Any, folder: str) -> None:
        self.load(kind, description, interface, folder)

        callbacks = self._callbacks = fmi2_callbacks(self.messages)  # must outlive the instance
        # pythonfmu, the library of twins, keeps even its errors to itself when logging is off.
        _instantiate(self, lambda: self.fmu.instantiate(callbacks=callbacks, loggingOn=True))

    def start(
        self, start: float, stop: float, tolerance: float, numbers: Mapping[int, float], choices: Mapping[int, int]
    ) -> None:
        self._call("fmi2SetupExperiment", self.fmu.setupExperiment, tolerance=tolerance, startTime=start, stopTime=stop)
        self._call("fmi2SetReal", self.fmu.setReal, list(numbers), list(numbers.values()))
        self._call("fmi2SetInteger", self.fmu.setInteger, list(choices), list(choices.values()))
        self._call("fmi2EnterInitializationMode", self.fmu.enterInitializationMode)
        self._call("fmi2SetReal", self.fmu.setReal, self.inputs, self.feed.values(start))
        self._call("fmi2ExitInitializationMode", self.fmu.exitInitializationMode)
        self.started(start, tolerance)

    def started(self, start: float, tolerance: float) -> None:
        """Hook for what an interface does after initialisation."""

    def get(self, references: Sequence[int]) -> list[float]:
        reals = self.remembered(references, lambda: Reals(2, references))
        found: list[float] = self._call("fmi2GetReal", reals.get, self.fmu)
        return found

    def set_inputs(self, values: Sequence[float]) -> None:
        reals = self.remembered(self.inputs, lambda: Reals(2, self.inputs))
        self._call("fmi2SetReal", reals.set, self.fmu, values)


class Fmi2CoSimulation(_Fmi2):
    """The FMU integrates; forces follow their derivatives inside a step, if it takes any (a twin does not)."""

    def __init__(self, description: Any, folder: str, feed: Feed) -> None:
        super().__init__(description, feed)
        self._interpolates = description.coSimulation.canInterpolateInputs
        self._slopes = Slopes(self.inputs, feed.orders)
        self.instantiate(fmi2.FMU2Slave, description, description.coSimulation, folder)

    def advance(self, time: float, end: float) -> None:
        if not self._interpolates:
            self._hold(time, end)
            return
        while time < end:
            reach = self.feed.polynomial_reach(time, end)
            values, derivatives = self.feed.values_and_derivatives(time)
            self.set_inputs(values)
            self._call("fmi2SetRealInputDerivatives", self._slopes.set, self.fmu, derivatives)
            self._call(
                "fmi2DoStep", self.fmu.doStep, currentCommunicationPoint=time, communicationStepSize=reach - time
            )
            time = reach

    def _hold(self, time: float, end: float) -> None:
        """One step under the forces and accelerations in its middle: an error of second order in the step."""
        self.set_inputs(self.feed.values_to_hold(time, end))
        self._call("fmi2DoStep", self.fmu.doStep, currentCommunicationPoint=time, communicationStepSize=end - time)
        self.set_inputs(self.feed.values_before(end, end))


class _Fmi3(_Base):
    """Life cycle and variables of FMI 3."""

    state_functions = ("getFMUState", "setFMUState", "freeFMUState", "serializeFMUState", "deserializeFMUState")

    def __init__(self, description: Any, feed: Feed) -> None:
        super().__init__(description, feed)
        variables = {variable.valueReference: variable for variable in description.modelVariables}
        self._structural = {reference for reference, v in variables.items() if v.causality == "structuralParameter"}
        self._size = {reference: int(variables[reference].start) for reference in self._structural}
        self._dimension = {r: v.dimensions[0].valueReference for r, v in variables.items() if v.dimensions}

    def make(self, kind: type, description: Any, interface: Any, folder: str) -> None:
        self.load(kind, description, interface, folder)

        def log(environment: Any, status: int, category: bytes, message: bytes) -> None:
            self.messages.append(message.decode("utf-8", "replace"))

        self._log = log

    def start(
        self, start: float, stop: float, tolerance: float, numbers: Mapping[int, float], choices: Mapping[int, int]
    ) -> None:
        self.resize(choices)
        choices = {reference: value for reference, value in choices.items() if reference not in self._structural}
        self._call("fmi3SetFloat64", self.fmu.setFloat64, list(numbers), list(numbers.values()))
        self._call("fmi3SetInt64", self.fmu.setInt64, list(choices), list(choices.values()))
        self._call(
            "fmi3EnterInitializationMode",
            self.fmu.enterInitializationMode,
            tolerance=tolerance,
            startTime=start,
            stopTime=stop,
        )
        self._call("fmi3SetFloat64", self.fmu.setFloat64, self.inputs, self.feed.values(start))
        self._call("fmi3ExitInitializationMode", self.fmu.exitInitializationMode)
        self.started(start, tolerance)

    def started(self, start: float, tolerance: float) -> None:
        """Hook for what an interface does after initialisation."""

    def get(self, references: Sequence[int]) -> list[float]:
        reals = self.remembered(references, lambda: Reals(3, references, self._count(references)))
        found: list[float] = self._call("fmi3GetFloat64", reals.get, self.fmu)
        return found

    def _count(self, references: Sequence[int]) -> int:
        """Number of values."""
        return sum(self._size[self._dimension[r]] if r in self._dimension else 1 for r in references)

    def resize(self, choices: Mapping[int, int]) -> None:
        """In configuration mode, where arrays get other sizes."""
        sizes = {reference: value for reference, value in choices.items() if reference in self._structural}
        if not sizes:
            return
        self._call("fmi3EnterConfigurationMode", self.fmu.enterConfigurationMode)
        self._call("fmi3SetUInt64", self.fmu.setUInt64, list(sizes), list(sizes.values()))
        self._call("fmi3ExitConfigurationMode", self.fmu.exitConfigurationMode)
        self._size |= sizes
        self._asked.clear()

    def set_inputs(self, values: Sequence[float]) -> None:
        reals = self.remembered(self.inputs, lambda: Reals(3, self.inputs))
        self._call("fmi3SetFloat64", reals.set, self.fmu, values)


class Fmi3CoSimulation(_Fmi3):
    """The FMU integrates; inside a step it asks for the forces (intermediate update)."""

    def __init__(self, description: Any, folder: str, feed: Feed) -> None:
        super().__init__(description, feed)
        self._end = 0.0
        self.make(fmi3.FMU3Slave, description, description.coSimulation, folder)
        self._references = (ctypes.c_uint32 * len(self.inputs))(*self.inputs)
        self._values = (ctypes.c_double * len(self.inputs))()

        def update(environment: Any, time: float, *_: Any) -> None:
            self._values[:] = self.feed.values_before(time, self._end)  # type: ignore[assignment]  # ctypes converts
            count = len(self.inputs)
            self.fmu.fmi3SetFloat64(self.fmu.component, self._references, count, self._values, count)

        asked = {"requiredIntermediateVariables": self.inputs, "intermediateUpdate": update} if feed.varies else {}
        _instantiate(self, lambda: self.fmu.instantiate(logMessage=self._log, **asked))

    def advance(self, time: float, end: float) -> None:
        self._end = end
        self.set_inputs(self.feed.values(time))
        self._call("fmi3DoStep", self.fmu.doStep, currentCommunicationPoint=time, communicationStepSize=end - time)


class _ModelExchange(_Base):
    """FMPy's CVode (BDF, dense Jacobian by differences) integrates."""

    number_of_states: int

    def begin(
        self, start: float, tolerance: float, set_time: Callable[[float], None], call: dict[str, Callable[..., Any]]
    ) -> None:
        self._error: RunError | None = None
        self._limit = self._jump = float("inf")
        self._evaluations = 0
        self._counted = {"steps": 0, "rejected": 0}
        self._set_time = set_time

        def at(time: float) -> None:
            set_time(time)
            self.set_inputs(self.feed.values_before(time, self._jump))

        def derivatives(pointer: Any, count: int) -> None:
            self._evaluations += 1
            call["get_derivatives"](pointer, count)

        self._solver = CVodeSolver(
            nx=self.number_of_states, nz=0, get_x=call["get_states"], set_x=self._guarded(call["set_states"]),
            get_dx=self._guarded(derivatives), get_z=lambda *_: None, get_nominals=call["get_nominals"],
            set_time=self._guarded(at), input=None, startTime=start, relativeTolerance=tolerance,
            maxNumSteps=_MOST_STEPS,
        )  # fmt: skip

    def _guarded(self, function: Callable[..., None]) -> Callable[..., None]:
        """An error inside CVode's call-back cannot pass through C: remember it, raise it after the step."""

        def guarded(*arguments: Any) -> None:
            if self._error is not None:
                return
            try:
                function(*arguments)
            except RunError as error:
                self._error = error
            except FMICallException:
                self._error = self.failed("an evaluation")

        return guarded

    def advance(self, time: float, end: float) -> None:
        # CVode steps past `end` and interpolates: beyond the next jump it must not see the force after it.
        jump = self.feed.next_break(time, float("inf"))
        if end - time <= _SLIVER * math.ulp(end):
            self._set_time(end)
            self.set_inputs(self.feed.values_before(end, jump))
            return
        if jump != self._jump:
            self._jump = jump
            self._add_cvode_counters()
            self._solver.reset(time)
        try:
            self._solver.step(time, end)
        except RuntimeError as error:
            # FMPy's text goes "... function, source file: At t = ..., reason".
            raise self._error or RunError(f"CVode gave up: {str(error).rpartition('.c: ')[2]}") from None
        if self._error is not None:
            raise self._error
        self._set_time(end)
        self.set_inputs(self.feed.values_before(end, self._jump))

    def counters(self) -> dict[str, float]:
        self._add_cvode_counters()  # the FMU's own stay where they started
        return {**self._counted, "rhs": self._evaluations}

    def _add_cvode_counters(self) -> None:
        """CVode counts from its last reset: add up before every reset and at the end."""
        for name, function in (("steps", "CVodeGetNumSteps"), ("rejected", "CVodeGetNumErrTestFails")):
            count = ctypes.c_long()
            get = getattr(sundials_cvode, function)
            get.argtypes = [ctypes.c_void_p, ctypes.POINTER(ctypes.c_long)]
            get(self._solver.cvode_mem, ctypes.byref(count))
            self._counted[name] += count.value


class Fmi2ModelExchange(_ModelExchange, _Fmi2):
    """FMI 2 under CVode."""

    def __init__(self, description: Any, folder: str, feed: Feed) -> None:
        super().__init__(description, feed)
        self.number_of_states = description.numberOfContinuousStates
        self.instantiate(fmi2.FMU2Model, description, description.modelExchange, folder)

    def started(self, start: float, tolerance: float) -> None:
        self._call("fmi2NewDiscreteStates", self.fmu.newDiscreteStates)
        self._call("fmi2EnterContinuousTimeMode", self.fmu.enterContinuousTimeMode)
        self.begin(start, tolerance, lambda time: self._call("fmi2SetTime", self.fmu.setTime, time), {
            "get_states": self.fmu.getContinuousStates, "set_states": self.fmu.setContinuousStates,
            "get_derivatives": self.fmu.getDerivatives, "get_nominals": self.fmu.getNominalsOfContinuousStates,
        })  # fmt: skip


class Fmi3ModelExchange(_ModelExchange, _Fmi3):
    """FMI 3 under CVode."""

    def __init__(self, description: Any, folder: str, feed: Feed) -> None:
        super().__init__(description, feed)
        self.make(fmi3.FMU3Model, description, description.modelExchange, folder)
        _instantiate(self, lambda: self.fmu.instantiate(logMessage=self._log))

    def started(self, start: float, tolerance: float) -> None:
        self._call("fmi3UpdateDiscreteStates", self.fmu.updateDiscreteStates)
        self._call("fmi3EnterContinuousTimeMode", self.fmu.enterContinuousTimeMode)
        self.number_of_states = self._call("fmi3GetNumberOfContinuousStates", self.fmu.getNumberOfContinuousStates)
        self.begin(start, tolerance, lambda time: self._call("fmi3SetTime", self.fmu.setTime, time), {
            "get_states": self.fmu.getContinuousStates, "set_states": self.fmu.setContinuousStates,
            "get_derivatives": self.fmu.getContinuousStateDerivatives,
            "get_nominals": self.fmu.getNominalsOfContinuousStates,
        })  # fmt: skip


def _instantiate(driver: _Base, call: Callable[[], None]) -> None:
    try:
        call()
    except Exception as error:  # FMPy raises a bare Exception when the FMU returns NULL
        driver.fmu.component = None
        raise FmuError(driver.messages[-1] if driver.messages else str(error)) from None


def make_driver(fmi: int, interface: str, description: Any, folder: str, feed: Feed) -> Driver:
    """Instantiate the FMU in `folder` (an unpacked archive).

    Raises
    ------
    FmuError
        If it cannot be loaded or instantiated, with its own message.
    """
    kinds: dict[tuple[int, str], Callable[[Any, str, Feed], Driver]] = {
        (2, "cs"): Fmi2CoSimulation, (2, "me"): Fmi2ModelExchange,
        (3, "cs"): Fmi3CoSimulation, (3, "me"): Fmi3ModelExchange,
    }  # fmt: skip
    offered = description.coSimulation if interface == "cs" else description.modelExchange
    if (fmi, interface) not in kinds or offered is None:
        raise FmuError(f"the FMU offers no interface {interface} of FMI 2 or 3")
    return kinds[fmi, interface](description, folder, feed)
