"""The page of variables: every one that an FMU can have, as the FMUs themselves say it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from docs.site.variables import ARRAYS, entries, variables_page, where
from fmpy import read_model_description

import cablefmu
from cablefmu.fmu.table import table
from cablefmu.scene import shipped_scenes


@pytest.fixture(scope="module")
def rows() -> dict[str, list[str]]:
    """Cells of the page's tables by name."""
    found = re.findall(r"^\| `([^`]+)` \| (.*) \|$", variables_page(), re.MULTILINE)
    return {name: [cell.strip() for cell in re.split(r"(?<!\\)\|", rest)] for name, rest in found}


@pytest.mark.parametrize("name", ["free-12-water", "floaters-both-80", "lifted-40", "moored-40"])
def test_what_an_fmu_has_is_on_the_page(name: str, rows: dict[str, list[str]], tmp_path: Path) -> None:
    """Read by FMPy from the archive: names, units, causality and description."""
    path = cablefmu.build_fmu(name, tmp_path / "x.fmu", fmi=3, platforms=["x86_64-linux"])
    for variable in read_model_description(path).modelVariables:
        unit, causality, what, _ = rows[re.sub(r"\[\d+\]", "[i]", variable.name)]
        assert unit == (variable.unit or "")
        assert causality.split(",")[0] == variable.causality
        said = re.sub(r"\[\d+\]", "[i]", re.sub(r"\bLink \d+", "Link i", variable.description or ""))
        assert said.startswith(what.replace("\\|", "|"))


def test_nothing_that_the_kernel_knows_is_missing(rows: dict[str, list[str]]) -> None:
    known = table()
    names = {n for part in (known.parameters, known.inputs, known.outputs, known.solver, known.statics, known.whole)
             for n in part}  # fmt: skip
    assert names <= set(rows) and len(names) > 60


def test_every_row_is_whole(rows: dict[str, list[str]]) -> None:
    assert [
        name for name, cells in rows.items() if len(cells) != 4 or not cells[1] or not cells[2] or not cells[3]
    ] == []
    assert len(rows) == len(entries())


@pytest.mark.parametrize(
    ("name", "places"),
    [
        ("x_c", "all"),
        ("u_m2", "a second floater"),
        ("F_1x", "a vessel at the top"),
        ("u_m1", "a floater that heaves or a floater that heaves and surges"),
        ("rho_w", "water"),
        ("rho_c", "a load or an anchor on springs, and water"),
        ("EI", f"only {ARRAYS}"),
        ("V_c", "none that ships"),
    ],
)
def test_where_it_is(name: str, places: str, rows: dict[str, list[str]]) -> None:
    assert rows[name][3] == places


def test_scenes_that_nothing_tells_apart_are_named() -> None:
    first, second, *_ = shipped_scenes()
    assert where([first]) == f"`{first}`" and where([first, second, ARRAYS]).startswith(f"`{first}`, `{second}`")
