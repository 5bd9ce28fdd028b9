"""The tables of capabilities: ours is what the built FMU says, and facts are read as they stand in a file."""

from __future__ import annotations

import zipfile
from importlib.resources import files
from pathlib import Path

import pytest

from tests.benchmarks.capabilities import PAGES, column, markdown, needed_libraries, our_column, updated, written_column

_TWO = """<fmiModelDescription fmiVersion="2.0">
<ModelExchange modelIdentifier="x" providesDirectionalDerivative="true"/>
<CoSimulation modelIdentifier="x" canGetAndSetFMUstate="true" maxOutputDerivativeOrder="1"/>
</fmiModelDescription>"""
_THREE = """<fmiModelDescription fmiVersion="3.0">
<CoSimulation modelIdentifier="x" canGetAndSetFMUState="true" providesIntermediateUpdate="true"/>
</fmiModelDescription>"""


@pytest.fixture(scope="module")
def ours() -> dict[str, str]:
    return our_column()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_our_column_is_what_the_built_fmu_says(page: Path, ours: dict[str, str]) -> None:
    """If not: python -m tests.benchmarks.capabilities."""
    assert written_column(page.read_text("utf-8")) == {name: ours[name] for name in PAGES[page]}


def test_what_a_file_says_and_what_the_standard_says_where_it_is_silent(tmp_path: Path) -> None:
    two, three = tmp_path / "2.xml", tmp_path / "3.fmu"
    two.write_text(_TWO)
    with zipfile.ZipFile(three, "w") as archive:
        archive.writestr("modelDescription.xml", _THREE)
        archive.writestr("resources/model.py", "")
        archive.writestr("binaries/x86_64-windows/x.dll", "")
    first, second, both = column([two]), column([three]), column([three, two])
    assert first["interfaces"] == "ME + CS"
    assert first["state: get and set"] == "no (ME), yes (CS)"
    assert first["directional derivatives"] == "yes (ME), no (CS)"
    assert first["output derivatives, order"] == "1"
    assert first["adjoint derivatives"] == first["intermediate update"] == "–"
    assert {first[row] for row in ("Python code inside", "icon", "binaries for")} == {"not known"}
    assert second["Python code inside"] == "yes"
    assert second["binaries for"] == "x86_64-windows"
    assert second["libraries it asks for (Linux)"] == "none"
    assert second["input derivatives"] == "–"
    assert both["FMI"] == "2.0, 3.0"
    assert both["intermediate update"] == "yes"
    assert both["directional derivatives"] == "yes (ME), no (CS) (FMI 2), no (FMI 3)"


def test_libraries_are_those_that_the_binary_names() -> None:
    content = (files("cablefmu") / "binaries" / "x86_64-linux" / "cable.so").read_bytes()
    assert set(needed_libraries(content)) <= {"libm.so.6", "libc.so.6"}
    assert "libc.so.6" in needed_libraries(content)
    with pytest.raises(ValueError, match="64-bit little-endian ELF"):
        needed_libraries(b"MZ")


def test_only_our_column_is_brought_up_to_date() -> None:
    table = markdown({"cablefmu": {"a": "no", "b": "1"}, "other": {"a": "no", "b": "2"}}, ("a", "b"))
    page = f"words | no | no\n\n{table}\n| a | no | no |\n"
    anew = updated(page, {"a": "yes"})
    assert anew == page.replace("| a | no | no |", "| a | yes | no |", 1)
    assert written_column(anew) == {"a": "yes", "b": "1"}
