"""Communication steps as hosts take them: of any length, with derivatives of inputs, with jumps between them."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterable

import numpy as np
import pytest

from cablefmu.cable import Floats
from cablefmu.reference import integrate
from tests.conftest import Unpacked
from tests.fmi.raw import Raw, boolean, double, integers, numbers, references, size
from tests.fmu_helpers import small_scene

OUTPUTS = ("y_m1", "v_m1", "x_c", "y_c", "vx_c", "vy_c")
STOP = 2.0
AMPLITUDE, PULSATION = 800.0, 2.0 * math.pi
AUTOMATIC, EXPLICIT, IMPLICIT = 1, 2, 3


def truth(force: Callable[[float], float], breaks: Iterable[float] = ()) -> Floats:
    """The outputs at 2 s by the dense model under scipy, which sees a jump as the end of one run and the start of the
    next; good to 1e-9."""
    scene = small_scene("load")
    run = integrate(scene.cable, lambda t: {"u_m1": force(t)}, [0.0, STOP], breaks=breaks, rtol=1e-11, atol=1e-12)
    return np.array([run.outputs[name][-1] for name in OUTPUTS])


def error(raw: Raw, right: Floats) -> float:
    """[m, m/s]"""
    return float(np.max(np.abs(np.array(raw.get(*OUTPUTS)) - right)))


def choose(raw: Raw, solver: int) -> None:
    raw.must("SetInteger", references(raw.reference["solver"]), size(1), integers(solver))


@pytest.mark.parametrize("solver", [AUTOMATIC, EXPLICIT, IMPLICIT])
def test_steps_may_be_of_any_length(solver: int, unpacked: Unpacked) -> None:
    """From 1e-9 s to 1 s in any order, and some below the resolution of time."""
    right = truth(lambda t: 500.0)
    random = np.random.default_rng(7)
    with Raw(unpacked("load", 2), "cs") as raw:
        choose(raw, solver)
        raw.set(u_m1=500.0)
        raw.initialize(tolerance=1e-6)
        time = 0.0
        while time < STOP:
            step = min(10.0 ** random.uniform(-9.0, 0.0), STOP - time)
            assert raw.step(time, step)[0] == 0, raw.messages
            time += step
            assert raw.step(time, 1e-17)[0] == 0, "a step that does not move time"
        assert error(raw, right) < 1e-6  # measured: 5e-8 to 9e-8, as with equal steps


def test_a_sine_by_its_derivatives(unpacked: Unpacked) -> None:
    """Each pair of orders gains one digit or more until the tolerance of the integration is reached."""

    def sine(time: float, order: int = 0) -> float:
        return AMPLITUDE * PULSATION**order * math.sin(PULSATION * time + 0.5 * math.pi * order)

    right, step = truth(sine), 0.1
    assert 'canInterpolateInputs="true"' in (unpacked("load", 2) / "modelDescription.xml").read_text()
    errors: list[float] = []
    for orders in range(9):
        with Raw(unpacked("load", 2), "cs") as raw:
            raw.initialize()
            for k in range(round(STOP / step)):
                raw.set(u_m1=sine(k * step))
                which, order = references(*[raw.reference["u_m1"]] * orders), range(1, orders + 1)
                given = numbers(*(sine(k * step, j) for j in order))
                raw.must("SetRealInputDerivatives", which, size(orders), integers(*order), given)
                assert raw.step(k * step, step)[0] == 0
            errors.append(error(raw, right))
    assert errors[0] > 1e-2, "held constant"
    for before, after in zip(errors, errors[2:], strict=False):
        assert after < max(0.1 * before, 2e-7), errors  # measured: 2e-2, 2e-2, 9e-4, 4e-4, 1e-5, 4e-6, 8e-8 ...
    assert errors[-1] < 2e-7


@pytest.mark.parametrize("solver", [AUTOMATIC, EXPLICIT, IMPLICIT])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_a_jump_between_steps_costs_no_accuracy(solver: int, tolerance: float, unpacked: Unpacked) -> None:
    """Of 2 kN at 0.7 s, against runs in which nothing jumps."""
    errors: list[float] = []
    for force, breaks in ((lambda t: 500.0, ()), (lambda t: 500.0 if t < 0.7 else -1500.0, (0.7,))):
        with Raw(unpacked("load", 2), "cs") as raw:
            choose(raw, solver)
            raw.initialize(tolerance=tolerance)
            for k in range(20):
                raw.set(u_m1=force(round(0.1 * k, 9)))
                assert raw.step(0.1 * k, 0.1)[0] == 0
            errors.append(error(raw, truth(force, breaks)))
    # The motion after the jump is another one, some four times as fast; both are within their tolerance.
    assert errors[1] < 5.0 * errors[0] + 1e-9, errors
    assert errors[1] < tolerance


# --- what is not asynchronous, and where runs end ---


def test_there_is_never_a_step_to_cancel(unpacked: Unpacked) -> None:
    with Raw(unpacked("load", 2), "cs") as raw:
        raw.initialize()
        raw.step(0.0, 0.1)
        assert raw("CancelStep") == 3
        assert raw.messages == [
            (3, "logStatusError", "fmi2CancelStep: steps are not asynchronous, there is none to cancel")
        ]


def test_what_is_told_of_the_last_step(unpacked: Unpacked) -> None:
    """Real times and whether the cable wants to stop; all else is discarded, as FMI 2.0.5, section 4.2.3 asks."""
    with Raw(unpacked("load", 2), "cs") as raw:
        raw.initialize()
        raw.step(0.0, 0.1)
        time, stops, word = double(), ctypes.c_int(7), ctypes.byref(ctypes.c_void_p())
        raw.must("GetRealStatus", 2, ctypes.byref(time))
        raw.must("GetBooleanStatus", 3, ctypes.byref(stops))
        assert (time.value, stops.value) == (0.1, 0)
        known = {("GetRealStatus", 2), ("GetBooleanStatus", 3)}
        for function in ("GetStatus", "GetRealStatus", "GetIntegerStatus", "GetBooleanStatus", "GetStringStatus"):
            for kind in range(5):
                if (function, kind) in known:
                    assert raw(function, kind, None) == 3
                    assert raw.messages[-1][2] == f"fmi2{function}: a null pointer was given"
                else:
                    assert raw(function, kind, word) == 2
                    assert raw.messages[-1][:2] == (2, "logStatusDiscard")


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_step_leads_past_the_stop_time(fmi: int, unpacked: Unpacked) -> None:
    """But for the rounding of a host that adds up its steps."""
    with Raw(unpacked("load", fmi), "cs") as raw:
        raw.initialize(stop=0.3)
        assert raw.step(0.0, 0.2)[0] == 0
        assert raw.step(0.2, 0.2)[0] == 3
        assert raw.messages[-1][2].endswith("communication step 0.2 s leads past the stop time, 0.3 s")
        assert raw.step(0.2, 0.1 + 1e-12)[0] == 0
        raw.must("Reset")
        raw.initialize()
        assert raw.step(0.0, 0.4)[0] == 0


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("stop", [-1.0, math.nan])
def test_impossible_stop_times_are_refused(fmi: int, stop: float, unpacked: Unpacked) -> None:
    with Raw(unpacked("load", fmi), "cs") as raw:
        function = "SetupExperiment" if fmi == 2 else "EnterInitializationMode"
        no, yes, zero = boolean(fmi, False), boolean(fmi, True), double(0.0)
        assert raw(function, no, zero, zero, yes, double(stop)) == 3
        assert "a time not before the start time is expected" in raw.messages[-1][2]


# --- logging ---


@pytest.mark.parametrize("fmi", [2, 3])
def test_log_categories(fmi: int, unpacked: Unpacked) -> None:
    def switch(raw: Raw, *names: bytes | None) -> int:
        return raw("SetDebugLogging", boolean(fmi, True), size(len(names)), (ctypes.c_char_p * len(names))(*names))

    with Raw(unpacked("load", fmi), "cs") as raw:
        declared = {name.encode() for name in ("logStatusError", "logStatusWarning", "logStatusDiscard")}
        assert declared == {category.name.encode() for category in raw.description.logCategories}
        assert switch(raw, *declared) == 0
        assert switch(raw, b"logStatusError", b"logAll") == 1
        assert raw.messages == [(1, "logStatusWarning", "there is no log category logAll")]
        assert switch(raw, b"logStatusError", None) == 3
        assert raw("SetDebugLogging", boolean(fmi, True), size(1), None) == 3


@pytest.mark.parametrize("fmi", [2, 3])
def test_what_means_something_in_messages_is_doubled(fmi: int, unpacked: Unpacked) -> None:
    """A # begins a reference to a variable, a % a conversion of printf where that is what hosts do (FMI 2)."""
    with Raw(unpacked("load", fmi), "cs", location="/no/100 %/#1") as raw:
        percent = "%%" if fmi == 2 else "%"
        assert raw.messages[0][2] == f"resource file /no/100 {percent}/##1/cable.bin: cannot be opened"


def test_an_unknown_kind_of_fmu(unpacked: Unpacked) -> None:
    with Raw(unpacked("load", 2), "cs", kind=2) as raw:
        assert raw.pointer is None
        assert "neither fmi2ModelExchange nor fmi2CoSimulation" in raw.messages[0][2]


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_output_is_given_that_is_not_a_number(fmi: int, unpacked: Unpacked) -> None:
    """The energy of rates of 1e200 rad/s is beyond the range of numbers, though the state is not."""
    with Raw(unpacked("load", fmi), "cs") as raw:
        raw.set(**{"omega[1]": 1e200})
        values, one = numbers(0.0), size(1)
        function = "GetReal" if fmi == 2 else "GetFloat64"
        more = () if fmi == 2 else (one,)
        assert raw(function, references(raw.reference["energy"]), one, values, *more) == 3
        assert "forces or rates are beyond the range of numbers" in raw.messages[-1][2]


@pytest.mark.parametrize(
    ("fmi", "function"),
    [(2, "GetDirectionalDerivative"), (3, "GetDirectionalDerivative"), (3, "GetAdjointDerivative")],
)
def test_no_derivative_is_given_that_is_not_a_number(fmi: int, function: str, unpacked: Unpacked) -> None:
    """A seed near the end of the range of numbers, and rates between: the fuzzer found it."""
    with Raw(unpacked("load", fmi), "cs") as raw:
        raw.initialize()
        one, seed, sensitivity = size(1), numbers(1.7e308), numbers(0.0)
        unknown, known = references(raw.reference["der(omega[2])"]), references(raw.reference["theta[2]"])
        if fmi == 2:
            status = raw(function, unknown, one, known, one, seed, sensitivity)
        else:
            status = raw(function, unknown, one, known, one, seed, one, sensitivity, one)
        assert status == 3
        assert "is beyond the range of numbers" in raw.messages[-1][2]
