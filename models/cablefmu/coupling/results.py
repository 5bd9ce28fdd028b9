"""What a coupled run leaves behind: outputs of all models and the power through the connections, over time."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
import xarray as xr

from .. import __version__
from .connections import Variable
from .exchange import Outputs
from .system import System

__all__ = ["Recording", "make_dataset", "recorded"]


def recorded(system: System) -> list[Variable]:
    """All real outputs, model by model."""
    return [Variable(name, output) for name, model in system.models.items() for output in model.names("output")]


class Recording:
    """Rows as they come: outputs, and of every [[power]] the power and its residual."""

    def __init__(self, system: System) -> None:
        self.times: list[float] = []
        self.rows: list[list[float]] = []
        self._variables, self._bonds = recorded(system), system.bonds

    def add(self, time: float, outputs: Outputs, inputs: Mapping[Variable, float]) -> None:
        """Values at a communication point; `inputs` as they were just before it."""
        row = [outputs[variable] for variable in self._variables]
        for bond in self._bonds:
            given, taken = bond.powers(outputs, inputs)
            row += [given, given - taken]
        self.times.append(time)
        self.rows.append(row)


@dataclass(frozen=True, slots=True)
class _Column:
    name: str
    units: str
    text: str


def make_dataset(
    system: System, times: Sequence[float], rows: Sequence[Sequence[float]], engine: str,
    statistics: Mapping[str, object], *, powers: bool,
) -> xr.Dataset:  # fmt: skip
    """The recorded values over `time`: MODEL.OUTPUT and, with `powers`, power.NAME and power.NAME.residual."""
    settings = system.settings
    columns = [*_outputs(system), *(_powers(system) if powers else [])]
    values = np.asarray(rows, dtype=float).reshape(len(times), len(columns))
    result = xr.Dataset(coords={"time": ("time", list(times), {"units": "s", "long_name": "Time"})})
    for k, column in enumerate(columns):
        result[column.name] = ("time", values[:, k], {"units": column.units, "long_name": column.text})
    result.attrs = {
        "title": system.coupling.name,
        "summary": settings.description,
        "coupling": system.coupling.text,
        "engine": engine,
        "algorithm": settings.algorithm,
        "extrapolation": settings.extrapolation,
        "step": settings.step,
        "stop_time": settings.stop_time,
        **statistics,
        "source": f"cablefmu {__version__}, fmpy {version('fmpy')}, Python {platform.python_version()}",
        "conventions": "units as in the FMUs; cables: x to the right, y down",
    }
    return result


def _outputs(system: System) -> list[_Column]:
    columns = []
    for variable in recorded(system):
        model = system.models[variable.model]
        unit = model.unit(variable.name)
        text = model.variables[variable.name].description or ""
        columns.append(_Column(str(variable), unit.name if unit else "", text))
    return columns


def _powers(system: System) -> list[_Column]:
    columns = []
    for bond in system.bonds:
        columns.append(
            _Column(f"power.{bond.name}", "W", f"{bond.flow.source} times the effort that its model is given")
        )
        text = "Power in minus power out of the connections, at the end of a step"
        columns.append(_Column(f"power.{bond.name}.residual", "W", text))
    return columns
