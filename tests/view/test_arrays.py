"""What a page carries is what the result holds: to the bit, or to half a step."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest

from cablefmu.cable import Floats
from cablefmu.view.arrays import doubles, steps


def counted(packed: dict[str, Any]) -> Floats:
    """Read as the format says, by itself: value = low + step * data."""
    whole = np.frombuffer(base64.b64decode(packed["data"]), dtype="<u2").reshape(-1, packed["columns"])
    return packed["low"] + packed["step"] * whole


def test_doubles_come_back_to_the_bit() -> None:
    numbers = np.array([0.1, -1e-300, 5e9, 0.0, np.pi])
    read = np.frombuffer(base64.b64decode(doubles(numbers)["data"]), dtype="<f8")
    assert read.tobytes() == numbers.tobytes()


@pytest.mark.parametrize(("low", "high"), [(-3.0, 240.0), (1e6, 1e6 + 5.0), (-2e4, 25e3)])
def test_steps_come_back_to_half_a_step(low: float, high: float) -> None:
    numbers = np.random.default_rng(3).uniform(low, high, (40, 7))
    numbers[0, 0], numbers[1, 1] = low, high
    packed = steps(numbers)
    assert packed["step"] == pytest.approx((high - low) / 65535, rel=1e-12)
    rounding = 1e-15 * max(abs(low), abs(high))
    error = np.abs(counted(packed) - numbers)
    assert error.max() <= 0.5 * packed["step"] + rounding
    assert error.max() > 0.4 * packed["step"], "steps, and not something finer that would be larger"
    assert len(base64.b64decode(packed["data"])) == 2 * numbers.size


def test_what_does_not_move_is_exact() -> None:
    packed = steps(np.full((3, 2), 0.1))
    assert packed["step"] == 0.0
    np.testing.assert_array_equal(counted(packed), np.full((3, 2), 0.1))
