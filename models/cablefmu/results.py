"""What a run leaves behind: a Dataset, a CSV file to the last bit, a NetCDF file."""

from __future__ import annotations

import csv
import json
import platform
from collections.abc import Hashable, Iterable, Mapping
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

__all__ = ["ORDER", "Recording", "columns_of", "dataset", "write_results"]


@dataclass(slots=True)
class Recording:
    """Rows of values as they come."""

    variables: list[Variable]
    times: list[float] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)

    def add(self, time: float, values: list[float]) -> None:
        self.times.append(time)
        self.rows.append(values)

    def first(self, count: int) -> Recording:
        """The same with so many of its variables."""
        return Recording(self.variables[:count], self.times, [row[:count] for row in self.rows])


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
        "frame_interval": scene.frame_interval,
        **settings,
        **{f"solver_{name}" if name != "run_time" else name: value for name, value in statistics.items()},
        "source": f"cablefmu {__version__}, fmpy {version('fmpy')}, Python {platform.python_version()}",
        "conventions": "SI units; x to the right, y down; angles from the downward vertical, positive towards +x",
    }


def write_results(result: xr.Dataset, path: Path) -> list[Path]:
    """Write a CSV (with its metadata in PATH.json) or, by the suffix .nc, a NetCDF file.

    Returns the files that hold numbers, `path` first.

    CSV: first column `time`, then the variables under their FMI names, every double to the last bit. What is not over
    time goes to NAME.modes.csv and NAME.stiffness.csv beside. NetCDF: the classic format with 64-bit offsets, which
    every reader knows; arrays stay arrays. `open_result` reads either back.

    Raises
    ------
    OptionError
        If the suffix is neither, or the file cannot be written.
    """
    if path.suffix == ".csv":
        with replacing(path) as temporary:
            _write_csv(result, temporary)
        with replacing(path.with_name(path.name + ".json")) as temporary:
            temporary.write_text(json.dumps(_metadata(_plain(result)), indent=1) + "\n", encoding="utf-8")
        return [path, *write_statics(result, path)]
    if path.suffix == ".nc":
        with replacing(path) as temporary:
            order = {ORDER: json.dumps(list(result.variables))}
            encoding = dict.fromkeys(_numbers(result), _AS_IT_IS)
            _plain(result).assign_attrs(order).to_netcdf(temporary, engine="scipy", encoding=encoding)
        return [path]
    raise OptionError(f"{path}: a name that ends with .csv or .nc is expected")


ORDER = "variable_order"
"""Attribute of a NetCDF file, as JSON: the format is free to keep variables in an order of its own."""

_AS_IT_IS = {"_FillValue": None}
"""No number stands for a missing one: there is none."""


def _numbers(result: xr.Dataset) -> list[Hashable]:
    return [name for name, variable in result.variables.items() if variable.dtype.kind == "f"]


def _plain(result: xr.Dataset) -> xr.Dataset:
    """Without the attributes that say nothing: the classic format has no empty texts."""
    plain = result.copy()
    plain.attrs = {key: value for key, value in result.attrs.items() if value != ""}
    for name, variable in plain.variables.items():
        plain[name].attrs = {key: value for key, value in variable.attrs.items() if value != ""}
    return plain


def columns_of(name: str, labels: Iterable[object]) -> list[str]:
    """Names of the columns of an array over time: theta[1], theta[2], ..."""
    return [f"{name}[{label}]" for label in labels]


def _columns(result: xr.Dataset) -> dict[str, Any]:
    columns: dict[str, Any] = {"time": result["time"].values}
    for name, variable in result.data_vars.items():
        if not is_over_time(variable):
            continue
        if variable.ndim == 1:
            columns[str(name)] = variable.values
            continue
        columns |= zip(columns_of(str(name), result[variable.dims[1]].values), variable.values.T, strict=True)
    return columns


def _write_csv(result: xr.Dataset, path: Path) -> None:
    columns = _columns(result)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(map(repr, row) for row in zip(*(column.tolist() for column in columns.values()), strict=True))


def _metadata(result: xr.Dataset) -> dict[str, Any]:
    """All that the numbers over time do not say; with them it is the whole result again."""
    described = {"time": result["time"].attrs} | {str(name): v.attrs for name, v in result.data_vars.items()}
    coordinates = {
        str(name): {"dimensions": list(v.dims), "values": v.values.tolist(), "attributes": v.attrs}
        for name, v in result.coords.items()
        if name != "time"
    }
    dimensions = {str(name): list(v.dims) for name, v in result.data_vars.items()}
    return {**result.attrs, "variables": described, "dimensions": dimensions, "coordinates": coordinates}
