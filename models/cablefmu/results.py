"""What a run leaves behind: a Dataset, a CSV file to the last bit, a NetCDF file."""

from __future__ import annotations

import csv
import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from . import __version__
from .errors import OptionError
from .files import replacing
from .fmu.variables import Variable
from .scene import Scene
from .statics_results import is_over_time, write_statics

__all__ = ["Recording", "dataset", "write_results"]


@dataclass(slots=True)
class Recording:
    """Rows of values as they come."""

    variables: list[Variable]
    times: list[float] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)

    def add(self, time: float, values: list[float]) -> None:
        self.times.append(time)
        self.rows.append(values)


def dataset(
    recording: Recording, scene: Scene, settings: Mapping[str, Any], statistics: Mapping[str, float]
) -> xr.Dataset:
    """The recorded values as an xarray Dataset over `time`.

    Variables such as theta[1] ... theta[n] that were recorded as a whole become one array over (time, link).
    """
    values = np.asarray(recording.rows, dtype=float).reshape(len(recording.times), len(recording.variables))
    result = xr.Dataset(coords={"time": ("time", recording.times, {"units": "s", "long_name": "Time"})})
    groups: dict[str, list[int]] = {}
    for column, variable in enumerate(recording.variables):
        groups.setdefault(variable.name.partition("[")[0], []).append(column)
    for name, columns in groups.items():
        first = recording.variables[columns[0]]
        if len(columns) == scene.cable.n and first.name.endswith("]"):
            attributes = {"units": first.unit, "long_name": first.description.replace("Link 1: ", "Every link: ", 1)}
            result[name] = (("time", "link"), values[:, columns], attributes)
            continue
        for column in columns:
            variable = recording.variables[column]
            result[variable.name] = (
                "time",
                values[:, column],
                {"units": variable.unit, "long_name": variable.description},
            )
    if "link" in result.dims:
        numbers = np.arange(1, scene.cable.n + 1)
        result = result.assign_coords(
            link=("link", numbers, {"long_name": "Link, 1 at the top"}),
            link_length=("link", scene.cable.links.length, {"units": "m", "long_name": "Length of the link"}),
        )
    result.attrs = _attributes(scene, settings, statistics)
    return result


def _attributes(scene: Scene, settings: Mapping[str, Any], statistics: Mapping[str, float]) -> dict[str, Any]:
    return {
        "title": scene.name,
        "summary": scene.description,
        "scene": scene.text,
        **settings,
        **{f"solver_{name}" if name != "run_time" else name: value for name, value in statistics.items()},
        "source": f"cablefmu {__version__}, fmpy {version('fmpy')}, Python {platform.python_version()}",
        "conventions": "SI units; x to the right, y down; angles from the downward vertical, positive towards +x",
    }


def write_results(result: xr.Dataset, path: Path) -> list[Path]:
    """Write a CSV (with its metadata in PATH.json) or, by the suffix .nc, a NetCDF file.

    Returns the files that hold numbers, `path` first.

    CSV: first column `time`, then the variables under their FMI names, every double to the last bit. What is not over
    time goes to NAME.modes.csv and NAME.stiffness.csv beside.

    Raises
    ------
    OptionError
        If the suffix is neither, or the file cannot be written.
    """
    if path.suffix == ".csv":
        with replacing(path) as temporary:
            _write_csv(result, temporary)
        with replacing(path.with_name(path.name + ".json")) as temporary:
            temporary.write_text(json.dumps(_metadata(result), indent=1) + "\n", encoding="utf-8")
        return [path, *write_statics(result, path)]
    if path.suffix == ".nc":
        with replacing(path) as temporary:
            result.to_netcdf(temporary, engine="scipy")
        return [path]
    raise OptionError(f"{path}: a name that ends with .csv or .nc is expected")


def _columns(result: xr.Dataset) -> dict[str, Any]:
    columns: dict[str, Any] = {"time": result["time"].values}
    for name, variable in result.data_vars.items():
        if not is_over_time(variable):
            continue
        if variable.ndim == 1:
            columns[str(name)] = variable.values
            continue
        for k, link in enumerate(result["link"].values):
            columns[f"{name}[{link}]"] = variable.values[:, k]
    return columns


def _write_csv(result: xr.Dataset, path: Path) -> None:
    columns = _columns(result)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(map(repr, row) for row in zip(*(column.tolist() for column in columns.values()), strict=True))


def _metadata(result: xr.Dataset) -> dict[str, Any]:
    described = {"time": result["time"].attrs} | {str(name): v.attrs for name, v in result.data_vars.items()}
    return {**result.attrs, "variables": described}
