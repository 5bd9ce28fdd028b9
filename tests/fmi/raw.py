"""An instance driven through the bare functions of the library, which is told everything and protected from nothing."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Literal

from fmpy import fmi2, fmi3, read_model_description

__all__ = ["Interface", "Raw", "boolean", "double", "integers", "numbers", "references", "size"]

Interface = Literal["me", "cs"]

double, size = ctypes.c_double, ctypes.c_size_t


def numbers(*values: float) -> Any:
    """double[]"""
    return (ctypes.c_double * len(values))(*values)


def integers(*values: int) -> Any:
    """fmi2Integer[] or fmi3Int32[]"""
    return (ctypes.c_int32 * len(values))(*values)


def references(*values: int) -> Any:
    """fmi2ValueReference[] or fmi3ValueReference[]"""
    return (ctypes.c_uint32 * len(values))(*values)


def boolean(fmi: int, value: bool) -> Any:
    """fmi2Boolean is an int, fmi3Boolean a bool of C."""
    return ctypes.c_int(value) if fmi == 2 else ctypes.c_bool(value)


class Raw(AbstractContextManager["Raw"]):
    """One instance, with every message that it logged.

    Parameters
    ----------
    folder
        Of an unpacked FMU.
    interface
        Model Exchange or Co-Simulation.
    inside
        Called at every intermediate update (FMI 3) with this instance, the time [s], whether inputs are asked for,
        outputs can be read, the step is finished and may be ended; the time at which to return early [s], or None.
    listen
        Names of the variables for it.
    returns_early
        earlyReturnAllowed.
    """

    def __init__(
        self, folder: Path, interface: Interface, *, inside: Callable[..., float | None] | None = None,
        listen: tuple[str, ...] = (), returns_early: bool = False, **words: Any,
    ) -> None:  # fmt: skip
        self.description = read_model_description(str(folder), validate=False)
        self.fmi = int(self.description.fmiVersion[0])
        self.interface = interface
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        (path,) = folder.glob("binaries/*/*.so")
        self.library = ctypes.CDLL(str(path))
        self.messages: list[tuple[int, str, str]] = []
        self.handle, self.image = ctypes.c_void_p(), b"no state"
        self._inside, self._callbacks, self._handles = inside, [], []
        resources = words.get("location", str(folder / "resources"))
        token = words.get("token", self.description.guid).encode()
        if self.fmi == 2:
            self.pointer = self._open2(resources, token, words.get("kind", interface == "cs"))
        else:
            self.pointer = self._open3(resources, token, listen, returns_early, words.get("event_mode", False))

    def _open2(self, resources: str, token: bytes, kind: int) -> int | None:
        def log(_: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
            self.messages.append((status, category.decode(), message.decode()))

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
        self._callbacks = [callbacks]
        create = self.library.fmi2Instantiate
        create.restype = ctypes.c_void_p
        uri = Path(resources).as_uri().encode()
        pointer: int | None = create(b"raw", ctypes.c_int(kind), token, uri, ctypes.byref(callbacks), 0, 1)
        return pointer

    def _open3(
        self, resources: str, token: bytes, listen: tuple[str, ...], returns_early: bool, event_mode: bool
    ) -> int | None:
        def log(_: Any, status: int, category: bytes, message: bytes) -> None:
            self.messages.append((status, category.decode(), message.decode()))

        def update(
            _: Any, time: float, asked: bool, readable: bool, finished: bool, may_return: bool, early: Any, at: Any
        ) -> None:
            assert self._inside
            wish = self._inside(self, time, asked, readable, finished, may_return)
            if wish is not None:
                early[0], at[0] = True, wish

        no, yes = ctypes.c_bool(False), ctypes.c_bool(True)
        self._callbacks = [fmi3.fmi3LogMessageCallback(log), fmi3.fmi3IntermediateUpdateCallback(update)]
        start = (b"raw", token, resources.encode(), no, yes)
        if self.interface == "me":
            create = self.library.fmi3InstantiateModelExchange
            create.restype = ctypes.c_void_p
            pointer: int | None = create(*start, None, self._callbacks[0])
            return pointer
        create = self.library.fmi3InstantiateCoSimulation
        create.restype = ctypes.c_void_p
        wanted = references(*(self.reference[name] for name in listen))
        pointer = create(
            *start, ctypes.c_bool(event_mode), ctypes.c_bool(returns_early), wanted, size(len(listen)), None,
            self._callbacks[0], self._callbacks[1] if self._inside else None,
        )  # fmt: skip
        return pointer

    def __exit__(self, *_: object) -> None:
        if self.pointer:
            for handle in self._handles:
                self(f"Free{self._state}", ctypes.byref(handle))
            self("FreeInstance")
            self.pointer = None

    @property
    def _state(self) -> str:
        return "FMUstate" if self.fmi == 2 else "FMUState"

    def offers(self, function: str) -> bool:
        """Whether the description promises the functions of the complete state."""
        part = self.description.coSimulation if self.interface == "cs" else self.description.modelExchange
        return self._state not in function or bool(part.canGetAndSetFMUstate) or function.startswith("Free")

    def new_handle(self) -> Any:
        """Of a state, to be freed before the instance."""
        self._handles.append(ctypes.c_void_p())
        return self._handles[-1]

    def remember_state(self) -> None:
        """The present state as `handle` and `image`, if that is offered."""
        if not self.offers(f"Get{self._state}"):
            return
        self.handle, count = self.new_handle(), size()
        self.must(f"Get{self._state}", ctypes.byref(self.handle))
        self.must(f"Serialized{self._state}Size", self.handle, ctypes.byref(count))
        buffer = ctypes.create_string_buffer(count.value)
        self.must(f"Serialize{self._state}", self.handle, buffer, count)
        self.image = buffer.raw

    def __call__(self, function: str, *arguments: Any) -> int:
        """Status of a function whose name comes without the version of FMI; it does not matter for FreeInstance."""
        status: int = getattr(self.library, f"fmi{self.fmi}{function}")(ctypes.c_void_p(self.pointer), *arguments)
        return status

    def must(self, function: str, *arguments: Any) -> None:
        """The same where OK is expected."""
        status = self(function, *arguments)
        assert status == 0, (function, status, self.messages)

    def initialize(self, *, stop: float | None = None, tolerance: float = 1e-6) -> Raw:
        """To the end of initialization mode, from 0 s."""
        times = (double(0.0), boolean(self.fmi, stop is not None), double(stop or 0.0))
        experiment = (boolean(self.fmi, True), double(tolerance), *times)
        if self.fmi == 2:
            self.must("SetupExperiment", *experiment)
            self.must("EnterInitializationMode")
        else:
            self.must("EnterInitializationMode", *experiment)
        self.must("ExitInitializationMode")
        return self

    def get(self, *names: str) -> list[float]:
        """Real values."""
        values, one = numbers(*(0.0 for _ in names)), size(len(names))
        wanted = references(*(self.reference[name] for name in names))
        if self.fmi == 2:
            self.must("GetReal", wanted, one, values)
        else:
            self.must("GetFloat64", wanted, one, values, one)
        return list(values)

    def set(self, **values: float) -> int:
        """The status."""
        wanted, given = references(*(self.reference[name] for name in values)), numbers(*values.values())
        count = size(len(values))
        if self.fmi == 2:
            return self("SetReal", wanted, count, given)
        return self("SetFloat64", wanted, count, given, count)

    def step(self, time: float, length: float) -> tuple[int, bool, float]:
        """Status of a communication step, and of FMI 3 whether it returned early and the time reached [s]."""
        if self.fmi == 2:
            return self("DoStep", double(time), double(length), boolean(2, True)), False, time + length
        event, end, early, reached = ctypes.c_bool(True), ctypes.c_bool(True), ctypes.c_bool(True), double()
        answer = [ctypes.byref(word) for word in (event, end, early, reached)]
        status = self("DoStep", double(time), double(length), ctypes.c_bool(True), *answer)
        assert status or not (event.value or end.value)
        return status, early.value, reached.value
