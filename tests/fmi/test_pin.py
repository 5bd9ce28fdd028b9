"""A cable whose lower end is pinned: the end stays where it is, whoever integrates and whatever the start."""

from __future__ import annotations

import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import Host

both = pytest.mark.parametrize("fmi", [2, 3])

PIN = (12.0, 13.0)
HOLDS = 1e-12
"""Of 20 m of cable: the kernel projects every step onto the pin to 1e-14 of the length; the rest is rounding."""


@both
@pytest.mark.parametrize("solver", [1, 2, 3])
def test_the_end_stays_in_co_simulation(solver: int, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("pin", fmi)) as host:
        assert "m_c" not in host.reference and host.names("input") == ["u_m1"]
        host.set_choices(("solver", solver))
        host.initialize(u_m1=400.0)
        for k in range(10):
            host.step(0.1 * k, 0.1)
            x, y, vx, vy = host.get("x_c", "y_c", "vx_c", "vy_c")
            assert np.hypot(x - PIN[0], y - PIN[1]) < HOLDS * 20.0
            assert np.hypot(vx, vy) < 1e-9
        assert abs(host.get("y_m1")[0]) > 1e-2, "the force has moved the floater"


@both
def test_the_end_is_not_accelerated_in_model_exchange(fmi: int, unpacked: Unpacked) -> None:
    """Velocity and place of P_n have no derivative: central differences along the motion find none."""
    with Host(unpacked("pin", fmi), interface="me") as host:
        host.initialize(u_m1=400.0)
        x, slope, h = host.states(), host.derivatives(), 1e-6
        ends = []
        for sign in (-1.0, 1.0):
            host.set_states(x + sign * h * slope)
            ends.append(host.get("x_c", "y_c", "vx_c", "vy_c"))
    # Rounding of 13 m and of rates that h multiplies, over 2 h; gravity is 10 m/s2.
    np.testing.assert_allclose((np.array(ends[1]) - ends[0]) / (2.0 * h), 0.0, atol=1e-7)


@both
@pytest.mark.parametrize("interface", ["cs", "me"])
def test_it_hangs_from_the_pin_at_rest(interface: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    with Host(unpacked_from_equilibrium("pin", fmi), interface=interface) as host:
        host.initialize(u_m1=200.0)
        x, y, residual = host.get("x_c", "y_c", "statics.residual")
        heave, tension = host.get("y_m1", "tension_top")
        assert np.hypot(x - PIN[0], y - PIN[1]) < HOLDS * 20.0
        assert residual < 1e-7
        # The spring alone would give by u / k; the cable gets slacker as it gives, and pulls less.
        assert 0.0 < heave < 200.0 / 1200.0
        assert tension > 0.0
