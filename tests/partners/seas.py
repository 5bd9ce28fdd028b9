"""Seas to test with: built, unpacked, and driven through FMPy or as the Python class."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from fmpy import extract

from cablefmu import Waves, build_waves
from cablefmu.cable import Floats
from tests.fmu_helpers import Host

ALL = ["elevation", "velocity", "acceleration"]
AIRY = {"kind": "airy", "height": 2.4, "period": 7.0, "depth": 14.0, "phase": "40 deg"}
FENTON = {"kind": "fenton", "height": 5.0, "period": "9 s", "depth": 25.0}
JONSWAP = {"kind": "jonswap", "significant_height": 3.0, "peak_period": 9.0, "depth": 60.0, "seed": 7}
SHORT = JONSWAP | {"duration": 200.0}
"""Some 120 waves."""

SCRIPT = Path(__file__).parents[2] / "fmu_src" / "partners" / "waves.py"

Build = Callable[..., Path]


def builder(folder: Path) -> Build:
    """made(name=..., **table): folder of that sea's FMU, below `folder`."""

    def made(name: str = "sea", **table: object) -> Path:
        target = folder / f"{name}-{len(list(folder.iterdir()))}"
        extract(str(build_waves(Waves.from_table(table, name=name), target.with_suffix(".fmu"))), unzipdir=str(target))
        return target

    return made


@cache
def slave() -> ModuleType:
    """The script itself, as a module of its own."""
    spec = importlib.util.spec_from_file_location("waves_as_a_class", SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def values(folder: Path, names: Sequence[str], times: Floats, **parameters: float) -> Floats:
    """Outputs of one instance at rising times, through FMPy; shape (times, names)."""
    with Host(folder) as host:
        host.set_all(parameters)
        host.enter_initialization(float(times[0]))
        host.fmu.exitInitializationMode()
        rows = [host.get(*names)]
        for before, after in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
            host.step(before, after - before)
            rows.append(host.get(*names))
    return np.array(rows)


def made_by_the_class(folder: Path, names: Sequence[str], times: Floats) -> Floats:
    """The same of the Python class, without FMI."""
    sea: Any = slave().Waves(instance_name="x", resources=str(folder / "resources"))
    rows = []
    for time in times.tolist():
        sea.setup_experiment(time, None, None)
        rows.append([sea.get(name) for name in names])
    return np.array(rows)
