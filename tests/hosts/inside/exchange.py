"""What the scripts of this folder are asked and answer; the standard library alone, for it runs beside every host.

`python NAME.py REQUEST ANSWER`: both are JSON files. A request has `fmu` (path), `fmi` (2 or 3), `interface`, `stop`
and `step` [s], `tolerance` of adaptive solvers, `outputs` (names) and `forces`: name -> {"times", "values"} of the
inputs that vary. Those of constant signals have their value as `start` in the FMU, and are left alone.
"""

from __future__ import annotations

import json
import sys
from bisect import bisect_right
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

Request = dict[str, Any]


def force(table: dict[str, list[float]], time: float) -> float:
    """Between two times of the table the force is linear."""
    times, values = table["times"], table["values"]
    right = min(max(bisect_right(times, time), 1), len(times) - 1)
    part = (time - times[right - 1]) / (times[right] - times[right - 1])
    return float(values[right - 1] + part * (values[right] - values[right - 1]))


def held(request: Request, index: int) -> dict[str, float]:
    """For hosts that hold forces over a step: those in the middle of step `index`, an error of second order."""
    return {name: force(table, (index + 0.5) * request["step"]) for name, table in request["forces"].items()}


def steps(request: Request) -> int:
    """Communication steps from 0 to the stop time."""
    return round(request["stop"] / request["step"])


def answer(package: str, run: Callable[[Request], dict[str, Any]]) -> None:
    """Let `run` do what is asked; whatever a host raises is its refusal."""
    asked, told = map(Path, sys.argv[1:])
    said: dict[str, Any] = {"version": version(package)}
    try:
        said |= run(json.loads(asked.read_text("utf-8")))
    except Exception as error:  # hosts raise what they like
        said["refused"] = f"{type(error).__name__}: {error}"
    told.write_text(json.dumps(said), "utf-8")
