"""What a coupled run leaves behind: outputs of all models and the power through the connections, over time."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np
import xarray as xr

from .. import __version__
from .connections import Variable
from .exchange import Outputs
from .power import Bond
from .system import System

__all__ = ["Recording", "make_dataset"]


@dataclass(slots=True)
class Recording:
    """Rows as they come."""

    system: System
    times: list[float] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)

    @property
    def variables(self) -> list[Variable]:
        return [
            Variable(name, output) for name, model in self.system.models.items() for output in model.names("output")
        ]

    @property
    def bonds(self) -> Sequence[Bond]:
        return self.system.bonds

    def add(self, time: float, outputs: Outputs, inputs: Mapping[Variable, float]) -> None:
        """Values at a communication point; `inputs` as they were just before it."""
        powers = [bond.powers(outputs, inputs) for bond in self.bonds]
        self.times.append(time)
        self.rows.append(
            [*(outputs[v] for v in self.variables), *(p for pair in powers for p in (pair[0], pair[0] - pair[1]))]
        )


def make_dataset(recording: Recording, statistics: Mapping[str, float]) -> xr.Dataset:
    """The recorded values over `time`: MODEL.OUTPUT, power.NAME and power.NAME.residual."""
    system, settings = recording.system, recording.system.settings
    result = xr.Dataset(coords={"time": ("time", recording.times, {"units": "s", "long_name": "Time"})})
    described: list[tuple[str, str, str]] = []
    for variable in recording.variables:
        model = system.models[variable.model]
        unit = model.unit(variable.name)
        text = model.variables[variable.name].description or ""
        described.append((str(variable), unit.name if unit else "", text))
    for bond in recording.bonds:
        described.append((f"power.{bond.name}", "W", f"{bond.flow.source} times the effort that its model is given"))
        described.append(
            (f"power.{bond.name}.residual", "W", "Power in minus power out of the connections, at the end of a step")
        )
    values = np.asarray(recording.rows, dtype=float).reshape(len(recording.times), len(described))
    for column, (name, units, text) in enumerate(described):
        result[name] = ("time", values[:, column], {"units": units, "long_name": text})
    result.attrs = {
        "title": system.coupling.name,
        "summary": settings.description,
        "coupling": system.coupling.text,
        "engine": "own",
        "algorithm": settings.algorithm,
        "extrapolation": settings.extrapolation,
        "step": settings.step,
        "stop_time": settings.stop_time,
        "tolerance": settings.tolerance,
        "notes": "; ".join(system.notes),
        **statistics,
        **source(),
    }
    return result


def source() -> dict[str, Any]:
    """What made the results."""
    made = f"cablefmu {__version__}, fmpy {version('fmpy')}, Python {platform.python_version()}"
    return {"source": made, "conventions": "units as in the FMUs; cables: x to the right, y down"}
