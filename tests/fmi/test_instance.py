"""One instance: starts over, keeps to itself, and refuses in a sentence what it cannot take."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import Host, small_scene

both = pytest.mark.parametrize("fmi", [2, 3])


@both
def test_a_reset_run_gives_the_same_bits(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("floater", fmi)) as host:
        first = host.initialize(M_2=450.0, u_m1=500.0).run(1.0)
        host.fmu.reset()
        assert host.get("M_2", "u_m1") == [500.0, 0.0]
        again = host.initialize(M_2=450.0, u_m1=500.0).run(1.0)
    np.testing.assert_array_equal(again, first)


@both
def test_instances_do_not_disturb_each_other(fmi: int, unpacked: Unpacked) -> None:
    folder = unpacked("load", fmi)
    with Host(folder) as alone:
        expected = alone.initialize(m_c=90.0).run(1.0)
    with Host(folder) as one, Host(folder) as other:
        one.initialize(m_c=90.0)
        other.initialize(u_m1=5000.0, m_c=10.0)
        names = one.names("output")
        rows = [one.get(*names)]
        for k in range(10):
            other.step(k * 0.1, 0.1)
            one.step(k * 0.1, 0.1)
            rows.append(one.get(*names))
    np.testing.assert_array_equal(rows, expected)


@both
@pytest.mark.parametrize("interface", ["cs", "me"])
def test_looking_changes_nothing(fmi: int, interface: str, unpacked: Unpacked) -> None:
    """Outputs and derivatives are functions of the state: read twice, in any order, they are the same bits."""
    with Host(unpacked("load", fmi), interface=interface) as host:
        host.initialize(u_m1=100.0)
        names = host.names("output", "local")
        forward = host.get(*names)
        backward = [host.get(name)[0] for name in reversed(names)][::-1]
        assert forward == backward == host.get(*names)


@both
def test_an_input_takes_effect_at_once(fmi: int, unpacked: Unpacked) -> None:
    """M y'' = F: the floater's acceleration without the cable's share is not there until the force is."""
    with Host(unpacked("load", fmi), interface="me") as host:
        host.initialize()
        (before,) = host.get("der(v_m1)")
        host.set(u_m1=600.0)
        (after,) = host.get("der(v_m1)")
    # The mass that moves with the floater is between the floater's own and that of everything.
    scene = small_scene("load").cable
    everything = 600.0 + 60.0 + float(np.sum(scene.links.mass))
    assert 600.0 / everything < after - before < 600.0 / 600.0


NOT_NUMBERS = (math.nan, math.inf, -math.inf)


@both
@pytest.mark.parametrize("value", NOT_NUMBERS)
@pytest.mark.parametrize("name", ["u_m1", "m_c", "theta[2]", "v_m1"])
def test_what_is_no_number_is_refused_by_name_and_time(name: str, value: float, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        (before,) = host.get(name)
        message = host.refusal(host.set_all, {name: value})
        assert message == f"{name} = {value} at t = 0 s: a finite number is expected"
        assert host.get(name) == [before]


@both
@pytest.mark.parametrize("value", NOT_NUMBERS)
def test_during_a_run_the_message_names_the_present_time(value: float, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize().run(0.5)
        assert host.refusal(host.set, F_cx=value) == f"F_cx = {value} at t = 0.5 s: a finite number is expected"
        host.step(0.5, 0.1)  # and the instance is none the worse


@both
@pytest.mark.parametrize("value", NOT_NUMBERS)
@pytest.mark.parametrize(("k", "name"), [(0, "y_m1"), (3, "theta[3]"), (6, "v_m1"), (11, "omega[5]")])
def test_a_state_that_is_no_number_is_named(k: int, name: str, value: float, fmi: int, unpacked: Unpacked) -> None:
    """The integrator's mistake shows when derivatives are asked for."""
    with Host(unpacked("load", fmi), interface="me") as host:
        host.initialize()
        host.fmu.setTime(1.5)
        x = host.states()
        x[k] = value
        host.set_states(x)
        assert host.refusal(host.derivatives) == f"{name} is {value} at t = 1.5 s: a finite number is expected"


@both
def test_a_link_that_has_wound_up_is_named(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi), interface="me") as host:
        host.initialize()
        x = host.states()
        x[2] = 2e6
        host.set_states(x)
        assert "theta[2] is 2000000 rad at t = 0 s: the link has wound up" in host.refusal(host.derivatives)


@both
@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("m_c", -60.0, "a number above 0 is expected"),
        ("M_1", 0.0, "a number above 0 is expected"),
        ("rho_c", -1.0, "a number above 0 is expected"),
        ("c_joint", -1e-3, "a number of 0 or more is expected"),
        ("rho_w", -1000.0, "a number of 0 or more is expected"),
    ],
)
def test_impossible_parameters_are_refused(name: str, value: float, allowed: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        message = host.refusal(host.set_all, {name: value})
        assert message.startswith(f"{name} = ")
        assert message.endswith(f" at t = 0 s: {allowed}")


@both
@pytest.mark.parametrize("name", ["m_c", "theta[1]"])
def test_what_is_fixed_stays_fixed_once_the_run_has_begun(name: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize()
        assert "fixed once initialization has ended" in host.refusal(host.set_all, {name: 1.0})


@both
@pytest.mark.parametrize("name", ["x_c", "tension_top", "der(theta[1])", "der(v_m1)", "solver.steps"])
def test_what_is_calculated_cannot_be_set(name: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        message = host.refusal(host.set_all, {name: 1.0})
        assert message == f"{name} = 1 at t = 0 s: it is calculated and cannot be set"


@both
def test_a_refused_list_changes_nothing(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.refusal(host.set, m_c=70.0, M_1=-1.0)
        assert host.get("m_c", "M_1") == [60.0, 600.0]


@both
def test_unknown_references_are_refused(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        last = max(host.reference.values())
        host.reference["nothing"] = last + 1
        expected = f"value reference {last + 1} does not exist; they end with {last}"
        assert host.refusal(host.get, "nothing") == expected
        assert host.refusal(host.set, nothing=1.0) == expected


@both
@pytest.mark.parametrize("count", [0, 11, 13, 2**40])
def test_states_of_a_wrong_number_are_refused(count: int, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi), interface="me") as host:
        host.initialize()
        message = host.refusal(host.set_states, host.states(), count=count)
        assert message == f"{count} states were given or asked for; this cable has 12"


@both
@pytest.mark.parametrize("length", [0.0, -0.1, math.nan, math.inf])
def test_steps_go_forward(length: float, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize()
        assert "a number above 0 is expected" in host.refusal(host.step, 0.0, length)
        host.step(0.0, 0.1)


@both
@pytest.mark.parametrize("point", [0.0, 0.1 - 1e-6, 0.2, math.nan])
def test_steps_join(point: float, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize()
        host.step(0.0, 0.1)
        assert "is not where the last step ended" in host.refusal(host.step, point, 0.1)


@both
def test_a_host_may_add_up_its_steps(fmi: int, unpacked: Unpacked) -> None:
    """t += h drifts by rounding from k h; both are accepted."""
    with Host(unpacked("load", fmi)) as host:
        host.initialize()
        time = 0.0
        for _ in range(1000):
            host.step(time, 0.1)
            time += 0.1
        assert time != 100.0


@both
def test_a_violent_force_ends_the_step_with_time_and_reason(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize().run(0.3)
        host.set(F_cx=1e300)
        message = host.refusal(host.step, 0.3, 0.1)
        assert message.startswith("doStep ended at t = 0.3")
        assert "the motion is too violent" in message
        # After an error: look, reset or free.
        assert all(map(math.isfinite, host.get("x_c", "y_c")))
        assert "is not allowed after an error" in host.refusal(host.step, 0.3, 0.1)
        host.fmu.reset()
        host.initialize().run(0.2)


@both
def test_the_start_time_is_the_hosts(fmi: int, unpacked: Unpacked) -> None:
    """Nothing in the cable depends on time itself: a run from 100 s is the run from 0 s, but for rounding of t."""
    with Host(unpacked("load", fmi)) as host:
        from_zero = host.initialize(u_m1=300.0).run(1.0)[-1]
        host.fmu.reset()
        host.set(u_m1=300.0)
        host.enter_initialization(start=100.0)
        host.fmu.exitInitializationMode()
        for k in range(10):
            host.step(100.0 + k * 0.1, 0.1)
        assert host.get("time") == [101.0] if fmi == 3 else "time" not in host.reference
        np.testing.assert_allclose(host.get(*host.names("output")), from_zero, rtol=1e-9)


@both
@pytest.mark.parametrize("tolerance", [0.0, -1e-6, math.nan, math.inf])
def test_tolerances_are_positive(tolerance: float, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        message = host.refusal(host.enter_initialization, tolerance=tolerance)
        assert message.endswith(": a number above 0 is expected")


@both
def test_the_tolerance_is_the_solvers(fmi: int, unpacked: Unpacked) -> None:
    def run(tolerance: float) -> tuple[float, float]:
        with Host(unpacked("load", fmi)) as host:
            host.enter_initialization(tolerance=tolerance)
            host.fmu.exitInitializationMode()
            host.step(0.0, 2.0)
            return host.get("x_c")[0], host.get("solver.steps")[0]

    (loose, few), (tight, more), (exact, most) = run(1e-4), run(1e-7), run(1e-11)
    assert few < more < most
    # Over a swing of 5 m in 2 s the error is of the size of the tolerance.
    assert abs(tight - exact) < 1e-7 < abs(loose - exact) < 1e-3


@both
def test_results_do_not_depend_on_the_current_folder(
    fmi: int, unpacked: Unpacked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Host(unpacked("load", fmi)) as host:
        here = host.initialize().run(0.5)
    monkeypatch.chdir(tmp_path)
    with Host(unpacked("load", fmi)) as host:
        there = host.initialize().run(0.5)
    np.testing.assert_array_equal(there, here)


@both
@pytest.mark.parametrize("starts", ["shape", "equilibrium"])
def test_states_may_be_moved_as_variables_in_model_exchange(
    starts: str, fmi: int, unpacked: Unpacked, unpacked_from_equilibrium: Unpacked
) -> None:
    """Casadi's importer does so; it is the same as fmi2SetContinuousStates. In Co-Simulation they are the solver's."""
    folder = (unpacked if starts == "shape" else unpacked_from_equilibrium)("load", fmi)
    with Host(folder, interface="me") as host:
        host.initialize()
        x = host.states() + 0.01
        host.set_all({f"theta[{i}]": float(x[i]) for i in range(1, 6)})
        host.set(y_m1=float(x[0]), v_m1=float(x[6]))
        host.set_all({f"omega[{i}]": float(x[6 + i]) for i in range(1, 6)})
        assert host.states().tolist() == x.tolist()
        by_variables = host.derivatives()
        host.set_states(x)
        assert host.derivatives().tolist() == by_variables.tolist()
    with Host(folder) as host:
        host.initialize()
        assert "fixed once initialization has ended" in host.refusal(host.set, y_m1=0.01)
