"""The table of a sweep: one row a case, as a CSV to the last bit and as an xarray Dataset."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import xarray as xr

from ..errors import SweepError
from ..files import replacing
from .statistics import summary_of, write_summary
from .store import TABLES, read_manifest, read_rows

__all__ = ["open_table", "write_table"]

_TEXTS = {
    "case": "Number of the case, from 1",
    "scene": "What was run",
    "status": "ended; failed: see reason; lost: its process died of it",
    "ended_at": "Simulated time at which it ended",
    "reason": "Why it failed",
    "run_time": "Time that it took",
}
_UNITS = {"ended_at": "s", "run_time": "s"}
_WORDS = {
    "min": "Smallest over the output times",
    "max": "Largest over the output times",
    "final": "At the end",
    "equivalent": "Range of the 1 Hz sine that does the same damage (rainflow)",
}


def write_table(folder: Path) -> list[Path]:
    """Write cases.csv, cases.csv.json and summary.csv of what is finished; run times stand in the last column."""
    manifest, rows = _read(folder)
    table, about, summary = (folder / name for name in TABLES)
    columns = rows.drop_columns(["key"])
    with replacing(table) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns.column_names)
        for batch in columns.to_batches(max_chunksize=1000):
            writer.writerows(map(_fields, zip(*(column.to_pylist() for column in batch.columns), strict=True)))
    result = _dataset(manifest, rows)
    described = {str(name): variable.attrs for name, variable in result.variables.items()}
    with replacing(about) as temporary:
        text = json.dumps({**manifest, "variables": described}, indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    write_summary(summary_of(result), summary)
    return [table, summary]


def _fields(row: tuple[Any, ...]) -> list[str]:
    """Empty where there is nothing, every double to the last bit."""
    return ["" if value is None else value if isinstance(value, str) else repr(value) for value in row]


def open_table(folder: Path) -> xr.Dataset:
    """What `open_sweep` returns."""
    return _dataset(*_read(folder))


def _read(folder: Path) -> tuple[Mapping[str, Any], pa.Table]:
    manifest = read_manifest(folder)
    if manifest is None:
        raise SweepError(f"{folder}: holds no sweep; the folder that `cablefmu sweep` wrote is expected")
    rows = read_rows(folder)
    if rows is None:
        raise SweepError(f"{folder}: no case of this sweep is finished")
    return manifest, rows


def _dataset(manifest: Mapping[str, Any], rows: pa.Table) -> xr.Dataset:
    result = xr.Dataset(coords={"case": ("case", rows["case"].to_numpy(), {"long_name": _TEXTS["case"]})})
    figures = manifest["figures"]
    for name in rows.column_names:
        if name in ("case", "key"):
            continue
        column = rows[name]
        values = column.to_numpy() if pa.types.is_floating(column.type) else np.array(column.to_pylist(), dtype=object)
        attributes = {"units": figures.get(name, _UNITS.get(name, "")), "long_name": _said(name, figures)}
        result[name] = ("case", values, {key: text for key, text in attributes.items() if text})
    result.attrs = {
        "title": manifest["title"], "summary": manifest["description"], "cases": manifest["cases"],
        "varied": " ".join(manifest["values"]), "source": f"cablefmu {manifest['identity']['version of cablefmu']}",
        "slope": manifest["identity"]["[statistics]"]["slope"],
    }  # fmt: skip
    return result


def _said(name: str, figures: Mapping[str, str]) -> str:
    if name not in figures:
        return _TEXTS.get(name, "Set in this case")
    output, _, what = name.rpartition(".")
    return f"{output}: {_WORDS[what]}"
