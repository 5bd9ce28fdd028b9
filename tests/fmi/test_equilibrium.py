"""Runs that start from equilibrium: what initialization mode shows, and what it says where there is none."""

from __future__ import annotations

import re

import numpy as np
import pytest

from cablefmu.cable import Floats
from cablefmu.reference import Reference
from tests.conftest import Unpacked
from tests.fmu_helpers import Host, small_scene, with_parameters

both = pytest.mark.parametrize("fmi", [2, 3])
interfaces = pytest.mark.parametrize("interface", ["cs", "me"])
KINDS = ("air", "load", "load-volume", "anchor-spring", "pin", "floater")
"""An anchor of mass is held where it stands, and gives way by what pulls at it over that mass: no full balance."""

BALANCE = 1e-7
"""Largest acceleration left [m/s2, rad/s2]: 1e-8 of gravity, well above the rounding of kilonewtons on kilograms."""


def shape(host: Host) -> Floats:
    return np.array(host.get("y_m1", *(f"theta[{i}]" for i in range(1, 6))))


def rates(host: Host) -> Floats:
    return np.array(host.get("v_m1", *(f"omega[{i}]" for i in range(1, 6))))


def accelerations(host: Host) -> Floats:
    return np.array(host.get("der(v_m1)", *(f"der(omega[{i}])" for i in range(1, 6))))


@both
@pytest.mark.parametrize("kind", KINDS)
def test_forces_balance_by_the_dense_equations(kind: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """The reference model shares no code with the kernel: it must find nothing that moves."""
    scene = with_parameters(small_scene(kind), g=9.7)
    inputs = {name: 40.0 + 30.0 * k for k, name in enumerate(scene.cable.inputs)}
    with Host(unpacked_from_equilibrium(kind, fmi)) as host:
        host.initialize(g=9.7, **inputs)
        q, v = shape(host), rates(host)
        residual, iterations = host.get("statics.residual", "statics.iterations")
    assert np.abs(q - scene.cable.position).max() > 1e-3, "the start shape itself is no equilibrium"
    assert not np.any(v)
    assert np.abs(Reference(scene.cable).acceleration(q, v, inputs)).max() < BALANCE
    assert residual < BALANCE and iterations >= 1.0


@both
def test_a_load_hangs_where_its_forces_point(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """Without joint stiffness each link points along the force that it carries: tan th_i = F_x / (weight below)."""
    scene = small_scene("load")
    links, force = scene.cable.links, 300.0
    submerged = links.mass - scene.cable.parameters["rho_w"] * links.volume
    load = scene.cable.parameters["m_c"] * (1.0 - scene.cable.parameters["rho_w"] / scene.cable.parameters["rho_c"])
    below = load + np.cumsum(submerged[::-1])[::-1] - submerged / 2.0
    with Host(unpacked_from_equilibrium("load", fmi)) as host:
        host.initialize(k_joint=0.0, F_cx=force)
        angles = shape(host)[1:]
    np.testing.assert_allclose(angles, np.arctan2(force, below * 9.81), rtol=0.0, atol=1e-8)


@both
@interfaces
def test_initialization_mode_shows_the_equilibrium_for_what_is_set_so_far(
    interface: str, fmi: int, unpacked_from_equilibrium: Unpacked
) -> None:
    with Host(unpacked_from_equilibrium("load", fmi), interface=interface) as host:
        start = shape(host)
        np.testing.assert_array_equal(start, small_scene("load").cable.position)
        host.enter_initialization()
        hanging = host.get("x_c", "y_c", "statics.residual")
        assert hanging[0] == pytest.approx(0.0, abs=1e-8)
        host.set(F_cx=200.0)
        pulled = host.get("x_c", "y_c", "statics.residual")
        assert pulled[0] > 1.0
        host.set(m_c=200.0)
        heavier = host.get("x_c")
        assert 0.1 < heavier[0] < pulled[0]
        # What was looked at before leaves no trace: the same settings, the same bits.
        host.set(m_c=60.0)
        assert host.get("x_c", "y_c", "statics.residual") == pulled
        host.set(F_cx=0.0)
        assert host.get("x_c", "y_c", "statics.residual") == hanging


STATES = ["y_m1", *(f"theta[{i}]" for i in range(1, 6)), "v_m1", *(f"omega[{i}]" for i in range(1, 6))]


@both
@interfaces
def test_whatever_is_read_first_shows_it(interface: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """No way of reading sees the shape that was there before, and none changes what the next one sees."""
    derivatives = [f"der({name})" for name in STATES]
    with Host(unpacked_from_equilibrium("floater", fmi), interface=interface) as host:
        everything = host.names("output", "local")
        host.enter_initialization()
        expected = dict(zip(everything, host.get(*everything), strict=True))
        for first in ("x_c", "tension_end", "energy", "theta[3]", "der(omega[2])", "statics.iterations"):
            host.fmu.reset()
            host.get(*everything)
            host.enter_initialization()
            assert host.get(first) == [expected[first]]
            assert host.get(*everything) == list(expected.values())
        if interface == "me":
            for names, read in ((STATES, host.states), (derivatives, host.derivatives)):
                host.fmu.reset()
                host.enter_initialization()
                assert read().tolist() == [expected[name] for name in names]


@both
def test_the_residual_is_the_largest_acceleration_left(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    with Host(unpacked_from_equilibrium("anchor-spring", fmi)) as host:
        host.enter_initialization()
        # The two come from the same state; rounding of the forces is all that may part them.
        assert host.get("statics.residual")[0] == pytest.approx(np.abs(accelerations(host)).max(), abs=1e-10)


@both
def test_the_search_begins_with_the_states_as_they_were_set(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    with Host(unpacked_from_equilibrium("load", fmi)) as host:
        host.enter_initialization()
        host.set(F_cx=150.0)
        far, found = host.get("statics.iterations")[0], shape(host)
        host.fmu.reset()
        near = {f"theta[{i}]": value for i, value in enumerate(found) if i} | {"omega[2]": 0.5}
        host.set_all(near)
        assert host.get(*near) == list(near.values())
        host.enter_initialization()
        host.set(F_cx=150.0)
        assert host.get("statics.iterations")[0] < far
        np.testing.assert_allclose(shape(host), found, rtol=0.0, atol=1e-8)
        assert not np.any(rates(host))


@both
@interfaces
def test_the_start_is_fixed_when_initialization_ends(
    interface: str, fmi: int, unpacked_from_equilibrium: Unpacked
) -> None:
    with Host(unpacked_from_equilibrium("load", fmi), interface=interface) as host:
        host.initialize(F_cx=100.0)
        before, told = shape(host), host.get("statics.residual", "statics.iterations")
        assert np.abs(accelerations(host)).max() < BALANCE
        host.set(F_cx=500.0)
        np.testing.assert_array_equal(shape(host), before)
        assert np.abs(accelerations(host)).max() > 0.1, "the force is there, and the cable is not at rest under it"
        assert host.get("statics.residual", "statics.iterations") == told


@both
def test_a_run_stays_there(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    with Host(unpacked_from_equilibrium("floater", fmi)) as host:
        host.initialize(u_m1=200.0, u_m2=-50.0)
        start = shape(host)
        host.run(1.0)
        # A stable equilibrium holds what is left of the forces back; the tolerance is 1e-6.
        np.testing.assert_allclose(shape(host), start, rtol=0.0, atol=1e-6)


@both
def test_reset_forgets_it(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    with Host(unpacked_from_equilibrium("load", fmi)) as host:
        first = host.initialize(F_cx=100.0).run(0.5)
        host.fmu.reset()
        np.testing.assert_array_equal(shape(host), small_scene("load").cable.position)
        assert host.get("statics.residual", "statics.iterations") == [0.0, 0.0]
        np.testing.assert_array_equal(host.initialize(F_cx=100.0).run(0.5), first)


NONE = re.compile(
    r"no stable equilibrium was found near the start shape at t = 0 s: the forces could not be balanced; the largest"
    r" acceleration left is [\d.e+-]+ m/s2 or rad/s2 after \d+ iterations\. Other inputs, parameters or start angles"
    r' are expected, or a scene without initial = "equilibrium"'
)


@both
@interfaces
def test_what_cannot_rest_is_said_and_can_be_mended(
    interface: str, fmi: int, unpacked_from_equilibrium: Unpacked
) -> None:
    """A floater without spring under a force: nothing holds it."""
    with Host(unpacked_from_equilibrium("load", fmi), interface=interface) as host:
        host.set(k_m1=0.0, u_m1=100.0)
        host.enter_initialization()
        for name in ("x_c", "theta[1]", "der(v_m1)", "tension_top", "statics.residual"):
            assert NONE.fullmatch(host.refusal(host.get, name))
        assert host.get("k_m1", "u_m1") == [0.0, 100.0]
        assert NONE.fullmatch(host.refusal(host.fmu.exitInitializationMode))
        host.set(k_m1=1000.0)
        host.fmu.exitInitializationMode()
        assert host.get("y_m1")[0] == pytest.approx(0.1, abs=1e-8)  # u_m1 / k_m1


@both
def test_a_start_that_is_beyond_all_angles_is_named(fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    with Host(unpacked_from_equilibrium("load", fmi)) as host:
        host.set_all({"theta[2]": 2e6})
        host.enter_initialization()
        assert "theta[2] is 2000000 rad at t = 0 s: the link has wound up" in host.refusal(host.get, "x_c")


@both
def test_scenes_that_start_from_their_shape_have_none_of_it(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        assert not any(name.startswith("statics") for name in host.reference)
        host.initialize()
        np.testing.assert_array_equal(shape(host), small_scene("load").cable.position)
