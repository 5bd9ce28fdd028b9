"""Which cases a file asks for, and in which order."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cablefmu.errors import SweepError
from cablefmu.sweeping.cases import Axes
from cablefmu.sweeping.description import make_sweep


def axes(folder: Path = Path(), **tables: Any) -> Axes:
    return make_sweep({"scenes": ["load"], **tables}, name="s", folder=folder).axes


def test_a_grid_has_every_combination_its_last_name_fastest() -> None:
    cases = list(axes(scenes=["a", "b"], grid={"M_1": [1, 2], "Cd": [3, 4]}).cases())
    assert [case.number for case in cases] == list(range(1, 9))
    assert [case.subject for case in cases] == ["a"] * 4 + ["b"] * 4
    assert [tuple(case.given.values()) for case in cases[:4]] == [(1.0, 3.0), (1.0, 4.0), (2.0, 3.0), (2.0, 4.0)]


def test_a_list_sets_what_its_fields_hold(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("\ufeffM_1, solver\n6000, implicit\n\n,explicit\n1e3,\n", encoding="utf-8")
    cases = axes(tmp_path, list={"file": "cases.csv"}).cases()
    assert [case.given for case in cases] == [
        {"M_1": 6000.0, "solver": "implicit"},
        {"solver": "explicit"},
        {"M_1": 1e3},
    ]


def test_a_latin_hypercube_has_one_point_in_each_of_equal_intervals_of_every_range() -> None:
    table = {"count": 50, "seed": 7, "ranges": {"M_1": [4000, 8000], "Cd": [-1, 1]}}
    points = [case.given for case in axes(sample=table).cases()]
    for name, (low, high) in table["ranges"].items():  # type: ignore[attr-defined]
        values = np.array([point[name] for point in points], dtype=float)
        assert sorted(np.floor(50 * (values - low) / (high - low))) == list(range(50))
    assert points == [case.given for case in axes(sample=table).cases()]
    assert points != [case.given for case in axes(sample=table | {"seed": 8}).cases()]


def test_everything_is_combined_with_everything(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("g\n9.8\n9.81\n")
    made = axes(
        tmp_path, scenes=["a", "b", "c"], list={"file": "cases.csv"}, grid={"M_1": [1, 2]},
        sample={"count": 5, "ranges": {"Cd": [0, 1]}},
    )  # fmt: skip
    assert len(made) == len(list(made.cases())) == 3 * 2 * 2 * 5
    assert made.names == ["g", "M_1", "Cd"]
    assert len({(case.subject, *case.given.values()) for case in made.cases()}) == len(made)


@pytest.mark.parametrize(("tables", "message"), [
    ({}, "nothing varies: grid, list or sample is expected, or several scenes"),
    ({"scenes": ["load", "load"]}, 'scenes = "load": this scene was named before; once is allowed'),
    ({"grid": {"M_1": [1]}, "set": {"M_1": 2}}, "grid.M_1: it is in set as well; one of them is expected"),
    ({"grid": {"M_1": [1]}, "sample": {"count": 1, "ranges": {"M_1": [1, 2]}}},
     "sample.ranges.M_1: it is in grid as well"),
    ({"grid": {"M_1": list(range(1001)), "Cd": list(range(1000))}}, "1,001,000 cases; at most 1,000,000 are allowed"),
    ({"list": {"file": "none.csv"}}, 'list.file = "none.csv": there is no such file'),
    ({"list": {"file": "empty.csv"}}, "its first line must name what is set, each name once"),
    ({"list": {"file": "twice.csv"}}, "its first line must name what is set, each name once"),
    ({"list": {"file": "head.csv"}}, "it has no cases; a line with values is expected below the names"),
    ({"list": {"file": "ragged.csv"}}, "line 3 has 1 fields; 2 are expected"),
])  # fmt: skip
def test_what_makes_no_cases_is_refused(tables: dict[str, Any], message: str, tmp_path: Path) -> None:
    files = {"empty": "", "twice": "a,a\n1,2\n", "head": "a,b\n", "ragged": "a,b\n1,2\n3\n"}
    for name, text in files.items():
        (tmp_path / f"{name}.csv").write_text(text)
    with pytest.raises(SweepError) as refused:
        axes(tmp_path, **tables)
    assert message in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1
