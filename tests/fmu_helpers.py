"""Small scenes of every kind, and a host that drives their FMUs call by call, of either version of FMI."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Container, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import extract, fmi2, fmi3, read_model_description
from fmpy.fmi1 import FMICallException

from cablefmu.cable import Floats
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.platforms import for_this_machine
from cablefmu.scene import Scene

__all__ = [
    "KINDS",
    "SCENES",
    "Host",
    "from_equilibrium",
    "levered",
    "pushed",
    "small_scene",
    "unpack",
    "with_links",
    "with_parameters",
]

_LINKS = """
format = 1
description = "Five links, small and quick"
[cable]
links = 5
length = 20
diameter = 0.02
density = 7850
young_modulus = 8e10
joint_damping = 2.8
[run]
stop_time = 2
"""
_FLOATER = """
[top]
kind = "floater"
mass = 600
stiffness = 1200
damping = 240
"""
_DRIVEN = """
[inputs]
u_m1 = { signal = "sine", amplitude = 800, frequency = 0.5 }
"""
_CABLE = _LINKS + _FLOATER + _DRIVEN
_WATER = "[water]\nCd = 1.0\n"
_HANGING = '[shape]\nkind = "straight"\nangle = 0.5\n'
_HELD = 'position = [12, 13]\n[shape]\nkind = "catenary"\n'
_SPRINGS = (
    "stiffness_horizontal = 5e3\ndamping_horizontal = 300\nstiffness_vertical = 4e3\ndamping_vertical = 200\n" + _HELD
)
_LOAD = '[terminal]\nkind = "load"\nmass = 60\nrotary_inertia = 50\n'
_SURGES = "stiffness_horizontal = 900\ndamping_horizontal = 150\n"
_MOVED = """
[top]
kind = "motion"
[inputs]
x_1 = { signal = "sine", amplitude = 0.4, frequency = 0.5, phase = "-90 deg", offset = 0.6 }
y_1 = { signal = "sine", amplitude = 0.3, frequency = 0.4, phase = "-90 deg", offset = 0.3 }
"""
_MOVED_BELOW = 'y_2 = { signal = "sine", amplitude = 0.2, frequency = 0.6, phase = "90 deg", offset = 12.7 }\n'

SCENES = {
    "air": _CABLE + _LOAD + _HANGING,
    "load": _CABLE + _WATER + _LOAD + "density = 7850\n" + _HANGING,
    "load-volume": _CABLE + _WATER + _LOAD + "volume = 0.01\n" + _HANGING,
    "anchor-mass": _CABLE + _WATER + '[terminal]\nkind = "anchor-mass"\nmass = 1e4\n' + _HELD,
    "anchor-spring": _CABLE + _WATER + '[terminal]\nkind = "anchor-spring"\nmass = 60\ndensity = 7850\n' + _SPRINGS,
    "pin": _CABLE + _WATER + '[terminal]\nkind = "pin"\n' + _HELD,
    "floater": _CABLE + _WATER + '[terminal]\nkind = "floater"\nmass = 500\nhorizontal_force = true\n' + _SPRINGS,
    "surge": _LINKS + _FLOATER + _SURGES + _DRIVEN + _WATER + '[terminal]\nkind = "pin"\n' + _HELD,
    "moved": _LINKS + _MOVED + _WATER + _LOAD + "density = 7850\n" + _HANGING,
    "between": _LINKS + _MOVED + _MOVED_BELOW + _WATER + '[terminal]\nkind = "motion"\n' + _HELD,
}
KINDS = tuple(SCENES)
"""Every terminal below a floater, in water and in air, buoyancy by density and by volume; then a floater that surges,
and ends whose motion is given, the top and both."""


def small_scene(kind: str) -> Scene:
    return Scene.from_text(SCENES[kind], name=kind)


def pushed(names: Container[str], time: float, force: float) -> dict[str, float]:
    """Inputs that move the top of any of these scenes: a force [N], or else a vessel that sets out from rest."""
    if "u_m1" in names:
        return {"u_m1": force}
    acceleration = 1e-3 * force
    return {"y_1": 0.5 * acceleration * time**2, "vy_1": acceleration * time, "ay_1": acceleration}


def levered(names: Container[str], values: Mapping[str, float]) -> dict[str, float]:
    """The same values for a top without a floater: of a force on that [N] a thousandth is its acceleration [m/s^2]."""
    if "u_m1" in names or "u_m1" not in values:
        return dict(values)
    return {name: value for name, value in values.items() if name != "u_m1"} | {"ay_1": 1e-3 * values["u_m1"]}


def with_parameters(scene: Scene, **values: float) -> Scene:
    """The same scene, built with other values: the way that does not go through the FMU's setters."""
    return replace(scene, cable=replace(scene.cable, parameters=scene.cable.parameters | values))


def from_equilibrium(scene: Scene) -> Scene:
    """The same scene, its run starting from the equilibrium near its shape."""
    return Scene.from_text(scene.text.replace("[run]\n", '[run]\ninitial = "equilibrium"\n'), name=scene.name)


def with_links(scene: Scene, n: int) -> Scene:
    """The same scene, written with so many links."""
    return Scene.from_text(scene.text.replace("links = 5", f"links = {n}"), name=scene.name)


def unpack(scene: Scene, folder: Path, fmi: int, *, arrays: bool = False) -> Path:
    """Build the scene's FMU and unpack it into a folder of its own."""
    target = folder / f"{scene.name}-{fmi}"
    extract(
        str(build_fmu(scene, folder / f"{scene.name}-{fmi}.fmu", fmi=fmi, arrays=arrays, platforms=for_this_machine())),
        unzipdir=str(target),
    )
    return target


class Host(AbstractContextManager["Host"]):
    """One instance through FMPy's bindings; names instead of references, FMI 2 and FMI 3 with one face."""

    def __init__(
        self, folder: Path, *, interface: str = "cs", token: str | None = None,
        ask: Callable[[Host, float], None] | None = None,
    ) -> None:  # fmt: skip
        self.description = read_model_description(str(folder), validate=False)
        self.fmi = int(self.description.fmiVersion[0])
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        self.enumerations = {v.name for v in self.description.modelVariables if v.type == "Enumeration"}
        self.messages: list[str] = []
        offered = self.description.coSimulation if interface == "cs" else self.description.modelExchange
        kinds = {
            (2, "cs"): fmi2.FMU2Slave, (2, "me"): fmi2.FMU2Model, (3, "cs"): fmi3.FMU3Slave, (3, "me"): fmi3.FMU3Model
        }  # fmt: skip
        self.fmu: Any = kinds[self.fmi, interface](
            guid=token or self.description.guid, unzipDirectory=str(folder), modelIdentifier=offered.modelIdentifier,
            instanceName=self.description.modelName,
        )  # fmt: skip
        try:
            self._instantiate(ask)
        except Exception as refused:  # FMPy's own, bare
            raise InstantiationRefusedError(self.messages) from refused

    def _instantiate(self, ask: Callable[[Host, float], None] | None) -> None:
        if self.fmi == 2:
            # As FMPy and other Python hosts have it: without the variable arguments of C.
            def log2(environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
                self.messages.append(message.decode())

            callbacks = fmi2.fmi2CallbackFunctions()
            callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log2)
            self.fmu.instantiate(callbacks=callbacks, loggingOn=True)  # pythonfmu says nothing otherwise
            return

        def log3(environment: Any, status: int, category: bytes, message: bytes) -> None:
            self.messages.append(message.decode())

        more: dict[str, Any] = {}
        if ask:
            inputs = [v.valueReference for v in self.description.modelVariables if v.causality == "input"]
            more = {"requiredIntermediateVariables": inputs, "intermediateUpdate": lambda _, time, *__: ask(self, time)}
        self.fmu.instantiate(logMessage=log3, **more)

    def __exit__(self, *_: object) -> None:
        self.fmu.freeInstance()

    def configure(self, n: int) -> Host:
        """As many links, in configuration mode."""
        self.fmu.enterConfigurationMode()
        self.fmu.setUInt64([self.reference["n"]], [n])
        self.fmu.exitConfigurationMode()
        return self

    def get_array(self, name: str) -> list[float]:
        """All elements, as many as there are links now."""
        (n,) = self.fmu.getUInt64([self.reference["n"]])
        return list(self.fmu.getFloat64([self.reference[name]], n))

    def names(self, *causalities: str) -> list[str]:
        return [v.name for v in self.description.modelVariables if v.causality in causalities]

    def get(self, *names: str) -> list[float]:
        if self.enumerations.isdisjoint(names):
            return self.get_reals([self.reference[name] for name in names])
        return [self.get_choice(name) if name in self.enumerations else self.get(name)[0] for name in names]

    def get_reals(self, references: Sequence[int]) -> list[float]:
        return list((self.fmu.getReal if self.fmi == 2 else self.fmu.getFloat64)(references))

    def get_choice(self, name: str) -> int:
        """Through the function for enumerations."""
        (value,) = (self.fmu.getInteger if self.fmi == 2 else self.fmu.getInt64)([self.reference[name]])
        return int(value)

    def set_choices(self, *choices: tuple[str, int]) -> None:
        """Through the function for enumerations, in one call."""
        write = self.fmu.setInteger if self.fmi == 2 else self.fmu.setInt64
        write([self.reference[name] for name, _ in choices], [value for _, value in choices])

    def set(self, **values: float) -> None:
        self.set_all(values)

    def set_all(self, values: Mapping[str, float]) -> None:
        references = [self.reference[name] for name in values]
        (self.fmu.setReal if self.fmi == 2 else self.fmu.setFloat64)(references, list(values.values()))

    def enter_initialization(self, start: float = 0.0, tolerance: float | None = None) -> None:
        if self.fmi == 2:
            self.fmu.setupExperiment(startTime=start, tolerance=tolerance)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=start, tolerance=tolerance)

    def initialize(self, **values: float) -> Host:
        """To step mode or continuous-time mode, with these values set before."""
        self.set_all(values)
        self.enter_initialization()
        self.fmu.exitInitializationMode()
        if hasattr(self.fmu, "setTime"):
            (self.fmu.newDiscreteStates if self.fmi == 2 else self.fmu.updateDiscreteStates)()
            self.fmu.enterContinuousTimeMode()
        return self

    def step(self, time: float, length: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def run(self, stop: float, step: float = 0.1) -> Floats:
        """All outputs at 0, step, ..., stop; shape (times, outputs)."""
        outputs = self.names("output")
        rows = [self.get(*outputs)]
        for k in range(round(stop / step)):
            self.step(k * step, step)
            rows.append(self.get(*outputs))
        return np.array(rows)

    def number_of_states(self) -> int:
        if self.fmi == 2:
            return int(self.description.numberOfContinuousStates)
        return int(self.fmu.getNumberOfContinuousStates())

    def states(self) -> Floats:
        x = np.zeros(self.number_of_states())
        self.fmu.getContinuousStates(_pointer(x), len(x))
        return x

    def set_states(self, x: Sequence[float] | Floats, count: int | None = None) -> None:
        values = np.array(x, dtype=float)
        self.fmu.setContinuousStates(_pointer(values), len(values) if count is None else count)

    def derivatives(self) -> Floats:
        dx = np.zeros(self.number_of_states())
        read = self.fmu.getDerivatives if self.fmi == 2 else self.fmu.getContinuousStateDerivatives
        read(_pointer(dx), len(dx))
        return dx

    # --- the complete state: FMPy's names differ between the versions ---

    def take(self) -> Any:
        return (self.fmu.getFMUstate if self.fmi == 2 else self.fmu.getFMUState)()

    def put(self, state: Any) -> Host:
        (self.fmu.setFMUstate if self.fmi == 2 else self.fmu.setFMUState)(state)
        return self

    def free(self, state: Any) -> None:
        (self.fmu.freeFMUstate if self.fmi == 2 else self.fmu.freeFMUState)(state)

    def image_of(self, state: Any) -> bytes:
        image = (self.fmu.serializeFMUstate if self.fmi == 2 else self.fmu.serializeFMUState)(state)
        assert isinstance(image, bytes)
        return image

    def state_in(self, image: bytes) -> Any:
        return (self.fmu.deSerializeFMUstate if self.fmi == 2 else self.fmu.deserializeFMUState)(image)

    def save(self) -> bytes:
        """The present state as bytes."""
        state = self.take()
        image = self.image_of(state)
        self.free(state)
        return image

    def load(self, image: bytes) -> Host:
        """On from a state that save() gave."""
        state = self.state_in(image)
        self.put(state)
        self.free(state)
        return self

    def raw(self, function: str, *arguments: Any) -> int:
        """Status of a call that FMPy has no wrapper for, or that must not raise."""
        status: int = getattr(ctypes.CDLL(self.fmu.dll._name), function)(
            ctypes.c_void_p(self.fmu.component), *arguments
        )
        return status

    def refusal(self, call: Callable[..., Any], *arguments: Any, **named: Any) -> str:
        """What the FMU says when it refuses this call."""
        before = len(self.messages)
        with pytest.raises(FMICallException) as refused:
            call(*arguments, **named)
        assert refused.value.status == 3, "fmi2Error and fmi3Error are 3"
        assert len(self.messages) == before + 1, "one message for one mistake"
        return self.messages[-1]


class InstantiationRefusedError(Exception):
    """The FMU returned no instance; its messages are the argument."""


def _pointer(values: Floats) -> Any:
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
