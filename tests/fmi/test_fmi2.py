"""What is FMI 2.0's own: exported names, the order of calls, input derivatives, the forms of its messages."""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import fmi2

from tests.conftest import Unpacked
from tests.fmu_helpers import Host

HEADER = Path(fmpy.__file__).parent / "c-code" / "fmi2Functions.h"
FUNCTIONS = re.findall(r"^\s*FMI2_Export\s+fmi2\w+TYPE\s+(fmi2\w+);", HEADER.read_text(), re.MULTILINE)


def test_every_function_of_the_header_is_exported(unpacked: Unpacked) -> None:
    (library,) = unpacked("load", 2).glob("binaries/*/*.so")
    exported = ctypes.CDLL(str(library))
    assert len(FUNCTIONS) == 44
    assert [name for name in FUNCTIONS if not hasattr(exported, name)] == []


def test_version_and_platform(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        assert (host.fmu.getVersion(), host.fmu.getTypesPlatform()) == ("2.0", "default")


Call = Callable[[Host], object]
TOO_EARLY: list[tuple[str, Call, str]] = [
    ("cs", lambda h: h.step(0.0, 0.1), "fmi2DoStep is not allowed before initialization (Co-Simulation)"),
    ("cs", lambda h: h.fmu.exitInitializationMode(), "fmi2ExitInitializationMode is not allowed before"),
    ("cs", lambda h: h.fmu.terminate(), "fmi2Terminate is not allowed before initialization"),
    ("me", lambda h: h.fmu.enterContinuousTimeMode(), "not allowed before initialization (Model Exchange)"),
    ("me", lambda h: h.fmu.newDiscreteStates(), "fmi2NewDiscreteStates is not allowed before"),
    ("me", lambda h: h.fmu.setTime(1.0), "fmi2SetTime is not allowed before"),
    ("me", lambda h: h.derivatives(), "fmi2GetDerivatives is not allowed before"),
]
TOO_LATE: list[tuple[str, Call, str]] = [
    ("cs", lambda h: h.fmu.setupExperiment(), "fmi2SetupExperiment is not allowed between communication steps"),
    ("cs", lambda h: h.fmu.enterInitializationMode(), "fmi2EnterInitializationMode is not allowed between"),
    ("cs", lambda h: h.fmu.exitInitializationMode(), "fmi2ExitInitializationMode is not allowed between"),
    ("me", lambda h: h.fmu.newDiscreteStates(), "fmi2NewDiscreteStates is not allowed in continuous-time mode"),
]


@pytest.mark.parametrize(("interface", "call", "says"), TOO_EARLY)
def test_before_initialization(interface: str, call: Call, says: str, unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2), interface=interface) as host:
        assert says in host.refusal(call, host)


@pytest.mark.parametrize(("interface", "call", "says"), TOO_LATE)
def test_during_the_run(interface: str, call: Call, says: str, unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2), interface=interface) as host:
        host.initialize()
        assert says in host.refusal(call, host)


def test_after_termination(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        host.initialize().run(0.1)
        host.fmu.terminate()
        assert math.isfinite(host.get("x_c")[0])
        assert "fmi2DoStep is not allowed after termination" in host.refusal(host.step, 0.1, 0.1)
        assert "fmi2SetReal is not allowed after termination" in host.refusal(host.set, u_m1=1.0)


def test_states_are_set_in_continuous_time_only(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2), interface="me") as host:
        host.initialize()
        host.fmu.enterEventMode()
        says = "fmi2SetContinuousStates is not allowed in event mode (Model Exchange)"
        assert host.refusal(host.set_states, host.states()) == says
        assert host.fmu.newDiscreteStates() == (0, 0, 0, 0, 0, 0.0)


def test_null_pointers_are_refused(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        says = host.refusal(host.fmu.fmi2GetReal, host.fmu.component, None, 1, None)
        assert says == "fmi2GetReal: a null pointer was given"
        host.fmu.fmi2GetReal(host.fmu.component, None, 0, None)  # nothing asked for, nothing wrong


def test_other_types_have_no_variables(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        for read in (host.fmu.getBoolean, host.fmu.getString):
            says = "the cable has no variables but those of type Real and the Enumeration solver"
            assert host.refusal(read, [0]) == says
            assert read([]) == []


def test_the_last_successful_time_is_told(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        host.initialize().run(0.3)
        host.set(F_cx=1e300)
        host.refusal(host.step, 0.3, 0.1)
        time = ctypes.c_double()
        host.fmu.fmi2GetRealStatus(host.fmu.component, 2, ctypes.byref(time))  # fmi2LastSuccessfulTime
        assert 0.3 <= time.value < 0.4


def test_messages_are_formats_of_c(unpacked: Unpacked, tmp_path: Path) -> None:
    """A C host puts the message through printf, where 100% alone would read past its arguments."""
    folder = unpacked("load", 2)
    missing = tmp_path / "100% %s"
    messages: list[bytes] = []
    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(lambda *arguments: messages.append(arguments[4]))
    with Host(folder) as host:
        instance = host.fmu.fmi2Instantiate(
            b"x", 1, b"{}", missing.as_uri().encode(), ctypes.byref(callbacks), False, False
        )
    assert instance is None
    shown = ctypes.create_string_buffer(1000)
    ctypes.CDLL(None).snprintf(shown, 1000, messages[0])
    assert shown.value.decode() == f"resource file {missing}/cable.bin: cannot be opened"


# --- input derivatives ---

CUBIC = (300.0, -200.0, 600.0, -900.0)
"""u, u', u'', u''' of u_m1 at t = 0 [N, N/s, ...]."""


def cubic(time: float) -> float:
    return sum(value * time**k / math.factorial(k) for k, value in enumerate(CUBIC))


def test_input_derivatives_are_the_force_inside_a_step(unpacked: Unpacked) -> None:
    """One step of 1 s with a cubic given by its derivatives, against 4,000 steps that hold its midpoint value."""
    with Host(unpacked("load", 2)) as host:
        host.initialize(u_m1=CUBIC[0])
        reference = host.reference["u_m1"]
        host.fmu.setRealInputDerivatives([reference] * 3, [1, 2, 3], list(CUBIC[1:]))
        host.step(0.0, 1.0)
        by_derivatives = host.get("y_m1", "v_m1", "x_c", "vx_c")
        (force,) = host.get("u_m1")
    with Host(unpacked("load", 2)) as host:
        host.initialize()
        count = 4000
        for k in range(count):
            host.set(u_m1=cubic((k + 0.5) / count))
            host.step(k / count, 1.0 / count)
        held = host.get("y_m1", "v_m1", "x_c", "vx_c")
    assert force == pytest.approx(cubic(1.0), rel=1e-14)
    # Holding midpoint values errs by u'' h^2 / 24 = 2e-6 N; the rest is the tolerance of 1e-6.
    np.testing.assert_allclose(by_derivatives, held, rtol=2e-6, atol=1e-6)


def test_input_derivatives_are_used_up_by_one_step(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        host.initialize()
        host.fmu.setRealInputDerivatives([host.reference["u_m1"]], [1], [100.0])
        host.step(0.0, 0.5)
        assert host.get("u_m1") == [50.0]
        host.step(0.5, 0.5)
        assert host.get("u_m1") == [50.0]


@pytest.mark.parametrize(
    ("name", "order", "value", "says"),
    [
        ("u_m1", 0, 1.0, "its derivatives of order 1 to 8 are taken"),
        ("u_m1", 9, 1.0, "its derivatives of order 1 to 8 are taken"),
        ("u_m1", 1, math.nan, "u_m1 = nan at t = 0 s: its derivative must be a finite number"),
        ("u_m1", 1, math.inf, "u_m1 = inf at t = 0 s: its derivative must be a finite number"),
        ("m_c", 1, 1.0, "m_c = 1 at t = 0 s: it is not an input"),
    ],
)
def test_wrong_input_derivatives_are_refused(
    name: str, order: int, value: float, says: str, unpacked: Unpacked
) -> None:
    with Host(unpacked("load", 2)) as host:
        host.initialize()
        call = host.fmu.setRealInputDerivatives
        assert says in host.refusal(call, [host.reference[name]], [order], [value])
