"""Vessels to test with: built, unpacked, and driven through FMPy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import extract
from fmpy.fmi1 import FMICallException

from cablefmu import Vessel, build_vessel
from cablefmu.cable import Floats
from tests.fmu_helpers import Host

OUTPUTS = ("x", "y", "vx", "vy", "ax", "ay")

BODY = {"kind": "body", "m_x": 2.0e5, "m_y": 3.0e5, "k_x": 1.0e4, "c_x": 1.2e4, "k_y": 8.0e5, "c_y": 9.0e4}

SINES = {
    "kind": "sines",
    "x": {"amplitude": "1.5 m", "period": 8.0, "phase": "30 deg"},
    "y": [{"amplitude": 0.8, "frequency": 0.21}, {"amplitude": -0.3, "frequency": 0.5, "phase": 1.0}],
    "ramp": 5.0,
}

Build = Callable[..., Path]


def builder(folder: Path) -> Build:
    """made(name=..., **table): folder of that vessel's FMU, below `folder`."""

    def made(name: str = "vessel", **table: object) -> Path:
        target = folder / f"{name}-{len(list(folder.iterdir()))}"
        vessel = Vessel.from_table(table, name=name, folder=folder)
        extract(str(build_vessel(vessel, target.with_suffix(".fmu"))), unzipdir=str(target))
        return target

    return made


def run(host: Host, times: Floats, forces: Callable[[float], Mapping[str, float]] | None = None) -> Floats:
    """The outputs at `times`, one row each; inputs are set at the beginning of every step."""
    rows = []
    for time, after in pairwise([*times, None]):
        host.set_all(forces(time) if forces else {})
        rows.append(host.get(*OUTPUTS))
        if after is not None:
            host.step(time, after - time)
    return np.array(rows)


def write_csv(path: Path, times: Floats, x: Floats, y: Floats) -> str:
    lines = [
        "time,x,y",
        *(f"{t!r},{a!r},{b!r}" for t, a, b in zip(*map(np.ndarray.tolist, (times, x, y)), strict=True)),
    ]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def refused(host: Host, says: str, call: Callable[..., Any], *arguments: Any, **named: Any) -> None:
    """The call ends with fmi2Fatal, which is all that pythonfmu has for it, and one message."""
    before = len(host.messages)
    with pytest.raises(FMICallException) as mistake:
        call(*arguments, **named)
    assert mistake.value.status == 4
    assert len(host.messages) == before + 1 and says in host.messages[-1], host.messages
