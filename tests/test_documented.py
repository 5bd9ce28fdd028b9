"""Code blocks in docs/: those of tutorials and pages run and print what they say; TOML and JSON can be read."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

from tests.documented import blocks_of, run_page

ROOT = Path(__file__).parents[1]
PAGES = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md"))
TUTORIALS = [page for page in PAGES if page.startswith("docs/tutorials/")]
ELSEWHERE = {"docs/examples.md"}
"""Whose commands tests/examples/test_page.py takes, beside the files that they name."""
RUN = [
    page
    for page in PAGES
    if page not in ELSEWHERE and any(b.kind in ("sh", "python") for b in blocks_of((ROOT / page).read_text("utf-8")))
]


@pytest.mark.parametrize("page", PAGES)
def test_data_can_be_read(page: str) -> None:
    for block in blocks_of((ROOT / page).read_text("utf-8")):
        if block.kind == "toml":
            assert tomllib.loads(block.text)
        elif block.kind == "json":
            assert json.loads(block.text)
        else:
            assert block.kind in ("sh", "python", "text")


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN)
def test_code_runs_and_prints_what_the_page_says(page: str, tmp_path: Path) -> None:
    assert run_page(page, blocks_of((ROOT / page).read_text("utf-8")), tmp_path) == []


def test_every_tutorial_is_run() -> None:
    assert len(TUTORIALS) >= 4 and set(TUTORIALS) <= set(RUN)


def test_blocks_are_found_with_their_lines_and_files() -> None:
    text = "a\n```sh\nls\n```\n<!-- file: x.toml -->\n```toml\na = 1\n```\n   ```sh\n   no\n   ```\n```\nplain\n```\n"
    assert [(b.kind, b.text, b.line, b.file) for b in blocks_of(text)] == [
        ("sh", "ls\n", 2, None),
        ("toml", "a = 1\n", 6, "x.toml"),
    ]


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("```python\nx = 2\nprint(x, 7)\n```\nand\n```text\n2 ...\n```\n", ""),
        ("<!-- file: f -->\n```text\nhello\n```\n```sh\ncat f\n```\n```text\nhello\n```\n", ""),
        ("```python\nx = 2\n```\n```python\nprint(x)\n```\n```text\n3\n```", "line 7: expected '3\\n', printed '2\\n'"),
        ("```sh\nfalse | cat\n```\n", "page: status 1"),
        ("\n```python\n\n1 / 0\n```\n", '"page", line 4'),
        ("```python\nimport warnings; warnings.warn('old', DeprecationWarning)\n```\n", "DeprecationWarning: old"),
    ],
)  # fmt: skip
def test_what_goes_wrong_is_told(text: str, wrong: str, tmp_path: Path) -> None:
    found = run_page("page", blocks_of(text), tmp_path)
    assert len(found) == bool(wrong) and all(wrong in line for line in found)
