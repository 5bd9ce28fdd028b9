"""The right-hand side is a pure function, and the outputs are those of the dense reference."""

from __future__ import annotations

import ctypes
import platform
from pathlib import Path

import numpy as np
import pytest

from tests.kernel.cases import case
from tests.kernel.library import inputs_of
from tests.random_cables import KINDS

EVERY_KIND = pytest.mark.parametrize("kind", range(len(KINDS)))
PATH = 1e-13
"""Positions and velocities over the cable's length and fastest point: sums of up to 120 rounded terms."""
PULL = 1e-10
"""Tensions over the largest joint force: 16 digits less the condition of the dense reference's I(x)."""
TENSIONS = {"tension_top", "tension_end", "tension_max"}


@EVERY_KIND
def test_two_calls_give_the_same_bits_and_change_nothing(library: ctypes.CDLL, kind: int) -> None:
    """Not even scratch carries anything over: it is filled with NaN, and with another state's, in between."""
    c, other = case(library, 12, kind), case(library, 12, kind, draw=1)
    x, u = np.concatenate([c.q, c.v]), inputs_of(c.inputs)
    constants, links, x_before, u_before = c.kernel.constants(), c.kernel.links.copy(), x.copy(), u.copy()
    first = c.kernel.derivatives(x, u)
    c.kernel.spoil_scratch()
    second = c.kernel.derivatives(x, u)
    c.kernel.derivatives(np.concatenate([other.q, other.v]), u)
    third = c.kernel.derivatives(x, u)
    assert np.all(np.isfinite(first))
    assert first.tobytes() == second.tobytes() == third.tobytes()
    assert x.tobytes() == x_before.tobytes()
    assert u.tobytes() == u_before.tobytes()
    assert c.kernel.constants().tobytes() == constants.tobytes()
    assert c.kernel.links.tobytes() == links.tobytes()


def test_first_half_of_the_derivative_is_the_velocity(library: ctypes.CDLL) -> None:
    c = case(library, 12, 0)
    derivative = c.kernel.derivatives(np.concatenate([c.q, c.v]), inputs_of(c.inputs))
    assert derivative[:13].tobytes() == c.v.tobytes()


@EVERY_KIND
@pytest.mark.parametrize("n", [1, 2, 3, 12, 60, 120])
def test_outputs_are_those_of_the_reference(library: ctypes.CDLL, n: int, kind: int) -> None:
    c = case(library, n, kind)
    found, expected = (model.outputs(c.q, c.v, c.inputs) for model in (c.kernel, c.reference))
    assert set(found) == set(expected)
    length = c.cable.links.length.sum()
    path, speed = PATH * length, PATH * (abs(c.v[0]) + np.abs(c.v[1:]).max() * length)
    pull = PULL * np.abs(c.reference.joint_forces(c.q, c.v, c.inputs)).max()
    room = {"y_m1": 0.0, "v_m1": 0.0, "x_c": path, "y_c": path, "vx_c": speed, "vy_c": speed}
    room |= dict.fromkeys(TENSIONS, pull)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-12, abs=room.get(name, 0.0)), name


@EVERY_KIND
def test_outputs_without_tensions_are_the_same_bits(library: ctypes.CDLL, kind: int) -> None:
    """What hosts ask for most needs no accelerations, and must not depend on whether they were there."""
    c = case(library, 12, kind)
    cheap, full = c.kernel.outputs_without_tensions(c.q, c.v), c.kernel.outputs(c.q, c.v, c.inputs)
    assert {name for name, value in cheap.items() if np.isnan(value)} == TENSIONS
    assert all(cheap[name] == full[name] for name in set(full) - TENSIONS)


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 60, 121])
def test_both_compiled_variants_give_the_same_bits(library: ctypes.CDLL, n: int, kind: int) -> None:
    """What AVX2 runs side by side is the same arithmetic: results do not depend on the processor."""
    c = case(library, n, kind)
    if not c.kernel.use_avx2(True):
        assert platform.machine() != "x86_64" or "avx2" not in Path("/proc/cpuinfo").read_text(encoding="ascii")
        return
    wide = c.kernel.acceleration(c.q, c.v, c.inputs)
    assert not c.kernel.use_avx2(False)
    assert c.kernel.acceleration(c.q, c.v, c.inputs).tobytes() == wide.tobytes()
