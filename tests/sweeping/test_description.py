"""Sweep files: what is read, and what is refused with where, value and what is allowed."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from cablefmu.errors import SweepError
from cablefmu.sweeping.description import is_sweep_file, make_sweep, read_tables
from tests.documented import blocks_of
from tests.fmu_helpers import SCENES

FILE = """
name = "masses"
scenes = ["load"]
[run]
stop_time = "5 s"
[set]
Cd = 1.2
[grid]
M_1 = [4000, 8000.5]
solver = ["explicit"]
[statistics]
slope = 4
"""


def test_a_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(FILE)
    made = make_sweep(read_tables(tmp_path / "s.toml"), name="s", folder=tmp_path)
    spec = made.spec
    assert (made.name, spec.run.stop_time, spec.set, spec.statistics.slope) == ("masses", 5.0, {"Cd": 1.2}, 4.0)
    assert made.spec.grid == {"M_1": (4000.0, 8000.5), "solver": ("explicit",)}


def test_the_files_of_the_documentation_are_in_order(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("u_m1\n100\n")
    page = (Path(__file__).parents[2] / "docs" / "sweep.md").read_text("utf-8")
    files = [block.text for block in blocks_of(page) if block.kind == "toml"]
    sizes = [len(make_sweep(tomllib.loads(text), name="s", folder=tmp_path).axes) for text in files]
    assert sizes == [2 * 1 * 6 * 200, 30]


def test_a_sweep_file_is_no_scene_and_no_coupling(tmp_path: Path) -> None:
    texts = {
        "sweep": FILE, "of-coupling": 'coupling = "x"\n', "scene": SCENES["load"], "torn": "scenes = [",
        "coupling": "[coupling]\nstop_time = 1\n",
    }  # fmt: skip
    for name, text in texts.items():
        (tmp_path / f"{name}.toml").write_text(text)
    assert [name for name in texts if is_sweep_file(str(tmp_path / f"{name}.toml"))] == ["sweep", "of-coupling"]
    assert not is_sweep_file("load")


@pytest.mark.parametrize(("tables", "message"), [
    ({"grid": {"M_1": [1]}}, "something is missing: exactly one of scenes, coupling is needed"),
    ({"scenes": ["a"], "coupling": "b"}, "scenes and coupling contradict each other"),
    ({"scenes": []}, "scenes = []: a list with at least one value is expected"),
    ({"scenes": ["a"], "gird": {}}, 'gird: unknown key; the nearest is "grid"'),
    ({"scenes": ["a"], "grid": {"M_1": []}}, "grid.M_1 = []: a list with at least one value is expected"),
    ({"scenes": ["a"], "grid": {"M_1": 3}}, "grid.M_1 = 3: a list with at least one value is expected"),
    ({"scenes": ["a"], "grid": {"M_1": [1, float("nan")]}}, "a finite number in SI units is expected"),
    ({"scenes": ["a"], "grid": {"M_1": [True]}}, "a finite number in SI units is expected"),
    ({"scenes": ["a"], "run": {"stop_time": 0}}, "run.stop_time = 0: a time must be greater than 0"),
    ({"scenes": ["a"], "run": {"fmi": 1}}, "run.fmi = 1: 2 or 3 is expected"),
    ({"scenes": ["a"], "run": {"interface": "xx"}}, 'run.interface = "xx": allowed: cs, me'),
    ({"coupling": "a", "run": {"step": 1}, "grid": {"a.b": [1]}}, "a coupling is run as its own file says"),
    ({"scenes": ["a"], "sample": {"count": 0, "ranges": {"M_1": [1, 2]}}},
     "sample.count = 0: a whole number from 1 to 1,000,000 is expected"),
    ({"scenes": ["a"], "sample": {"count": 9, "ranges": {}}}, "sample.ranges: at least one range is expected"),
    ({"scenes": ["a"], "sample": {"count": 9, "ranges": {"M_1": [2, 1]}}}, "must be larger than the first"),
    ({"scenes": ["a"], "sample": {"count": 9, "ranges": {"M_1": [2]}}}, "two numbers are expected"),
    ({"scenes": ["a"], "sample": {"count": 9, "method": "sobol", "ranges": {"M_1": [1, 2]}}},
     'sample.method = "sobol": allowed: latin-hypercube'),
    ({"scenes": ["a"], "statistics": {"slope": 0.5}}, "statistics.slope = 0.5: the slope of an S-N curve is expected"),
    ({"scenes": ["a"], "name": "a b"}, 'name = "a b": letters, digits, - and _ are expected'),
])  # fmt: skip
def test_a_mistake_is_a_line(tables: dict[str, Any], message: str) -> None:
    with pytest.raises(SweepError) as refused:
        make_sweep(tables, name="s", source="s.toml")
    assert message in str(refused.value)
    assert all(line.startswith("s.toml: ") for line in str(refused.value).splitlines())


@pytest.mark.parametrize(
    ("text", "message"), [(None, "there is no such file"), ("a = [", "not valid TOML"), ("\xff", "cannot be read")]
)
def test_what_is_no_file_of_toml_is_refused(text: str | None, message: str, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / "s.toml").write_bytes(text.encode("latin-1"))
    with pytest.raises(SweepError, match=message):
        read_tables(tmp_path / "s.toml")
