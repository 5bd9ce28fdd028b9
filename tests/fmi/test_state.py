"""The complete state: a run goes on from it with the same bits, wherever and after whatever it is put back."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS, Host, levered, small_scene, unpack

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
    host.set_all(levered(host.reference, values))
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
        host.set_all(levered(host.reference, {"u_m1": 100.0 * (k * 7 % 11 - 5)}))
    if host.fmi == 2 and 10 <= k < 12:
        for name, value in levered(host.reference, {"u_m1": 50.0}).items():
            slope(host, name, value)
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
