"""The complete state: a run goes on from it with the same bits, wherever and after whatever it is put back."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS, Host, small_scene, unpack

ROOT = Path(__file__).parents[2]
both = pytest.mark.parametrize("fmi", [2, 3])
AUTOMATIC, EXPLICIT, IMPLICIT = 1, 2, 3
solvers = pytest.mark.parametrize("solver", [AUTOMATIC, EXPLICIT, IMPLICIT])

NAMES = {
    2: {"get": "fmi2GetFMUstate", "size": "fmi2SerializedFMUstateSize", "serialize": "fmi2SerializeFMUstate",
        "deserialize": "fmi2DeSerializeFMUstate"},
    3: {"get": "fmi3GetFMUState", "size": "fmi3SerializedFMUStateSize", "serialize": "fmi3SerializeFMUState",
        "deserialize": "fmi3DeserializeFMUState"},
}  # fmt: skip

STEPS, STEP = 20, 0.0625  # [s], exact in binary
SOFT: dict[str, float] = {"u_m1": 100.0}
STIFF = SOFT | {"k_joint": 3e3, "c_joint": 3e3}
"""Automatic goes from one method to the other and back."""


def start(host: Host, solver: int, values: Mapping[str, float]) -> Host:
    """With another tolerance than a fresh instance has."""
    host.set_choices(("solver", solver))
    host.set_all(values)
    host.enter_initialization(tolerance=1e-5)
    host.fmu.exitInitializationMode()
    return host


def everything(host: Host) -> bytes:
    """Every variable that there is, to the last bit: states, outputs, counters, energy residual."""
    names = sorted(host.reference)
    return np.array(host.get(*names)).tobytes()


def slope(host: Host, name: str, value: float) -> None:
    host.fmu.setRealInputDerivatives([host.reference[name]], [1], [value])


def step(host: Host, k: int) -> None:
    """Inputs that rest, jump, and in FMI 2 run along a slope; a force on the terminal begins without a jump."""
    if 8 <= k < 16:
        host.set(u_m1=100.0 * (k * 7 % 11 - 5))
    if host.fmi == 2 and 10 <= k < 12:
        slope(host, "u_m1", 50.0)
    if host.fmi == 2 and 13 <= k < 15 and "F_cx" in host.reference:
        slope(host, "F_cx", 300.0)
    host.step(k * STEP, STEP)


def run(host: Host, steps: Sequence[int]) -> list[bytes]:
    rows = []
    for k in steps:
        step(host, k)
        rows.append(everything(host))
    return rows


def run_and_save(host: Host) -> tuple[list[bytes], list[bytes]]:
    """Images before every step, and everything before it; after the last step as well."""
    images, rows = [], [everything(host)]
    for k in range(STEPS):
        images.append(host.save())
        rows += run(host, [k])
    return images, rows


def assert_same_from_every(images: Sequence[bytes], rows: Sequence[bytes], host: Host) -> None:
    for k in reversed(range(STEPS)):
        assert everything(host.load(images[k])) == rows[k], f"in the state before step {k}"
        assert run(host, range(k, STEPS)) == rows[k + 1 :], f"from the state before step {k}"


# --- Co-Simulation ---


@both
@solvers
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("values", [SOFT, STIFF], ids=["soft", "stiff"])
def test_a_fresh_instance_goes_on_with_the_same_bits(
    values: Mapping[str, float], kind: str, solver: int, fmi: int, unpacked: Unpacked
) -> None:
    folder = unpacked(kind, fmi)
    with Host(folder) as first:
        images, rows = run_and_save(start(first, solver, values))
    with Host(folder) as other:
        assert_same_from_every(images, rows, other)


@both
@solvers
@pytest.mark.parametrize("kind", ["load", "pin", "floater"])
def test_so_it_does_from_equilibrium(kind: str, solver: int, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    folder = unpacked_from_equilibrium(kind, fmi)
    with Host(folder) as first:
        images, rows = run_and_save(start(first, solver, STIFF))
    with Host(folder) as other:
        assert_same_from_every(images, rows, other)


@both
def test_the_runs_above_came_by_all_that_a_solver_remembers(fmi: int, unpacked: Unpacked) -> None:
    """By the size of the images: nothing yet, a slope, directions as well, and the inside of a step."""
    sizes = set()
    vector = 8 * 12  # bytes of 2 (n + 1) doubles
    for solver in (AUTOMATIC, EXPLICIT, IMPLICIT):
        with Host(unpacked("load", fmi)) as host:
            images, _ = run_and_save(start(host, solver, STIFF))
            sizes |= {len(image) for image in images}
            steps, jacobians = host.get("solver.steps", "solver.jacobians")
            assert (solver != AUTOMATIC) or 0 < jacobians < steps, "both methods have their turn"
    least = min(sizes)
    assert {least, least + vector, least + 2 * vector, least + 6 * vector} <= sizes <= {
        least + k * vector for k in range(8)
    }  # fmt: skip


def test_slopes_of_inputs_are_part_of_the_state(unpacked: Unpacked) -> None:
    folder = unpacked("load", 2)
    with Host(folder) as first, Host(folder) as other:
        start(first, AUTOMATIC, SOFT)
        slope(first, "u_m1", 4e3)
        other.load(first.save())
        first.step(0.0, STEP)
        other.step(0.0, STEP)
        assert first.get("u_m1") == [SOFT["u_m1"] + 4e3 * STEP]
        assert everything(other) == everything(first)


@both
@solvers
def test_another_history_leaves_no_trace(solver: int, fmi: int, unpacked: Unpacked) -> None:
    """Energy balance, counters, directions, dense output: all are the state's, not those of the instance."""
    folder = unpacked("load", fmi)
    with Host(folder) as first:
        images, rows = run_and_save(start(first, solver, STIFF))
    with Host(folder) as other:
        start(other, IMPLICIT if solver == EXPLICIT else EXPLICIT, {"m_c": 90.0, "F_cx": 800.0})
        run(other, range(STEPS))
        assert_same_from_every(images, rows, other)


@both
@solvers
def test_steps_that_are_rejected_leave_no_trace(solver: int, fmi: int, unpacked: Unpacked) -> None:
    """A master that tries a long step, rolls back and takes shorter ones; with a handle, as masters do."""
    with Host(unpacked("load", fmi)) as patient, Host(unpacked("load", fmi)) as eager:
        start(patient, solver, STIFF)
        start(eager, solver, STIFF)
        expected = run(patient, range(STEPS))
        found, state = [], eager.take()
        for k in range(STEPS):
            eager.set(u_m1=1e4)
            eager.step(k * STEP, 3.0 * STEP)
            found += run(eager.put(state), [k])
            assert eager.raw(NAMES[fmi]["get"], ctypes.byref(state)) == 0
        eager.free(state)
    assert found == expected


@both
@solvers
def test_derivatives_that_were_asked_for_leave_no_trace(solver: int, fmi: int, unpacked: Unpacked) -> None:
    """They use the solver's linearised chain for something else, before a state is taken and after it is put back."""

    def ask(host: Host) -> None:
        unknown, known = host.reference["der(v_m1)"], host.reference["u_m1"]
        (found,) = host.fmu.getDirectionalDerivative([unknown], [known], [1.0])
        assert found > 0.0

    with Host(unpacked("load", fmi)) as host:
        images, rows = run_and_save(start(host, solver, STIFF))
        for k in range(1, STEPS, 3):
            host.load(images[k])
            ask(host)
            image = host.save()
            assert image == images[k]
            host.step(k * STEP, STEP)
            host.load(image)
            ask(host)
            assert run(host, range(k, STEPS)) == rows[k + 1 :]


@both
def test_an_instance_goes_on_after_an_error(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        images, rows = run_and_save(start(host, AUTOMATIC, SOFT))
        host.set(F_cx=1e300)
        assert "the motion is too violent" in host.refusal(host.step, STEPS * STEP, STEP)
        failed = host.take()
        assert "not allowed after an error" in host.refusal(host.step, STEPS * STEP, STEP)
        host.load(images[5])
        assert run(host, range(5, STEPS)) == rows[6:]
        # The state of the error itself is one as well: it can be looked at, not gone on from.
        host.put(failed)
        assert host.get("F_cx") == [1e300]
        assert "not allowed after an error" in host.refusal(host.step, STEPS * STEP, STEP)


@both
def test_a_state_outlives_a_reset(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        start(host, AUTOMATIC, STIFF)
        run(host, range(5))
        kept, spare = host.take(), host.take()
        rows = run(host, range(5, STEPS))
        host.fmu.reset()
        host.free(spare)
        assert run(host.put(kept), range(5, STEPS)) == rows
        host.fmu.reset()
        host.enter_initialization()
        assert run(host.put(kept), range(5, STEPS)) == rows, "from inside initialization mode as well"


@both
def test_another_process_goes_on(fmi: int, unpacked: Unpacked, tmp_path: Path) -> None:
    folder = unpacked("load", fmi)
    with Host(folder) as host:
        images, rows = run_and_save(start(host, AUTOMATIC, STIFF))
    (tmp_path / "image").write_bytes(images[7])
    script = (
        "import sys; from pathlib import Path; from tests.fmu_helpers import Host; from tests.fmi.test_state import *\n"
        "with Host(Path(sys.argv[1])) as host:\n"
        "    rows = run(host.load(Path(sys.argv[2]).read_bytes()), range(7, STEPS))\n"
        "sys.stdout.buffer.write(b''.join(rows))"
    )
    command = [sys.executable, "-c", script, str(folder), str(tmp_path / "image")]
    done = subprocess.run(command, capture_output=True, cwd=ROOT, timeout=60)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout == b"".join(rows[8:])


def test_ten_thousand_links(tmp_path: Path) -> None:
    scene = small_scene("load")
    scene = type(scene).from_text(scene.text.replace("links = 5", "links = 10000"), name="long")
    folder = unpack(scene, tmp_path, 2)
    watched = ("y_m1", "x_c", "y_c", "tension_max", "energy", "solver.rhs", "solver.energy_residual")
    with Host(folder) as host, Host(folder) as other:
        start(host, IMPLICIT, {})
        host.step(0.0, 1e-4)
        image = host.save()
        other.load(image)
        for one in (host, other):
            one.step(1e-4, 1e-4)
        assert host.get(*watched) == other.get(*watched)
    vector = 8 * 2 * 10001
    assert vector <= len(image) < 8 * vector


# --- Model Exchange ---


@both
@pytest.mark.parametrize("kind", ["load", "pin"])
def test_model_exchange_goes_on_with_the_same_bits(kind: str, fmi: int, unpacked: Unpacked) -> None:
    def euler(host: Host, k: int) -> bytes:
        host.fmu.setTime((k + 1) * STEP)
        host.set(u_m1=100.0 * (k % 5))
        host.set_states(host.states() + STEP / 16.0 * host.derivatives())
        return everything(host)

    folder = unpacked(kind, fmi)
    with Host(folder, interface="me") as first, Host(folder, interface="me") as other:
        first.initialize(M_1=650.0)
        images, rows = [], []
        for k in range(STEPS):
            rows.append(everything(first))
            images.append(first.save())
            euler(first, k)
        for k in reversed(range(STEPS)):
            assert everything(other.load(images[k])) == rows[k]
            assert [everything(other), *(euler(other, j) for j in range(k, STEPS - 1))] == rows[k:]


@both
def test_model_exchange_comes_back_to_its_mode(fmi: int, unpacked: Unpacked) -> None:
    """Event mode and continuous-time mode are part of the state."""
    with Host(unpacked("load", fmi), interface="me") as host:
        host.initialize()
        continuous = host.take()
        host.fmu.enterEventMode()
        event = host.take()
        host.put(continuous)
        host.set_states(host.states())
        host.put(event)
        assert "is not allowed in event mode" in host.refusal(host.set_states, host.states())


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
