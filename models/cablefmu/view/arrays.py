"""Arrays as text in a page: base64 of little-endian numbers, which a script reads as a typed array."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from ..cable import Floats

__all__ = ["doubles", "steps"]

_STEPS = 65535


def doubles(array: Floats) -> dict[str, Any]:
    """Every number to the bit, 8 bytes each: `data`."""
    return {"data": base64.b64encode(array.astype("<f8").tobytes()).decode("ascii")}


def steps(array: Floats) -> dict[str, Any]:
    """Whole steps above the least number, 2 bytes each: value = `low` + `step` * `data`.

    The step is (largest - least) / 65535, so that a number is at most half a step off: 2 mm for places within 240 m,
    less than a pixel until two metres fill the screen.
    """
    low, high = float(array.min()), float(array.max())
    step = (high - low) / _STEPS
    counted = np.rint((array - low) / step) if step > 0.0 else np.zeros_like(array)
    data = base64.b64encode(counted.astype("<u2").tobytes()).decode("ascii")
    return {"low": low, "step": step, "columns": array.shape[1], "data": data}
