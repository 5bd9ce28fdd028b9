"""The parameter `solver`: an enumeration, set as an integer, fixed once a run has begun; and what the solver tells."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cablefmu.cable import SolverChoice
from tests.conftest import Unpacked
from tests.fmu_helpers import Host, small_scene, unpack

both = pytest.mark.parametrize("fmi", [2, 3])
AUTOMATIC, EXPLICIT, IMPLICIT = 1, 2, 3
WORK = ("solver.stiff", "solver.jacobians")


@both
@pytest.mark.parametrize(("choice", "value"), [*zip(SolverChoice, (1, 2, 3), strict=True)])
def test_it_starts_as_the_scene_says(choice: SolverChoice, value: int, fmi: int, tmp_path: Path) -> None:
    scene = small_scene("load")
    folder = unpack(replace(scene, cable=replace(scene.cable, solver=choice)), tmp_path, fmi)
    with Host(folder) as host:
        assert host.get_choice("solver") == value
        host.set_choices(("solver", AUTOMATIC if value != AUTOMATIC else EXPLICIT))
        assert host.get_choice("solver") != value
        host.fmu.reset()
        assert host.get_choice("solver") == value


@both
def test_it_chooses(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        work = {}
        for choice in (EXPLICIT, IMPLICIT):
            host.set_choices(("solver", choice))
            host.initialize(u_m1=500.0).step(0.0, 0.5)
            work[choice] = host.get(*WORK)
            assert host.get_choice("solver") == choice
            host.fmu.reset()
    assert work[EXPLICIT] == [0.0, 0.0]
    stiff, jacobians = work[IMPLICIT]
    assert stiff == 1.0 and jacobians >= 1.0


@both
def test_it_can_be_set_in_initialization_mode(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.enter_initialization()
        host.set_choices(("solver", IMPLICIT))
        host.fmu.exitInitializationMode()
        host.step(0.0, 0.1)
        assert host.get("solver.stiff") == [1.0]


@both
@pytest.mark.parametrize("interface", ["cs", "me"])
def test_it_stays_fixed_once_the_run_has_begun(interface: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi), interface=interface) as host:
        host.initialize()
        message = host.refusal(host.set_choices, ("solver", EXPLICIT))
        assert message == "solver = 2 at t = 0 s: parameters and start values are fixed once initialization has ended"
        assert host.get_choice("solver") == AUTOMATIC


@both
@pytest.mark.parametrize("value", [0, 4, -1, 2**31 - 1, -(2**31)])
def test_other_values_are_refused(value: int, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        # The first of the list is in order, and must not be taken either.
        message = host.refusal(host.set_choices, ("solver", EXPLICIT), ("solver", value))
        assert message == f"solver = {value} at t = 0 s: 1 (automatic), 2 (explicit) or 3 (implicit) is expected"
        assert host.get_choice("solver") == AUTOMATIC


@pytest.mark.parametrize("value", [2**63 - 1, -(2**63), 2**32 + 1])
def test_the_whole_range_of_integers_is_looked_at(value: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3)) as host:
        assert host.refusal(host.set_choices, ("solver", value)).startswith(
            f"solver = {value} at t = 0 s: 1 (automatic)"
        )


ENUMERATION = "it is an enumeration, read and set as an integer (fmi2GetInteger and fmi2SetInteger, fmi3GetInt64"
REAL = "it is a real number, read and set as such (fmi2GetReal and fmi2SetReal, fmi3GetFloat64 and fmi3SetFloat64)"


@both
def test_functions_for_real_numbers_do_not_take_it(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        reference = host.reference["solver"]
        assert host.refusal(host.get_reals, [reference]).startswith(f"solver at t = 0 s: {ENUMERATION}")
        write = host.fmu.setReal if fmi == 2 else host.fmu.setFloat64
        assert host.refusal(write, [reference], [2.0]).startswith(f"solver = 2 at t = 0 s: {ENUMERATION}")
        assert host.get_choice("solver") == AUTOMATIC


@both
@pytest.mark.parametrize("name", ["m_c", "u_m1", "theta[2]", "omega[3]", "der(v_m1)", "x_c", "solver.steps"])
def test_functions_for_enumerations_take_nothing_else(name: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        (before,) = host.get(name)
        assert host.refusal(host.get_choice, name) == f"{name} at t = 0 s: {REAL}"
        assert host.refusal(host.set_choices, ("solver", EXPLICIT), (name, 2)) == f"{name} = 2 at t = 0 s: {REAL}"
        assert (host.get(name), host.get_choice("solver")) == ([before], AUTOMATIC)


@both
def test_references_and_pointers_are_checked(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        last = max(host.reference.values())
        host.reference["nothing"] = last + 1
        says = f"value reference {last + 1} does not exist; they end with {last}"
        assert host.refusal(host.get_choice, "nothing") == says
        assert host.refusal(host.set_choices, ("nothing", 1)) == says
        for name in ("Get", "Set"):
            function = f"fmi2{name}Integer" if fmi == 2 else f"fmi3{name}Int64"
            one, none = ctypes.c_size_t(1), ctypes.c_size_t(0)
            assert host.raw(function, None, one, None, *([one] if fmi == 3 else [])) == 3
            assert host.messages[-1] == f"{function}: a null pointer was given"
            assert host.raw(function, None, none, None, *([none] if fmi == 3 else [])) == 0


@both
def test_choices_are_fixed_by_then(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize().run(0.1)
        host.fmu.terminate()
        assert host.get_choice("solver") == AUTOMATIC
        assert "is not allowed after termination" in host.refusal(host.set_choices, ("solver", EXPLICIT))


# --- what the solver says of itself ---


@both
def test_health_is_told_in_co_simulation(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        health = [name for name in host.names("output") if name.startswith("solver.")]
        host.initialize(u_m1=500.0)
        assert host.get(*health) == [0.0] * 8
        host.step(0.0, 0.5)
        told = dict(zip(health, host.get(*health), strict=True))
    assert told["solver.steps"] >= 1.0 and told["solver.rhs"] > told["solver.steps"]
    assert told["solver.step_size"] > 0.0
    # A step is accepted if its error is within the tolerance, 1e-6 unless the host says otherwise.
    assert 0.0 < told["solver.error_estimate"] <= 1e-6
    assert np.all(np.isfinite(list(told.values())))


@both
def test_the_energy_residual_is_of_the_present_state(fmi: int, unpacked: Unpacked) -> None:
    """Change of energy, less force times way, plus what drag and dampers took: what is left is the solution's error."""
    residuals = []
    for tolerance in (1e-5, 1e-9):
        with Host(unpacked("load", fmi)) as host:
            host.enter_initialization(tolerance=tolerance)
            host.set(u_m1=500.0)
            host.fmu.exitInitializationMode()
            before, heave = host.get("energy", "y_m1")
            host.step(0.0, 0.5)
            (residual,) = host.get("solver.energy_residual")
            taken = before + 500.0 * (host.get("y_m1")[0] - heave) - host.get("energy")[0]
            assert 0.0 < abs(residual) < 1e-2 * taken
            assert host.get("solver.energy_residual", "x_c", "solver.energy_residual")[::2] == [residual] * 2
        residuals.append(abs(residual))
    # Tolerances are four orders apart; two will do to tell errors of a solution from mistakes of bookkeeping.
    assert residuals[1] < 1e-2 * residuals[0]


@both
def test_health_keeps_its_start_value_in_model_exchange(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi), interface="me") as host:
        host.set_choices(("solver", IMPLICIT))
        host.initialize(u_m1=500.0)
        health = [name for name in host.names("output") if name.startswith("solver.")]
        for k in range(5):
            host.fmu.setTime(0.01 * k)
            host.set_states(host.states() + 0.01 * host.derivatives())
            assert host.get(*health) == [0.0] * 8


def longest_step(host: Host, before: Callable[[Host, int], object]) -> float:
    """Of the implicit method in 100 communication steps of 0.01 s, with something done before each."""
    host.set_choices(("solver", IMPLICIT))
    host.enter_initialization(tolerance=1e-4)
    host.fmu.exitInitializationMode()
    steps = []
    for k in range(100):
        before(host, k)
        host.step(0.01 * k, 0.01)
        steps += host.get("solver.step_size")
    return max(steps)


@both
def test_steps_go_beyond_communication_points_while_the_inputs_rest(
    fmi: int, unpacked_from_equilibrium: Unpacked
) -> None:
    def slope(host: Host, k: int) -> None:
        host.fmu.setRealInputDerivatives([host.reference["u_m1"]], [1], [1e-6])

    folder = unpacked_from_equilibrium("load", fmi)
    with Host(folder) as host:
        assert longest_step(host, lambda host, k: None) > 0.02
    with Host(folder) as host:
        assert longest_step(host, lambda host, k: host.set(u_m1=1e-6 * k)) < 0.01 * (1.0 + 1e-9)
    if fmi == 2:
        with Host(folder) as host:
            assert longest_step(host, slope) < 0.01 * (1.0 + 1e-9)
    else:
        with Host(folder, ask=lambda host, time: host.set(u_m1=1e-6 * time)) as host:
            assert longest_step(host, lambda host, k: None) < 0.01 * (1.0 + 1e-9)


@both
def test_a_force_that_jumps_ends_what_went_beyond(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """At rest the implicit method runs far ahead; a jump at a communication point must still take effect there."""
    found = []
    for choice in (EXPLICIT, IMPLICIT, AUTOMATIC):
        with Host(unpacked_from_equilibrium("load", fmi)) as host:
            host.set_choices(("solver", choice))
            host.enter_initialization(tolerance=1e-8)
            host.fmu.exitInitializationMode()
            for k in range(100):
                if k in (37, 62):
                    host.set(u_m1=800.0, F_cx=90.0 * (k - 50))
                host.step(0.01 * k, 0.01)
            found.append(host.get("y_m1", "x_c", "vx_c"))
    assert abs(found[0][0]) > 0.01
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=0.0, atol=1e-6)


@both
def test_a_second_run_remembers_nothing_of_the_first(fmi: int, unpacked: Unpacked) -> None:
    """Step sizes, slopes, method: a run with the implicit method leaves no trace in the next."""
    with Host(unpacked("load", fmi)) as host:
        first = host.initialize(u_m1=500.0).run(0.5)
        host.fmu.reset()
        host.set_choices(("solver", IMPLICIT))
        host.initialize(u_m1=500.0).run(0.5)
        host.fmu.reset()
        np.testing.assert_array_equal(host.initialize(u_m1=500.0).run(0.5), first)
