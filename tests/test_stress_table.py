"""What a run of the stress grid leaves: lines, CSV, JSON, Markdown and a page, read back."""

from __future__ import annotations

import csv
import json
import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from cablefmu.stress_page import write_page
from cablefmu.stress_table import header, line, made_with, summary, write_markdown, write_results
from cablefmu.stress_verdict import Row
from tests.test_stress_run import case_of


@pytest.fixture
def rows() -> list[Row]:
    right = Row(
        case_of("cable.links = 3"), "within tolerance", "", 3, 1e-6, "explicit", {"steps": 1234.0, "rhs": 7404.0},
        0.0123, 4e-6, 0.02, 0.01, 2e-4, 1.5, 1.0, 3.0, 5e-8, "implicit, explicit", 0.5, 1.0,
    )  # fmt: skip
    wrong = Row(
        case_of('cable.density = "1 | 2 <kg/m^3>"'), "wrong", "1 m off", 12, 1e-6, "both", {"steps": 9.0}, 1.0, 1.0, 3.0
    )
    error = Row(case_of('cable.links = 3, fails = "because"'), "clean error", "a message")
    return [right, wrong, error]


def test_a_line_says_what_came_of_a_case(rows: list[Row]) -> None:
    assert header().split("  ")[0] == "case"
    words = line(rows[0]).split()
    assert words[:8] == ["g-a", "3", "1e-06", "explicit", "1,234", "0.0123", "4.0e-06", "0.02"]
    assert line(rows[0]).endswith("within tolerance up to 0.5 s")
    assert line(rows[1]).endswith("wrong: 1 m off")
    assert "nan" not in line(rows[2])
    assert summary(rows) == "3 cases: 1 within tolerance, 1 wrong, 1 clean error"


def test_csv_and_json_hold_every_figure(rows: list[Row], tmp_path: Path) -> None:
    files = write_results(rows, tmp_path / "new")
    assert [file.name for file in files] == ["stress.csv", "stress.json"]
    with files[0].open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [float(row["error"]) for row in table[:2]] == [4e-6, 1.0] and math.isnan(float(table[2]["error"]))
    assert [row["verdict"] for row in table] == ["within tolerance", "wrong", "clean error"]
    data = json.loads(files[1].read_text(encoding="utf-8"))
    assert data["made"] == made_with()
    assert [case["rhs"] for case in data["cases"]] == [7404.0, None, None]
    assert data["cases"][2]["reason"] == "because"


def test_versions_and_machine_are_told() -> None:
    from cablefmu import __version__

    assert made_with().startswith(f"cablefmu {__version__}, fmpy ")
    assert " cores, " in made_with()


def test_the_markdown_table_has_a_row_of_equal_width_for_every_case(rows: list[Row], tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    write_markdown(rows, path)
    text = path.read_text(encoding="utf-8")
    table = [row.replace("\\|", "") for row in text.splitlines() if row.startswith("|")]
    assert len(table) == 2 + len(rows)
    assert {row.count("|") for row in table} == {16}
    assert table[2].startswith(
        '| a | free-12-water: run.stop_time = "1 s", cable.links = 3 | 2 | 3 | 1e-06 | explicit | 1,234 |'
    )
    assert "| 0.02 | 1.0e-02 | 2.0e-04 | 1.5 | I E |" in table[2]
    assert table[4].endswith("| clean error: a message (because) |")
    assert summary(rows) in text and made_with() in text


def test_the_page_stands_alone_and_has_a_cell_for_every_case_and_figure(rows: list[Row], tmp_path: Path) -> None:
    text = write_page(rows, tmp_path / "stress.html").read_text(encoding="utf-8")
    assert "<script" not in text and "href" not in text and "src=" not in text
    images = [ET.fromstring(image) for image in re.findall(r"<svg.*?</svg>", text, re.DOTALL)]
    panels = [image.findall("{http://www.w3.org/2000/svg}rect") for image in images]
    assert [len(cells) for cells in panels] == [len(rows)] * 6
    framed = ["stroke" in cell.attrib for cells in panels for cell in cells]
    assert framed == [False, True, False] * 6, "what failed is framed"
    titles = [cells[0][0].text for cells in panels]
    assert titles[:2] == ["g-a: explicit, within tolerance", "g-a: 1,234 steps, within tolerance"]
    assert titles[3:] == [
        "g-a: 0.02 of the allowed, within tolerance",
        "g-a: off by 0.01 of the allowed, within tolerance",
        "g-a: off by 0.0002 of the allowed, within tolerance",
    ]
    assert "1 | 2 &lt;kg/m^3&gt;" in text
    assert "prefers-color-scheme: dark" in text and 'name="viewport"' in text


def test_every_cell_is_inside_its_figure(rows: list[Row], tmp_path: Path) -> None:
    text = write_page(rows * 20, tmp_path / "stress.html").read_text(encoding="utf-8")
    for image in re.findall(r"<svg.*?</svg>", text, re.DOTALL):
        element = ET.fromstring(image)
        cells = element.findall("{http://www.w3.org/2000/svg}rect")
        assert max(int(cell.attrib["x"]) + int(cell.attrib["width"]) for cell in cells) <= int(element.attrib["width"])
        assert max(int(cell.attrib["y"]) + int(cell.attrib["height"]) for cell in cells) <= int(
            element.attrib["height"]
        )
