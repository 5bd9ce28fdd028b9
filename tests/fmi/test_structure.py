"""The number of links as a parameter: when it may be set, to what, and what becomes of everything else."""

from __future__ import annotations

import ctypes
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.fmi.test_arrays import HELD, Arrays, run
from tests.fmu_helpers import Host


def test_what_was_set_before_is_kept(unpacked_arrays: Arrays) -> None:
    before = {"M_1": 700.0, "theta_start": -0.3, "u_m1": 50.0, "y_m1": 0.25, "v_m1": -0.5, "EI": 900.0}
    with Host(unpacked_arrays("load")) as late, Host(unpacked_arrays("load")) as early:
        late.configure(9).set_all(before)
        early.set_all(before)
        for n in (3, 10_000, 9):
            early.configure(n)
        assert early.get(*before) == list(before.values())
        assert early.get_array("theta") == [-0.3] * 9
        np.testing.assert_array_equal(run(early, 0.3), run(late, 0.3))


def test_a_reset_is_a_new_instance(unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load")) as host:
        first = run(host, 0.3)
        host.fmu.reset()
        host.configure(12).set_all({"L": 30.0})
        run(host, 0.3)
        host.fmu.reset()
        assert host.fmu.getUInt64([host.reference["n"]]) == [5]
        assert host.get("L") == [20.0]
        np.testing.assert_array_equal(run(host, 0.3), first)
        host.fmu.terminate()
        host.fmu.reset()
        host.fmu.enterConfigurationMode()
        host.fmu.reset()
        np.testing.assert_array_equal(run(host, 0.3), first)


@pytest.mark.parametrize("n", [0, 10_001, 2**32, 2**32 + 5, 2**64 - 1])
def test_sizes_out_of_range_are_refused(n: int, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load")) as host:
        host.fmu.enterConfigurationMode()
        says = host.refusal(host.fmu.setUInt64, [host.reference["n"]], [n])
        assert says == f"n = {n} at t = 0 s: a number of links from 1 to 10000 is expected"
        # Nothing of a list is taken that has a mistake in it.
        host.refusal(host.fmu.setUInt64, [host.reference["n"]] * 2, [7, n])
        assert host.fmu.getUInt64([host.reference["n"]]) == [5]
        host.fmu.exitConfigurationMode()
        run(host, 0.1)


def test_the_size_is_set_in_configuration_mode_alone(unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load")) as host:
        size = [host.reference["n"]], [7]
        wrong = "n = 7 at t = 0 s: it is set in configuration mode (fmi3EnterConfigurationMode)"
        assert host.refusal(host.fmu.setUInt64, *size) == wrong
        assert "fmi3ExitConfigurationMode is not allowed before" in host.refusal(host.fmu.exitConfigurationMode)
        host.fmu.enterConfigurationMode()
        for call in (host.fmu.enterConfigurationMode, host.enter_initialization):
            assert "is not allowed in configuration mode" in host.refusal(call)
        assert "fmi3SetFloat64 is not allowed in configuration mode" in host.refusal(host.set, M_1=1.0)
        host.fmu.exitConfigurationMode()
        host.enter_initialization()
        assert "is not allowed in initialization mode" in host.refusal(host.fmu.enterConfigurationMode)
        host.fmu.exitInitializationMode()
        assert "is not allowed between communication steps" in host.refusal(host.fmu.enterConfigurationMode)
        assert host.refusal(host.fmu.setUInt64, *size) == wrong
        assert host.fmu.getUInt64([host.reference["n"]]) == [5]


def test_types_and_sizes_are_told_apart(unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load")) as host:
        n, theta, mass, solver = (host.reference[name] for name in ("n", "theta", "M_1", "solver"))
        assert "it is a whole number, read and set as such" in host.refusal(host.fmu.getFloat64, [n])
        assert "it is a whole number, read and set as such" in host.refusal(host.fmu.setFloat64, [n], [3.0])
        assert "it is a whole number, read and set as such" in host.refusal(host.fmu.getInt64, [n])
        assert "it is a real number" in host.refusal(host.fmu.getUInt64, [mass])
        assert "it is an enumeration" in host.refusal(host.fmu.getUInt64, [solver])
        assert "does not exist" in host.refusal(host.fmu.getUInt64, [999])
        assert "as many values as references are expected" in host.refusal(host.fmu.getUInt64, [n], 2)
        for count in (1, 4, 7):
            assert "of an array all its elements" in host.refusal(host.fmu.getFloat64, [theta, mass], count)
        assert len(host.fmu.getFloat64([theta, mass, theta], 11)) == 11
        assert "does not exist" in host.refusal(host.fmu.getFloat64, [999])
        says = host.refusal(host.fmu.setFloat64, [mass, theta], [1.0] * 6)
        assert says == "theta = 1 at t = 0 s: it is calculated and cannot be set"
        assert host.get("M_1") == [600.0]
        one = ctypes.c_size_t(1)
        for function in ("fmi3GetUInt64", "fmi3SetUInt64", "fmi3GetFloat64"):
            assert host.raw(function, None, one, None, one) == 3
            assert host.messages[-1].endswith("a null pointer was given")
            assert host.raw(function, None, ctypes.c_size_t(0), None, ctypes.c_size_t(0)) == 0


@pytest.mark.parametrize("kind", HELD)
def test_a_shape_that_does_not_exist_is_said_at_the_start(kind: str, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays(kind)).configure(1) as host:
        host.enter_initialization()
        says = host.refusal(host.fmu.exitInitializationMode)
        apart = "17.48285" if kind == "between" else "17.69181"
        assert says.startswith(f"n = 1: no rest shape joins the ports; they are {apart} m apart, and the cable is 20 m")
        host.set(L=17.0)
        assert host.refusal(host.get, "x_c").endswith("the cable is 17 m long; it must be longer")
        host.set(L=20.0)
        host.fmu.reset()
        run(host.configure(2), 0.1)


def test_a_weightless_cable_has_no_rest_shape(unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("pin")) as host:
        host.set(g=0.0)
        assert "the cable has no weight" in host.refusal(host.get_array, "theta")


@pytest.mark.parametrize("name", ["L", "D", "rho_cable", "EI", "theta_start"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, 0.0])
def test_impossible_cables_are_refused(name: str, value: float, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load")) as host:
        if math.isfinite(value) and (name == "theta_start" or (name, value) == ("EI", 0.0)):
            run(host.configure(6), 0.1)
            return
        says = host.refusal(host.set_all, {name: value})
        assert says.startswith(f"{name} = {value:g} at t = 0 s: a ")
        assert says.endswith("is expected")


NO_MEMORY = """
import resource, sys
from pathlib import Path
from tests.fmu_helpers import Host
with Host(Path(sys.argv[1])) as host:
    kept = host.get_array("theta")
    host.fmu.enterConfigurationMode()
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + 2_000_000,) * 2)
    print(host.refusal(host.fmu.setUInt64, [host.reference["n"]], [10_000]))
    host.fmu.setUInt64([host.reference["n"]], [6])
    host.fmu.exitConfigurationMode()
    host.initialize()
    host.step(0.0, 0.1)
    print(len(host.get_array("theta")))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits memory as Linux does")
def test_without_memory_the_cable_keeps_its_links(unpacked_arrays: Arrays) -> None:
    done = subprocess.run(
        [sys.executable, "-c", NO_MEMORY, str(unpacked_arrays("load"))], capture_output=True, text=True,
        cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert done.stderr == ""
    assert done.stdout.splitlines() == ["n = 10000: there is no memory for so many links; the cable keeps its 5", "6"]


def test_instances_of_different_sizes_live_side_by_side(unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load")) as alone:
        expected = run(alone.configure(4), 0.3)
    with Host(unpacked_arrays("load")) as first, Host(unpacked_arrays("load")) as second:
        first.configure(4)
        second.configure(40)
        run(second, 0.2)
        np.testing.assert_array_equal(run(first, 0.3), expected)


@pytest.mark.parametrize("kind", ["load", "floater", "pin"])
def test_a_state_goes_on_in_an_instance_of_as_many_links(kind: str, unpacked_arrays: Arrays) -> None:
    """With the cable that was set, which the state brings along; another number of links is refused."""
    with Host(unpacked_arrays(kind)).configure(7) as first, Host(unpacked_arrays(kind)).configure(7) as second:
        first.set(L=21.0, EI=800.0)
        run(first, 0.3)
        state = first.fmu.getFMUState()
        image = first.fmu.serializeFMUState(state)
        second.fmu.setFMUState(second.fmu.deserializeFMUState(image))
        assert second.get("L", "EI") == [21.0, 800.0]
        for host in (first, second):
            for k in range(3, 6):
                host.step(k * 0.1, 0.1)
        assert first.get(*first.names("output")) == second.get(*second.names("output"))
        assert first.get_array("theta") == second.get_array("theta")
        second.fmu.reset()
        assert "its number of links is 7; expected is 5" in second.refusal(second.fmu.deserializeFMUState, image)
        run(second, 0.1)
