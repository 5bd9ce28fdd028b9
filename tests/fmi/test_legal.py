"""Every function of both APIs in every state that can be reached, against tables typed from the standards.

Sources: the tables of allowed calls of FMI 2.0.5, sections 3.2.3 (Model Exchange) and 4.2.4 (Co-Simulation), and the
lists "Allowed Function Calls" of the states in FMI 3.0.2, sections 2.3, 3.2 and 4.2.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest

from tests.conftest import Unpacked
from tests.fmi.raw import Interface, Raw, boolean, double, integers, numbers, references, size

HEADERS = Path(fmpy.__file__).parent / "c-code"

STATES = {
    "I": "instantiated",
    "N": "initialization mode",
    "E": "event mode",
    "C": "continuous-time mode",
    "S": "step mode",
    "Q": "intermediate update, inputs asked for",
    "A": "intermediate update, at an accepted step",
    "T": "terminated",
    "F": "error",
}
REACHABLE: dict[tuple[int, Interface], str] = {(2, "me"): "INECT", (2, "cs"): "INSFT", (3, "me"): "INECT",
                                               (3, "cs"): "INSQAFT"}  # fmt: skip

ANY2, ANY3 = ("INECT", "INSFT"), ("INECT", "INSFT")
"""A function of all states: where it is legal in Model Exchange, in Co-Simulation."""
SINCE_INITIALIZATION = ("NECT", "NSFT")

STANDARD_2: dict[str, tuple[str, str]] = {
    "SetDebugLogging|FreeInstance|Reset": ANY2,
    "SetupExperiment|EnterInitializationMode": ("I", "I"),
    "ExitInitializationMode": ("N", "N"),
    "Terminate": ("EC", "S"),
    "Get(Real|Integer|Boolean|String)": SINCE_INITIALIZATION,
    "SetReal": ("INEC", "INS"),
    "Set(Integer|Boolean|String)": ("INE", "INS"),
    "(Get|Set|Free|Serialize|DeSerialize)FMUstate|SerializedFMUstateSize": ANY2,
    "GetDirectionalDerivative": SINCE_INITIALIZATION,
    "EnterEventMode": ("EC", ""),
    "NewDiscreteStates|EnterContinuousTimeMode": ("E", ""),
    "CompletedIntegratorStep|SetTime|SetContinuousStates": ("C", ""),
    "GetEventIndicators|GetContinuousStates|GetDerivatives": ("NECT", ""),
    "GetNominalsOfContinuousStates": ("INECT", ""),
    "SetRealInputDerivatives": ("", "INS"),
    "GetRealOutputDerivatives": ("", "SFT"),
    "DoStep": ("", "S"),
    "CancelStep": ("", ""),  # of a step in progress, which there never is
    "Get(|Real|Integer|Boolean|String)Status": ("", "ST"),
}
STANDARD_3: dict[str, tuple[str, str]] = {
    "SetDebugLogging|FreeInstance|Reset": ANY3,
    "EnterInitializationMode": ("I", "I"),
    "ExitInitializationMode": ("N", "N"),
    "Terminate": ("EC", "S"),
    "Get(U?Int(8|16|32|64)|Float(32|64)|Boolean|String|Binary)": ("INECT", "INSATF"),
    "Set(U?Int(8|16|32|64)|Boolean|String|Binary)": ("INE", "INS"),
    "SetFloat(32|64)": ("INEC", "INSQA"),
    "(Get|Set)Clock": ("E", ""),  # without event mode, Co-Simulation has no clocks
    "(Get|Set|Free|Serialize|Deserialize)FMUState|SerializedFMUStateSize": ANY3,
    "Get(Directional|Adjoint)Derivative": SINCE_INITIALIZATION,
    "EnterConfigurationMode": ("", ""),  # there are no structural parameters
    "ExitConfigurationMode": ("", ""),
    "EnterEventMode": ("C", ""),
    "UpdateDiscreteStates|EvaluateDiscreteStates|EnterContinuousTimeMode": ("E", ""),
    "CompletedIntegratorStep|SetContinuousStates": ("C", ""),
    "SetTime": ("C", ""),
    "Get(EventIndicators|ContinuousStates|ContinuousStateDerivatives|NominalsOfContinuousStates)": ("NECT", ""),
    "GetNumberOf(EventIndicators|ContinuousStates)": ("IE", ""),
    "EnterStepMode": ("", ""),  # hasEventMode = false
    "DoStep": ("", "S"),
    "GetOutputDerivatives": ("", "SATF"),
    # Clocks are counted in event mode and initialization, but there are none; dependencies do not change.
    "(Get|Set)(Interval|Shift)(Decimal|Fraction)|ActivateModelPartition": ("", ""),
    "GetNumberOfVariableDependencies|GetVariableDependencies": ("", ""),
}
STANDARD = {2: STANDARD_2, 3: STANDARD_3}

WIDER: dict[int, dict[str, tuple[str, str, str]]] = {
    2: {
        "Get(Real|Integer|Boolean|String)": ("I", "I", "start values are read back, as in FMI 3"),
        "GetContinuousStates": ("I", "", "likewise"),
        "Set(Integer|Boolean|String)": ("C", "", "empty lists; a variable says itself that it is fixed"),
        "SetTime": ("E", "", "the time at which the event is handled"),
        "Get(|Real|Integer|Boolean|String)Status": ("", "F", "how far a step came that failed"),
    },
    3: {
        "Set(U?Int(8|16|32|64)|Boolean|String|Binary)": ("C", "", "as in FMI 2"),
        "SetTime": ("E", "", "as in FMI 2"),
        "Get(ContinuousStates|NominalsOfContinuousStates)": ("I", "", "as in FMI 2"),
        "GetNumberOf(EventIndicators|ContinuousStates)": ("NCT", "", "they are constants"),
        "GetClock": ("INCT", "INSATF", "empty lists"),
        "SetClock": ("INC", "INS", "likewise"),
    },
}
"""What is answered beyond the standard, and why that misleads nobody."""
NARROWER = {2: {}, 3: {"SetFloat32": ("", "QA", "no variable of that type is set inside a step")}}

NO_INSTANCE = {"GetTypesPlatform", "GetVersion", "Instantiate", "InstantiateModelExchange", "InstantiateCoSimulation",
               "InstantiateScheduledExecution"}  # fmt: skip


def functions(fmi: int) -> list[str]:
    """Every name of the official header, without fmi2 or fmi3 in front."""
    text = (HEADERS / f"fmi{fmi}FunctionTypes.h").read_text()
    return re.findall(rf"fmi{fmi}(\w+)TYPE\s*\(", text)


def legal(fmi: int, function: str, interface: Interface) -> str:
    """The states in which the call is expected to be taken."""
    column = ("me", "cs").index(interface)

    def letters(table: dict[str, Any]) -> set[str]:
        return {letter for names, row in table.items() if re.fullmatch(names, function) for letter in row[column]}

    return "".join(sorted((letters(STANDARD[fmi]) | letters(WIDER[fmi])) - letters(NARROWER[fmi])))


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_tables_know_every_function_of_the_header(fmi: int) -> None:
    names = functions(fmi)
    assert len(names) == {2: 44, 3: 75}[fmi]
    for name in set(names) - NO_INSTANCE:
        assert sum(bool(re.fullmatch(pattern, name)) for pattern in STANDARD[fmi]) == 1, name
    for table in (STANDARD[fmi], WIDER[fmi], NARROWER[fmi]):
        for pattern in table:
            assert any(re.fullmatch(pattern, name) for name in names), pattern


# --- harmless arguments ---


def arguments(raw: Raw, function: str) -> tuple[Any, ...]:
    """Of a call that is right but for its moment."""
    two = raw.fmi == 2
    number, none, one, yes, no = double(0.0), size(0), size(1), boolean(raw.fmi, True), boolean(raw.fmi, False)
    force, angle, output = (references(raw.reference[name]) for name in ("u_m1", "theta[1]", "x_c"))
    word = ctypes.byref(ctypes.create_string_buffer(64))
    states = raw.description.numberOfContinuousStates
    vector = (numbers(*[0.1] * states), size(states))
    sensitivity = (
        output,
        one,
        angle,
        one,
        numbers(1.0),
        *(() if two else (one,)),
        numbers(0.0),
        *(() if two else (one,)),
    )
    known: dict[str, tuple[Any, ...]] = {
        "SetDebugLogging": (yes, none, None),
        "SetupExperiment": (no, number, number, no, number),
        "EnterInitializationMode": () if two else (no, number, number, no, number),
        "GetReal": (output, one, numbers(0.0)),
        "SetReal": (force, one, numbers(1.0)),
        "GetFloat64": (output, one, numbers(0.0), one),
        "SetFloat64": (force, one, numbers(1.0), one),
        "Get(FMU[sS]tate)": (ctypes.byref(raw.new_handle()),),
        "Set(FMU[sS]tate)": (raw.handle,),
        "Free(FMU[sS]tate)": (ctypes.byref(ctypes.c_void_p()),),
        "SerializedFMU[sS]tateSize": (raw.handle, ctypes.byref(size())),
        "SerializeFMU[sS]tate": (raw.handle, ctypes.create_string_buffer(len(raw.image)), size(len(raw.image))),
        "De[sS]erializeFMU[sS]tate": (raw.image, size(len(raw.image)), ctypes.byref(raw.new_handle())),
        "Get(Directional|Adjoint)Derivative": sensitivity,
        "NewDiscreteStates": (word,),
        "UpdateDiscreteStates": (word,) * 6,
        "CompletedIntegratorStep": (yes, word, word),
        "SetTime": (number,),
        "SetContinuousStates|Get(Nominals(Of))?ContinuousStates|Get(ContinuousState)?Derivatives": vector,
        "GetNominalsOfContinuousStates": vector,
        "GetNumberOf(EventIndicators|ContinuousStates)": (word,),
        "SetRealInputDerivatives": (force, one, integers(1), numbers(0.0)),
        "GetRealOutputDerivatives": (output, one, integers(1), numbers(0.0)),
        "GetOutputDerivatives": (output, one, integers(1), numbers(0.0), one),
        "DoStep": (number, double(0.1), yes, *(() if two else (word,) * 4)),
        "GetRealStatus": (2, word),
        "GetBooleanStatus": (3, word),
        "Get(|Integer|String)Status": (0, word),
    }
    for pattern, values in known.items():
        if re.fullmatch(pattern, function):
            return values
    return None, none, None, none, None, none, None, none


# --- states ---

Act = Callable[[Raw], None]


def into(state: str, raw: Raw, act: Act) -> None:
    """Bring a new instance into that state, and act there."""
    if state in "QA":
        raw.initialize()
        status, *_ = raw.step(0.0, 0.1)  # acts inside
        assert status == 0, raw.messages
        return
    if state == "N":
        if raw.fmi == 2:
            raw.must("SetupExperiment", *arguments(raw, "SetupExperiment"))
        raw.must("EnterInitializationMode", *arguments(raw, "EnterInitializationMode"))
    elif state != "I":
        raw.initialize()
    if state == "C":
        raw.must("EnterContinuousTimeMode")
    if state == "T":
        raw.must("Terminate")
    if state == "F":
        raw.set(F_cx=1e300)
        assert raw.step(0.0, 0.1)[0] == 3
    act(raw)


def instance(folder: Path, interface: Interface, state: str, act: Act) -> Raw:
    """Ready to be brought into that state; for one inside a step with a host that acts there once."""
    done: list[float] = []

    def inside(raw: Raw, time: float, asked: bool, readable: bool, finished: bool, may_return: bool) -> None:
        if not done and finished == (state == "A"):
            done.append(time)
            act(raw)

    if state not in "QA":
        return Raw(folder, interface)
    return Raw(folder, interface, inside=inside, listen=("u_m1", "x_c"))


@pytest.mark.parametrize(
    ("fmi", "interface", "state"), [(*key, state) for key, states in REACHABLE.items() for state in states]
)
def test_every_function_in_every_state(fmi: int, interface: Interface, state: str, unpacked: Unpacked) -> None:
    """Where it is legal it is taken; elsewhere it returns an error, and says its name."""
    folder = unpacked("load", fmi)
    for function in sorted(set(functions(fmi)) - NO_INSTANCE):
        outcome: list[tuple[int, list[tuple[int, str, str]]]] = []

        def act(raw: Raw, function: str = function, outcome: Any = outcome) -> None:
            before = len(raw.messages)
            status = raw(function, *arguments(raw, function))
            outcome.append((status, raw.messages[before:]))
            if function == "FreeInstance" and not raw.messages[before:]:
                raw.pointer = None

        with instance(folder, interface, state, act) as raw:
            raw.remember_state()
            into(state, raw, act)
            ((status, said),) = outcome
            where = f"{function} in {STATES[state]}: {said}"
            if not raw.offers(function):
                assert status == 3 and "is not offered" in said[0][2], where
            elif state in legal(fmi, function, interface):
                assert [kind for kind, *_ in said] == ([2] if status == 2 else []), where
                assert function == "FreeInstance" or status in (0, 2), where
            else:
                assert [kind for kind, *_ in said] == [3], where
                assert function == "FreeInstance" or status == 3, where


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_instance_is_an_error_and_no_crash(fmi: int, unpacked: Unpacked) -> None:
    with Raw(unpacked("load", fmi), "cs") as raw:
        pointer, raw.pointer = raw.pointer, None
        for function in sorted(set(functions(fmi)) - NO_INSTANCE):
            status = raw(function, *arguments(raw, function))
            assert function == "FreeInstance" or status == 3, function
        assert raw.messages == []
        raw.pointer = pointer
