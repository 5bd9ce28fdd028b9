"""A store that no interruption spoils, and that keeps numbers to the bit."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cablefmu.errors import SweepError
from cablefmu.sweeping.store import Row, Series, Store, read_rows, remove

IDENTITY = {"version of cablefmu": "1", "stop time of load": 5.0}


def store(folder: Path, **identity: Any) -> Store:
    about = {"figures": {"t.max": "N"}, "title": "s"}
    return Store(folder, IDENTITY | identity, values=["M_1", "solver"], words=["solver"], about=about)


def row(case: int, value: float = 1.0, status: str = "ended") -> Row:
    figures = {"t.max": value} if status == "ended" else {}
    return Row(case, f"key{case}", "load", {"M_1": 0.1 * case}, status, 5.0, "", figures, 0.01)


NUMBERS = [0.1, -0.0, 5e-324, 1.7976931348623157e308, 1.0 + 2.0**-52, -1e-300]


def test_numbers_come_back_to_the_bit_in_the_order_of_the_cases(tmp_path: Path) -> None:
    made = store(tmp_path / "new" / "s")
    made.add([row(k, NUMBERS[k - 1]) for k in (4, 5, 6)])
    made.add([row(k, NUMBERS[k - 1]) for k in (1, 2, 3)])
    made.add([row(7, status="failed")])
    rows = read_rows(tmp_path / "new" / "s")
    assert rows is not None
    assert rows["case"].to_pylist() == [1, 2, 3, 4, 5, 6, 7]
    kept = rows["t.max"].to_pylist()
    assert [struct.pack("d", v) for v in kept[:6]] == [struct.pack("d", v) for v in NUMBERS]
    assert kept[6] is None
    assert rows["solver"].to_pylist() == [None] * 7
    assert made.finished() == {k: f"key{k}" for k in range(1, 8)}
    assert made.failed() == 1
    made.close()


@pytest.mark.parametrize("share", [0.0, 0.5, 0.999])
def test_a_torn_file_counts_as_not_there(share: float, tmp_path: Path) -> None:
    made = store(tmp_path)
    made.add([row(1), row(2)])
    made.add([row(3), row(4)])
    torn = tmp_path / "parts" / "0000003.parquet"
    whole = torn.read_bytes()
    torn.write_bytes(whole[: int(share * len(whole))])
    assert made.finished() == {1: "key1", 2: "key2"}
    made.add([row(2), row(3), row(4)])  # in other batches than before
    rows = read_rows(tmp_path)
    assert rows is not None
    assert rows["case"].to_pylist() == [1, 2, 3, 4]
    made.close()


def test_what_was_being_written_when_the_process_died_is_taken_away(tmp_path: Path) -> None:
    made = store(tmp_path)
    made.add([row(1)])
    made.close()
    (tmp_path / "parts" / ".cablefmu-abc").write_bytes(b"PAR1")
    store(tmp_path).close()
    assert [path.name for path in (tmp_path / "parts").iterdir()] == ["0000001.parquet"]


def test_series_are_kept_before_their_rows(tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    made = store(tmp_path)
    made.add([row(1), row(2)], [Series(k, np.array([0.0, 0.1]), {"t": np.array([k, 2.0 * k])}) for k in (1, 2)])
    made.close()
    series = pq.read_table(tmp_path / "series" / "0000001.parquet").to_pydict()
    assert series == {"case": [1, 1, 2, 2], "time": [0.0, 0.1, 0.0, 0.1], "t": [1.0, 2.0, 2.0, 4.0]}


def test_another_sweep_s_store_is_refused(tmp_path: Path) -> None:
    store(tmp_path).close()
    with pytest.raises(SweepError, match=r"another sweep, whose stop time of load is 5\.0 where 6\.0 is asked for"):
        store(tmp_path, **{"stop time of load": 6.0})
    store(tmp_path).close()
    remove(tmp_path)
    store(tmp_path, **{"stop time of load": 6.0}).close()


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.doc").write_text("mine")
    with pytest.raises(SweepError, match=r"holds thesis\.doc and no sweep; an empty folder or a new name is expected"):
        store(tmp_path)
    remove(tmp_path)
    assert (tmp_path / "thesis.doc").read_text() == "mine"


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"format": 99}', "\0"])
def test_a_manifest_that_is_none_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "sweep.json").write_text(text)
    with pytest.raises(SweepError, match=r"sweep\.json: (cannot be read|is of format 99)"):
        store(tmp_path)


def test_two_at_a_time_are_kept_apart(tmp_path: Path) -> None:
    made = store(tmp_path)
    with pytest.raises(SweepError, match="another process runs a sweep in it"):
        store(tmp_path)
    made.close()
    store(tmp_path).close()
