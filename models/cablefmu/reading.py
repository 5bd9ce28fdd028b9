"""Results back from disk: a CSV file with its metadata, or a NetCDF file, as the Dataset that the run gave."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .cable import Floats
from .errors import ResultError
from .results import ORDER, columns_of
from .statics_results import read_statics

__all__ = ["open_result"]

_KEYS = ("variables", "dimensions", "coordinates")
_OURS = "a file from `cablefmu run` or `cablefmu couple` is expected"


def open_result(path: str | Path) -> xr.Dataset:
    """Read what a run left behind: the same Dataset from either kind of file, to the last bit.

    Parameters
    ----------
    path
        FILE.csv, with FILE.csv.json beside it, or FILE.nc.

    Returns
    -------
    xarray.Dataset
        Over `time` [s], as `simulate` returns it, in memory. Of a run that ended early `attrs["ended_early"]` says why.

    Raises
    ------
    ResultError
        If the file is missing, is something else, or is damaged.
    """
    path = Path(path)
    if path.suffix not in (".csv", ".nc"):
        raise ResultError(f"{path}: a name that ends with .csv or .nc is expected")
    if not path.is_file():
        raise ResultError(f"{path}: there is no such file")
    try:
        return _from_csv(path) if path.suffix == ".csv" else _from_netcdf(path)
    except OSError as error:
        raise ResultError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise ResultError(f"{path}: is damaged, or was changed by hand ({error}); {_OURS}") from None


# --- CSV ---


def _from_csv(path: Path) -> xr.Dataset:
    told = _metadata(path.with_name(path.name + ".json"), path)
    over_time = {name: dimensions for name, dimensions in told["dimensions"].items() if "time" in dimensions}
    columns: dict[str, list[str]] = {"time": ["time"]}
    for name, dimensions in over_time.items():
        columns[name] = [name] if len(dimensions) == 1 else columns_of(name, _coordinate(told, dimensions[1]))
    rows = _table(path, [column for names in columns.values() for column in names])
    values, before = read_statics(path), 0
    for name, names in columns.items():
        part = rows[:, before : before + len(names)]
        values[name] = part[:, 0] if len(told["dimensions"].get(name, ["time"])) == 1 else part
        before += len(names)
    result = xr.Dataset(attrs={key: value for key, value in told.items() if key not in _KEYS})
    result = result.assign_coords(time=("time", values.pop("time"), told["variables"]["time"]))
    for name, of in told["coordinates"].items():
        result = result.assign_coords({name: (of["dimensions"], np.array(of["values"]), of["attributes"])})
    for name, dimensions in told["dimensions"].items():
        if name not in values:
            raise ResultError(f"{path}: {name} is missing; it was written to a file of its own beside this one")
        result[name] = (dimensions, values[name], told["variables"][name])
    return result


def _metadata(path: Path, results: Path) -> dict[str, Any]:
    if not path.is_file():
        raise ResultError(
            f"{results}: {path.name}, which belongs to it and tells what it is, is not beside it; {_OURS}"
        )
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        told = None
    if not (isinstance(told, dict) and all(isinstance(told.get(key), dict) for key in _KEYS)):
        raise ResultError(f"{path}: is not the description of a run's results; {_OURS}")
    return told


def _coordinate(told: dict[str, Any], name: str) -> list[Any]:
    values: list[Any] = told["coordinates"][name]["values"]
    return values


def _table(path: Path, columns: list[str]) -> Floats:
    """All rows; the file must have these columns and no others."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        if head != columns:
            raise ResultError(f"{path}: its columns are not those that {path.name}.json tells of; {_OURS}")
        return np.array([list(map(float, row)) for row in rows], dtype=np.float64).reshape(len(rows), len(columns))
    except ValueError:
        raise ResultError(f"{path}: is damaged or was cut off: a table of numbers is expected") from None


# --- NetCDF ---


def _from_netcdf(path: Path) -> xr.Dataset:
    try:
        with xr.open_dataset(path, engine="scipy", decode_times=False) as file:
            result = file.load()
    except (TypeError, ValueError, KeyError, IndexError):
        raise ResultError(f"{path}: is not a NetCDF file of the classic format, or is damaged; {_OURS}") from None
    if "time" not in result.coords or not str(result.attrs.get("source", "")).startswith("cablefmu"):
        raise ResultError(f"{path}: holds no results of a run; {_OURS}")
    return _as_it_was(result)


def _as_it_was(result: xr.Dataset) -> xr.Dataset:
    """With the types that the format does not have: Python's numbers, texts, integers of 64 bits."""
    for name in list(result.coords):
        values = result[name].values
        if values.dtype.kind != "f":
            wide = values.astype(np.int64) if values.dtype.kind == "i" else values.astype(str)
            result = result.assign_coords({name: (result[name].dims, wide, result[name].attrs)})
    in_order = {name: result.variables[name] for name in json.loads(result.attrs.pop(ORDER))}
    coordinates = {name: variable for name, variable in in_order.items() if name in result.coords}
    numbers = {name: variable for name, variable in in_order.items() if name not in coordinates}
    result = xr.Dataset(numbers, coordinates, result.attrs)
    result.attrs = _plain(result.attrs)
    for name in result.variables:
        result[name].attrs = _plain(result[name].attrs)
    return result.drop_encoding()


def _plain(attributes: dict[Any, Any]) -> dict[Any, Any]:
    return {key: value.item() if isinstance(value, np.generic) else value for key, value in attributes.items()}
