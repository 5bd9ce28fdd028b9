"""A host in a country with a decimal comma, or where a small I has no dot, gets the same bits and the same words."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.robustness.building import compile_with_zig, copy_of_sources, run

pytestmark = pytest.mark.system

PRINTF = {
    "fmi/text.c": (
        "void text_number(Text *text, double value)\n{\n",
        "#include <stdio.h>\nvoid text_number(Text *text, double value)\n{\n    char shown[40];\n"
        '    snprintf(shown, sizeof shown, "%g", value);\n    text_add(text, shown);\n    return;\n',
    )
}
"""A defect for the tests to find: numbers in messages by the host's locale."""

somewhere = pytest.mark.parametrize("name", ["pt_BR", "tr_TR"])


@pytest.fixture(scope="module")
def locales(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Both locales made from the C library's own descriptions, and the environment that finds them."""
    folder = tmp_path_factory.mktemp("locales")
    for name in ("pt_BR", "tr_TR"):
        command = ["localedef", "-i", name, "-f", "UTF-8", str(folder / f"{name}.UTF-8")]
        made = subprocess.run(command, capture_output=True, text=True)
        assert made.returncode == 0, made.stderr
    return {"LOCPATH": str(folder)}


@somewhere
def test_bits_and_words_are_the_same(name: str, shipped_host: Path, words: list[str], locales: dict[str, str]) -> None:
    """The host itself makes sure that it writes a comma (host.c)."""
    home = run(shipped_host, "tour", words)
    abroad = run(shipped_host, "tour", words, locale=f"{name}.UTF-8", environment=locales)
    assert (abroad.returncode, abroad.stderr) == (0, "")
    assert "M_1 = -0.5 at t = 0 s: a number above 0 is expected" in abroad.stdout
    assert abroad.stdout == home.stdout


@somewhere
def test_a_comma_would_be_found(name: str, tmp_path: Path, words: list[str], locales: dict[str, str]) -> None:
    host = compile_with_zig(tmp_path / "host", sources=copy_of_sources(tmp_path, PRINTF))
    assert "M_1 = -0,5" in run(host, "tour", words, locale=f"{name}.UTF-8", environment=locales).stdout
