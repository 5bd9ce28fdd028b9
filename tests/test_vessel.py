"""Vessels as tables: units, kinds, files, and all mistakes at once."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from cablefmu import Vessel, VesselError
from cablefmu.errors import UserError
from cablefmu.vessel import BodyTable, CsvTable, SinesTable

BODY = {"kind": "body", "m_x": 2e5, "m_y": 3e5}
SINE = {"amplitude": 1.0, "period": 8.0}


def test_a_body_in_units() -> None:
    table = tomllib.loads("""
        kind = "body"
        m_x = "200 t"
        m_y = 3.0e5
        k_y = "1.2 MN/m"
        c_y = "30 kN s/m"
        static_load_y = "40 kN"
        y_0 = "-25 cm"
        vx_0 = "3.6 km/h"
        extrapolation = "given"
    """)
    made = Vessel.from_table(table, name="ship")
    assert made.name == "ship" and not made.samples
    assert made.table == BodyTable(
        kind="body", m_x=2e5, m_y=3e5, k_y=1.2e6, c_y=3e4, static_load_y=4e4, y_0=-0.25, vx_0=1.0, extrapolation="given"
    )


def test_what_a_body_does_not_say_is_nothing() -> None:
    table = Vessel.from_table(BODY).table
    assert isinstance(table, BodyTable)
    given = {"kind": "body", "m_x": 2e5, "m_y": 3e5}
    assert {name: value for name, value in table.model_dump().items() if value} == given


def test_sines_one_or_several_by_period_or_frequency() -> None:
    table = Vessel.from_table({"kind": "sines", "x": SINE, "y": [{"amplitude": "5 dm", "frequency": 0.2}, SINE]}).table
    assert isinstance(table, SinesTable)
    assert [sine.hertz for sine in table.x or ()] == [0.125]
    assert [(sine.amplitude, sine.hertz) for sine in table.y or ()] == [(0.5, 0.2), (1.0, 0.125)]
    assert table.ramp == 0.0


def test_samples_are_found_beside_the_table_by_the_names_of_their_columns(tmp_path: Path) -> None:
    (tmp_path / "ship.csv").write_text("y,time,roll,x\n0,0,9,1\n0.1,1,9,1.5\n0.2,2.5,9,1\n0.3,3,9,-1\n")
    made = Vessel.from_table({"kind": "csv", "file": "ship.csv"}, folder=tmp_path)
    assert isinstance(made.table, CsvTable)
    assert made.samples == {"time": (0, 1, 2.5, 3), "x": (1, 1.5, 1, -1), "y": (0, 0.1, 0.2, 0.3)}


ALLOWED = "allowed: body, sines, csv, floating, excitation"

MISTAKES: dict[str, tuple[object, list[str]]] = {
    "no table": ([1], ["ship.toml: vessel: a table is expected"]),
    "no kind": ({"m_x": 1.0}, [f"ship.toml: vessel.kind: this key is missing; {ALLOWED}"]),
    "other kind": ({"kind": "sine"}, [f'ship.toml: vessel.kind = "sine": the nearest is "sines"; {ALLOWED}']),
    "kind is no text": ({"kind": 3}, [f"ship.toml: vessel.kind = 3: {ALLOWED}"]),
    "body": (
        {"kind": "body", "m_x": -1, "k_y": "3 m", "c_x": True, "extrapolation": 3, "mass": 5},
        [
            "ship.toml: vessel.c_x = true: a damping [N s/m] is expected",
            'ship.toml: vessel.k_y = "3 m": a stiffness [N/m] is expected',
            'ship.toml: vessel.extrapolation = 3: allowed: 0 (held), 1 (linear), 2 (quadratic), or "given"',
            "ship.toml: vessel.m_x = -1: a mass must be greater than 0",
            "ship.toml: vessel.m_y: this key is missing; a mass [kg] is expected",
            "ship.toml: vessel.mass = 5: unknown key; ",
        ],
    ),
    "extrapolation is no truth": (
        BODY | {"extrapolation": True}, ["ship.toml: vessel.extrapolation = true: allowed: 0 (held), 1 (linear)"]
    ),
    "no sine": ({"kind": "sines"}, ["ship.toml: vessel: nothing moves: x, y or both are needed"]),
    "empty list": ({"kind": "sines", "y": []}, ["ship.toml: vessel.y = []: a list with at least one sine"]),
    "no list": ({"kind": "sines", "y": 3}, ["ship.toml: vessel.y = 3: a list is expected"]),
    "sines": (
        {"kind": "sines", "x": [SINE | {"frequency": 1}, {"amplitude": "5 s", "period": 0}], "ramp": -3},
        [
            "ship.toml: vessel.x, entry 1: frequency and period contradict each other: exactly one of",
            'ship.toml: vessel.x, entry 2.amplitude = "5 s": a displacement [m] is expected',
            "ship.toml: vessel.x, entry 2.period = 0: a time must be greater than 0",
            "ship.toml: vessel.ramp = -3: a time must be 0 or greater",
        ],
    ),
    "no file": ({"kind": "csv"}, ["ship.toml: vessel.file: this key is missing; Comma-separated, UTF-8, in s and m"]),
    "file is no text": ({"kind": "csv", "file": 3}, ["ship.toml: vessel.file = 3: a text is expected"]),
    "file is not there": (
        {"kind": "csv", "file": "a.csv"}, ['ship.toml: vessel.file = "a.csv": there is no such file']
    ),
    "file is a folder": ({"kind": "csv", "file": "."}, ['ship.toml: vessel.file = ".": there is no such file']),
    "name of a file": (
        {"kind": "csv", "file": "a\0b"}, ['ship.toml: vessel.file = "a\\u0000b": there is no such file']
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_all_mistakes_are_said_at_once(mistake: str, tmp_path: Path) -> None:
    table, expected = MISTAKES[mistake]
    with pytest.raises(VesselError) as refused:
        Vessel.from_table(table, folder=tmp_path, source="ship.toml: vessel")
    lines = str(refused.value).splitlines()
    assert len(lines) == len(expected)
    for line, start in zip(lines, expected, strict=True):
        assert start in line
    assert isinstance(refused.value, UserError) and refused.value.exit_status == 2


FILES = {
    "": "there is no line with numbers in it",
    "0,0,0\n1,0,0\n2,0,0\n3,0,0\n": 'there is no column "time", as the first line has no names',
    "t,x,y\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n": 'there is no column "time"; the columns are t, x, y',
    "time,x\n0,0\n1,0\n2,0\n3,0\n": 'there is no column "y"; the columns are time, x',
    "time,x,y\n0,0,0\n1,0,0\n2,0,0\n": "a curve needs at least 4 lines of numbers; there are 3",
    "time,x,y\n0,0,0\n1,0,0\n1,0,0\n3,0,0\n": "row 4: time 1 s does not come after 1 s",
    "time,x,y\n0,0,0\n1,nan,0\n2,0,0\n3,0,0\n": 'row 3, column 2: a finite number is expected, there is "nan"',
    "time,x,y\n0,0,0\n1,0,0\n2,0\n3,0,0\n": 'row 4, column 3: a finite number is expected, there is ""',
    "time,x,y\n0,0,0\n1,0,zero\n2,0,0\n3,0,0\n": 'row 3, column 3: a finite number is expected, there is "zero"',
}


@pytest.mark.parametrize("text", FILES)
def test_files_that_are_not_in_order(text: str, tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text(text)
    with pytest.raises(VesselError) as refused:
        Vessel.from_table({"kind": "csv", "file": "m.csv"}, folder=tmp_path)
    assert str(refused.value) == f'vessel.file = "m.csv": {FILES[text]}'


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_bytes(np.arange(200, dtype=np.uint8).tobytes())
    with pytest.raises(VesselError, match="this is not a comma-separated text in UTF-8"):
        Vessel.from_table({"kind": "csv", "file": "m.csv"}, folder=tmp_path)
