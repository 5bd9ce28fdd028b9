"""States as a host handles them: handles, stop times, starts, parameters, and calls that are refused."""

from __future__ import annotations

import ctypes
from typing import Any

import fmpy
import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmi.test_state import (
    AUTOMATIC,
    EXPLICIT,
    IMPLICIT,
    NAMES,
    SOFT,
    STEP,
    STEPS,
    STIFF,
    both,
    everything,
    run,
    start,
)  # fmt: skip
from tests.fmu_helpers import Host

# --- how long a run is ---


@both
def test_a_state_goes_on_beyond_the_stop_time_of_its_run(fmi: int, unpacked: Unpacked) -> None:
    """The stop time is not part of it: who saves at the end of a run wants to go on later."""
    with Host(unpacked("load", fmi)) as host:
        if fmi == 2:
            host.fmu.setupExperiment(startTime=0.0, stopTime=0.25)
            host.fmu.enterInitializationMode()
        else:
            host.fmu.enterInitializationMode(startTime=0.0, stopTime=0.25)
        host.fmu.exitInitializationMode()
        host.step(0.0, 0.25)
        state = host.take()
        assert "leads past the stop time" in host.refusal(host.step, 0.25, 0.25)
        host.put(state)
        host.step(0.25, 0.25)


def test_fmpys_own_simulation_goes_on(unpacked: Unpacked) -> None:
    """As its users do it: a state in memory, or as bytes, instead of initialization."""
    folder = str(unpacked("load", 3))
    options: dict[str, Any] = {"output": ["x_c", "solver.rhs"], "output_interval": 0.125, "set_stop_time": True}
    whole = fmpy.simulate_fmu(folder, stop_time=1.0, **options)
    fmu = fmpy.instantiate_fmu(folder, fmpy.read_model_description(folder), "CoSimulation")
    fmpy.simulate_fmu(folder, fmu_instance=fmu, stop_time=0.5, terminate=False, **options)
    state = fmu.getFMUState()
    image = fmu.serializeFMUState(state)
    later = {"start_time": 0.5, "stop_time": 1.0, **options}
    for on in (
        fmpy.simulate_fmu(folder, fmu_state=image, **later),
        fmpy.simulate_fmu(folder, fmu_instance=fmu, fmu_state=state, terminate=False, **later),
    ):
        np.testing.assert_array_equal(on, whole[4:])
    fmu.terminate()
    fmu.freeInstance()


# --- before a run ---


@both
@pytest.mark.parametrize("kind", ["load", "pin"])
def test_a_start_comes_back(kind: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """What was set before initialization, in it, and the equilibrium that was found there."""
    folder = unpacked_from_equilibrium(kind, fmi)
    with Host(folder) as host, Host(folder) as other:
        host.set(M_1=700.0)
        host.set_all({"theta[2]": 0.4})
        instantiated = host.save()
        host.enter_initialization()
        host.set(u_m1=50.0)
        initializing, shown = host.save(), everything(host)
        host.fmu.exitInitializationMode()
        rows = run(host, range(5))

        other.load(initializing)
        assert everything(other) == shown
        other.fmu.exitInitializationMode()
        assert run(other, range(5)) == rows

        other.load(instantiated)
        other.enter_initialization()
        other.set(u_m1=50.0)
        assert everything(other) == shown
        other.fmu.exitInitializationMode()
        assert run(other, range(5)) == rows


@both
def test_parameters_are_those_of_the_state(fmi: int, unpacked: Unpacked) -> None:
    """FMI counts them to the state: without them a run could not go on from it by that alone."""
    folder = unpacked("load", fmi)
    with Host(folder) as heavy, Host(folder) as other:
        heavy.initialize(M_1=700.0, m_c=80.0, k_joint=2e3).run(0.5)
        image, rows = heavy.save(), run(heavy, range(8, 12))
        other.initialize(M_1=500.0).run(0.3)
        other.load(image)
        assert other.get("M_1", "m_c", "k_joint") == [700.0, 80.0, 2e3]
        assert run(other, range(8, 12)) == rows


@both
def test_what_is_set_after_a_state_was_put_back_stays(fmi: int, unpacked: Unpacked) -> None:
    folder = unpacked("load", fmi)
    with Host(folder) as plain, Host(folder) as host:
        expected = plain.initialize(M_1=700.0, m_c=90.0, u_m1=40.0).run(1.0)
        host.set(m_c=90.0)
        state = host.take()
        host.set(m_c=50.0, u_m1=-300.0)
        host.initialize().run(0.5)
        host.put(state)
        np.testing.assert_array_equal(host.initialize(M_1=700.0, u_m1=40.0).run(1.0), expected)
        host.free(state)


# --- handles ---


@both
def test_a_handle_is_used_again(fmi: int, unpacked: Unpacked) -> None:
    """Also where the new state takes more room, and one and the same state can be put back many times."""
    with Host(unpacked("load", fmi)) as host:
        start(host, AUTOMATIC, STIFF)
        state = host.take()
        address, small = state.value, len(host.image_of(state))
        run(host, range(6))
        assert host.raw(NAMES[fmi]["get"], ctypes.byref(state)) == 0
        assert state.value == address
        assert len(host.image_of(state)) > small
        rows = run(host, range(6, 12))
        for _ in range(3):
            assert run(host.put(state), range(6, 12)) == rows
        host.free(state)
        assert state.value is None
        host.free(state)  # nothing to free is no mistake


@both
def test_a_state_of_another_instance_is_taken(fmi: int, unpacked: Unpacked) -> None:
    folder = unpacked("load", fmi)
    with Host(folder) as one, Host(folder) as other:
        start(one, IMPLICIT, STIFF)
        run(one, range(5))
        state = one.take()
        rows = run(one, range(5, 10))
        assert run(other.put(state), range(5, 10)) == rows
        other.free(state)
        assert state.value is None


@both
def test_what_is_not_a_state_is_refused(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        start(host, AUTOMATIC, SOFT)
        state = host.take()
        nothing = type(state)()
        said = "this is not a state of the FMU, or was freed"
        assert host.refusal(host.put, nothing) == f"setting the state: {said}"
        assert host.refusal(host.image_of, nothing) == f"the size of a serialized state: {said}"
        function = NAMES[fmi]
        image = host.save()
        calls = {"get": [None], "size": [state, None], "serialize": [state, None, 0], "deserialize": [None, 9, None]}
        calls["deserialize "] = [image, len(image), None]
        for name, arguments in calls.items():
            assert host.raw(function[name.strip()], *arguments) == 3
            assert host.messages[-1].endswith("a null pointer was given")
        room = bytes(len(image))
        assert host.raw(function["serialize"], state, room[1:], len(room) - 1) == 3
        assert host.messages[-1].endswith(f"{len(room) - 1} bytes were given; expected are {len(room)}")
        host.step(0.0, STEP)  # and the instance is none the worse


@both
def test_one_instance_may_hold_many(fmi: int, unpacked: Unpacked) -> None:
    """Freed in any order, or with the instance; the hosts in C count that nothing is lost."""
    with Host(unpacked("load", fmi)) as host:
        start(host, EXPLICIT, SOFT)
        states, rows = [], []
        for k in range(STEPS):
            states.append(host.take())
            rows += run(host, [k])
        for k in (3, 0, STEPS - 1, 9):
            host.free(states[k])
        for k in (1, 17, 10):
            assert run(host.put(states[k]), range(k, STEPS)) == rows[k:]


# --- a host's promise, and the wrong moment ---


@both
def test_a_promise_not_to_roll_back_changes_nothing(fmi: int, unpacked: Unpacked) -> None:
    """noSetFMUStatePriorToCurrentPoint: the FMU keeps nothing for rollbacks of its own accord that it could let go."""
    with Host(unpacked("load", fmi)) as host:
        start(host, AUTOMATIC, STIFF)
        state = host.take()
        rows = {}
        for promise in (False, True):
            host.put(state)
            rows[promise] = []
            for k in range(5):
                host.fmu.doStep(k * STEP, STEP, noSetFMUStatePriorToCurrentPoint=promise)
                rows[promise].append(everything(host))
        assert rows[True] == rows[False]


def test_inside_a_step_there_is_no_state(unpacked: Unpacked) -> None:
    refusals = []

    def ask(host: Host, time: float) -> None:
        if not refusals:
            refusals.append(host.refusal(host.take))

    with Host(unpacked("load", 3), ask=ask) as host:
        host.initialize().step(0.0, STEP)
    assert refusals == [
        "fmi3GetFMUState is not allowed inside a communication step, where inputs are asked for (Co-Simulation)"
    ]
