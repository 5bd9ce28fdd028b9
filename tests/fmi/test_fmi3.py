"""What is FMI 3.0's own: exported names, the order of calls, intermediate update, what is not offered."""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from tests.conftest import Unpacked
from tests.fmi.test_fmi2 import cubic
from tests.fmu_helpers import Host

HEADER = Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h"
FUNCTIONS = re.findall(r"^\s*FMI3_Export\s+fmi3\w+TYPE\s+(fmi3\w+);", HEADER.read_text(), re.MULTILINE)


def test_every_function_of_the_header_is_exported(unpacked: Unpacked) -> None:
    (library,) = unpacked("load", 3).glob("binaries/*/*.so")
    exported = ctypes.CDLL(str(library))
    assert len(FUNCTIONS) == 75
    assert [name for name in FUNCTIONS if not hasattr(exported, name)] == []


Call = Callable[[Host], object]
TOO_EARLY: list[tuple[str, Call, str]] = [
    ("cs", lambda h: h.step(0.0, 0.1), "fmi3DoStep is not allowed before initialization (Co-Simulation)"),
    ("cs", lambda h: h.fmu.exitInitializationMode(), "fmi3ExitInitializationMode is not allowed before"),
    ("cs", lambda h: h.fmu.terminate(), "fmi3Terminate is not allowed before initialization"),
    ("cs", lambda h: h.fmu.enterStepMode(), "fmi3EnterStepMode is not allowed before"),
    ("me", lambda h: h.fmu.enterContinuousTimeMode(), "not allowed before initialization (Model Exchange)"),
    ("me", lambda h: h.fmu.updateDiscreteStates(), "fmi3UpdateDiscreteStates is not allowed before"),
    ("me", lambda h: h.fmu.setTime(1.0), "fmi3SetTime is not allowed before"),
    ("me", lambda h: h.derivatives(), "fmi3GetContinuousStateDerivatives is not allowed before"),
]


@pytest.mark.parametrize(("interface", "call", "says"), TOO_EARLY)
def test_before_initialization(interface: str, call: Call, says: str, unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3), interface=interface) as host:
        assert says in host.refusal(call, host)


def test_during_and_after_the_run(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3)) as host:
        host.initialize()
        again = host.refusal(host.enter_initialization)
        assert again.startswith("fmi3EnterInitializationMode is not allowed between communication steps")
        host.fmu.terminate()
        assert math.isfinite(host.get("x_c")[0])
        assert "fmi3DoStep is not allowed after termination" in host.refusal(host.step, 0.0, 0.1)


def test_states_are_set_in_continuous_time_only(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3), interface="me") as host:
        host.initialize()
        host.fmu.enterEventMode()
        assert "fmi3SetContinuousStates is not allowed in event mode" in host.refusal(host.set_states, host.states())
        assert host.fmu.updateDiscreteStates() == (False, False, False, False, False, 0.0)


def test_sizes_are_told(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3), interface="me") as host:
        size = ctypes.c_size_t(99)
        host.fmu.fmi3GetNumberOfContinuousStates(host.fmu.component, ctypes.byref(size))
        assert size.value == 12
        host.fmu.fmi3GetNumberOfEventIndicators(host.fmu.component, ctypes.byref(size))
        assert size.value == 0


def test_as_many_values_as_references(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3)) as host:
        references = (ctypes.c_uint32 * 2)(0, 1)
        for kind in ("GetFloat64", "SetFloat64", "GetInt64", "SetInt64"):
            values = (ctypes.c_double * 2)() if kind.endswith("Float64") else (ctypes.c_int64 * 2)()
            call = getattr(host.fmu, f"fmi3{kind}")
            says = host.refusal(call, host.fmu.component, references, 2, values, 1)
            assert "as many values as references are expected" in says
            assert "a null pointer was given" in host.refusal(call, host.fmu.component, None, 2, None, 2)


NOT_OFFERED = {
    "ConfigurationMode$": "there are no structural parameters",
    "(Interval|Shift)(Decimal|Fraction)$": "the cable has no clocks",
    "Dependencies$": "dependencies do not change",
}


@pytest.mark.parametrize(("pattern", "says"), NOT_OFFERED.items())
def test_what_the_description_does_not_offer_is_refused(pattern: str, says: str, unpacked: Unpacked) -> None:
    names = [name for name in FUNCTIONS if re.search(pattern, name)]
    with Host(unpacked("load", 3)) as host:
        for name in names:
            assert host.raw(name, *[None] * 10) == 3
            assert says in host.messages[-1]
    assert len(names) == len(host.messages) >= 2


@pytest.mark.parametrize("kind", ["Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "UInt64", "Boolean",
                                  "String"])  # fmt: skip
def test_other_types_have_no_variables(kind: str, unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3)) as host:
        for way in ("Get", "Set"):
            name, reference = f"fmi3{way}{kind}", ctypes.c_uint32(0)
            assert host.raw(name, ctypes.byref(reference), ctypes.c_size_t(1), None, ctypes.c_size_t(1)) == 3
            says = "the cable has no variables but those of type Float64, the Enumeration solver"
            assert host.messages[-1].startswith(says)
            assert host.raw(name, None, ctypes.c_size_t(0), None, ctypes.c_size_t(0)) == 0


def test_scheduled_execution_is_not_offered(unpacked: Unpacked) -> None:
    (library,) = unpacked("load", 3).glob("binaries/*/*.so")
    assert not ctypes.CDLL(str(library)).fmi3InstantiateScheduledExecution(*[None] * 10)


# --- intermediate update ---


def test_intermediate_update_is_the_force_inside_a_step(unpacked: Unpacked) -> None:
    """One step of 1 s in which the FMU asks for a cubic, against 4,000 steps that hold its midpoint value."""
    asked: list[float] = []

    def tell(host: Host, time: float) -> None:
        asked.append(time)
        host.set(u_m1=cubic(time))

    outputs = ("y_m1", "v_m1", "x_c", "vx_c")
    with Host(unpacked("load", 3), ask=tell) as host:
        host.initialize(u_m1=cubic(0.0))
        host.step(0.0, 1.0)
        by_asking = host.get(*outputs)
        assert host.get("u_m1") == [cubic(1.0)]
    with Host(unpacked("load", 3)) as host:
        host.initialize()
        count = 4000
        for k in range(count):
            host.set(u_m1=cubic((k + 0.5) / count))
            host.step(k / count, 1.0 / count)
        held = host.get(*outputs)
    assert min(asked) == 0.0
    assert max(asked) == 1.0
    # Holding midpoint values errs by u'' h^2 / 24 = 2e-6 N; the rest is the tolerance of 1e-6.
    np.testing.assert_allclose(by_asking, held, rtol=2e-6, atol=1e-6)


def test_both_versions_follow_a_force_alike(unpacked: Unpacked) -> None:
    """The FMU asks at the same stages at which it evaluates the polynomial: equal but for its rounding."""
    with Host(unpacked("load", 3), ask=lambda host, time: host.set(u_m1=cubic(time))) as host:
        host.initialize(u_m1=cubic(0.0))
        host.step(0.0, 1.0)
        by_asking = host.get("y_m1", "x_c", "solver.rhs")
    with Host(unpacked("load", 2)) as host:
        host.initialize(u_m1=cubic(0.0))
        host.fmu.setRealInputDerivatives([host.reference["u_m1"]] * 3, [1, 2, 3], [-200.0, 600.0, -900.0])
        host.step(0.0, 1.0)
        by_derivatives = host.get("y_m1", "x_c", "solver.rhs")
    np.testing.assert_allclose(by_asking, by_derivatives, rtol=1e-11)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_no_step_goes_on_with_a_force_that_was_refused(value: float, unpacked: Unpacked) -> None:
    codes: list[int] = []

    def tell(host: Host, time: float) -> None:
        reference, force = ctypes.c_uint32(host.reference["u_m1"]), ctypes.c_double(value if time > 0.25 else 10.0)
        one = ctypes.c_size_t(1)
        codes.append(host.raw("fmi3SetFloat64", ctypes.byref(reference), one, ctypes.byref(force), one))

    with Host(unpacked("load", 3), ask=tell) as host:
        host.initialize()
        host.step(0.0, 0.2)
        with pytest.raises(FMICallException):
            host.step(0.2, 0.2)
        assert codes[-1] == 3
        assert host.messages[0].startswith(f"u_m1 = {value} at t = 0.2")
        assert "an input is not a finite number, or the host gave none" in host.messages[-1]
        assert host.get("u_m1") == [10.0]
        assert "not allowed after an error" in host.refusal(host.step, 0.2, 0.2)


def test_parameters_cannot_be_set_inside_a_step(unpacked: Unpacked) -> None:
    codes: list[int] = []

    def tell(host: Host, time: float) -> None:
        reference, value = ctypes.c_uint32(host.reference["m_c"]), ctypes.c_double(1.0)
        one = ctypes.c_size_t(1)
        codes.append(host.raw("fmi3SetFloat64", ctypes.byref(reference), one, ctypes.byref(value), one))

    with Host(unpacked("load", 3), ask=tell) as host:
        host.initialize()
        with pytest.raises(FMICallException):
            host.step(0.0, 0.1)
        assert codes == [3]
        assert "m_c = 1 at t = 0 s: parameters and start values are fixed" in host.messages[0]
