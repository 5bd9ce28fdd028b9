"""A folder with what is finished of a sweep, which no interruption can spoil.

    sweep.json        which sweep it is: what decides on its results, and what a person needs to know of it
    parts/*.parquet   rows of finished cases, each file complete before it has its name
    series/*.parquet  with --keep-series their outputs over time, written before the rows

A file that is damaged nevertheless is taken for one that is not there: its cases are run again.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from ..cable import Floats
from ..errors import SweepError
from ..files import check_writable, replacing

try:
    import fcntl
except ImportError:  # Windows, where nobody keeps two sweeps out of one folder
    fcntl = None  # type: ignore[assignment]

__all__ = ["TABLES", "Row", "Series", "Store", "read_manifest", "read_rows", "remove"]

_MANIFEST = "sweep.json"
_LOCK = ".lock"
_FORMAT = 1
TABLES = ("cases.csv", "cases.csv.json", "summary.csv")
"""What is made of the parts in the end"""
_FIXED = {
    "case": pa.int64(), "key": pa.string(), "scene": pa.string(), "status": pa.string(), "ended_at": pa.float64(),
    "reason": pa.string(), "run_time": pa.float64(),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Row:
    """One finished case."""

    case: int
    key: str
    scene: str
    given: Mapping[str, float | str]
    """What varies"""
    status: str
    """ended, failed or lost (its worker died of it)"""
    ended_at: float
    """Simulated time [s]"""
    reason: str
    figures: Mapping[str, float]
    run_time: float
    """[s]"""


@dataclass(frozen=True, slots=True)
class Series:
    """Outputs of one case over time."""

    case: int
    times: Floats
    """[s]"""
    values: Mapping[str, Floats]


class Store:
    """The folder, opened for one sweep.

    Parameters
    ----------
    folder
        Made if there is none.
    identity
        What decides on results, by what a person calls it.
    values
        Names of what varies; words are those of them that are texts.
    about
        What else the manifest says, for who reads the table; "figures" are what is measured, with units.

    Raises
    ------
    SweepError
        If the folder holds another sweep or something else, or another process runs a sweep in it.
    OptionError
        If it cannot be written to.
    """

    def __init__(
        self, folder: Path, identity: Mapping[str, Any], *, values: Sequence[str], words: Sequence[str] = (),
        about: Mapping[str, Any],
    ) -> None:  # fmt: skip
        self.folder = folder
        check_writable(folder / _MANIFEST)
        self._lock = _locked(folder)
        try:
            self._claim({"format": _FORMAT, "identity": dict(identity), **about})
        except BaseException:
            self.close()
            raise
        kinds = {name: pa.string() if name in words else pa.float64() for name in values}
        *head, last = _FIXED.items()
        self._schema = pa.schema([*head, *kinds.items(), *((name, pa.float64()) for name in about["figures"]), last])

    def _claim(self, manifest: Mapping[str, Any]) -> None:
        """Make it this sweep's, or find that it is."""
        known = read_manifest(self.folder)
        if known is not None:
            _compare(self.folder, known, manifest)
        else:
            others = sorted(entry.name for entry in self.folder.iterdir() if not entry.name.startswith("."))
            if others:
                text = f"holds {others[0]} and no sweep; an empty folder or a new name is expected"
                raise SweepError(f"{self.folder}: {text}")
            with replacing(self.folder / _MANIFEST) as temporary:
                temporary.write_text(json.dumps(manifest, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        for name in ("parts", "series"):
            for torn in (self.folder / name).glob(".cablefmu-*"):
                torn.unlink()

    def add(self, rows: Sequence[Row], series: Sequence[Series] = ()) -> None:
        """Keep finished cases; when this returns they are on the disk."""
        name = f"{rows[0].case:07}.parquet"
        if series:
            tables = [pa.table({"case": [s.case] * len(s.times), "time": s.times, **s.values}) for s in series]
            _write(self.folder / "series" / name, pa.concat_tables(tables, promote_options="default"))
        dicts = [
            {
                "case": row.case, "key": row.key, "scene": row.scene, "status": row.status, "ended_at": row.ended_at,
                "reason": row.reason, "run_time": row.run_time, **row.given, **row.figures,
            }
            for row in rows
        ]  # fmt: skip
        _write(self.folder / "parts" / name, pa.Table.from_pylist(dicts, schema=self._schema))

    def close(self) -> None:
        """Let others have the folder."""
        self._lock.close()

    def failed(self) -> int:
        """How many of those in it did not reach their end."""
        parts = _readable(self.folder / "parts", ["status"])
        return sum(status != "ended" for part in parts for status in part["status"].to_pylist())

    def finished(self) -> dict[int, str]:
        """Keys of the cases that are in it, by number."""
        found: dict[int, str] = {}
        for part in _readable(self.folder / "parts", ["case", "key"]):
            found |= dict(zip(part["case"].to_pylist(), part["key"].to_pylist(), strict=True))
        return found


def read_manifest(folder: Path) -> dict[str, Any] | None:
    """What the folder says of itself; None if there is nothing.

    Raises
    ------
    SweepError
        If that cannot be read.
    """
    path = folder / _MANIFEST
    if not path.exists():
        return None
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
        known = manifest["format"]
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise SweepError(f"{path}: cannot be read ({type(error).__name__}: {error})") from None
    if known != _FORMAT:
        raise SweepError(f"{path}: is of format {known}; this version reads {_FORMAT}")
    return dict(manifest)


def read_rows(folder: Path) -> pa.Table | None:
    """All finished cases in the order of their numbers, each once; None if there is none yet."""
    parts = list(_readable(folder / "parts", None))
    if not parts:
        return None
    rows = pa.concat_tables(parts)
    # A damaged part's cases were run again, in other batches perhaps.
    _, first = np.unique(rows["case"].to_numpy(), return_index=True)
    return rows.take(first)


def remove(folder: Path) -> None:
    """Take a sweep out of its folder, whichever it was, and nothing else."""
    if (folder / _MANIFEST).is_file():
        lock = _locked(folder)
        for name in ("parts", "series"):
            shutil.rmtree(folder / name, ignore_errors=True)
        for path in (*TABLES, _MANIFEST):
            (folder / path).unlink(missing_ok=True)
        lock.close()


def _locked(folder: Path) -> IO[bytes]:
    """A file that the system holds for this process alone, and lets go however that ends."""
    lock = (folder / _LOCK).open("wb")
    if fcntl is not None:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            raise SweepError(f"{folder}: another process runs a sweep in it; another folder is expected") from None
    return lock


def _compare(folder: Path, known: Mapping[str, Any], asked: Mapping[str, Any]) -> None:
    """What is another than in the store, in words."""
    for key, value in asked["identity"].items():
        held = known["identity"].get(key)
        if held != value:
            raise SweepError(
                f"{folder}: holds another sweep, whose {key} is {_said(held)} where {_said(value)} is asked for; "
                "--output names another folder, --restart begins anew"
            )


def _said(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:56] + " ..."


def _readable(folder: Path, columns: list[str] | None) -> Iterator[pa.Table]:
    """Every file that is whole; one that is damaged counts as not there."""
    for path in sorted(folder.glob("*.parquet")):
        try:
            yield pq.read_table(path, columns=columns)
        except (pa.ArrowException, OSError):
            continue


def _write(path: Path, table: pa.Table) -> None:
    """The whole file or none, on the disk before it has its name."""
    with replacing(path) as temporary, temporary.open("wb") as file:
        pq.write_table(table, file)
        file.flush()
        os.fsync(file.fileno())
