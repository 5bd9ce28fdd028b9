"""What the README, docs/ and comments in the source point to is there: files, tests, sections, links."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from docs.site.links import is_address

from cablefmu.fmu.archive import build_fmu

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *(page for page in sorted((ROOT / "docs").rglob("*.md")) if page.parent.name != "site")]
"""Those of docs/site point to pages that are generated; `python -m docs.site` checks them."""

FOLDERS = ("fmu_src/", "models/", "tests/", "docs/")
"""Where named files must exist; what is in build/ is generated."""

_FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"`([^`\n]+)`")
_LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)#?([^)\s]*)\)")
_ADDRESS = re.compile(r"\]\((\w+://[^)]*)\)")
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
_TEST = re.compile(r"^ *def (test_\w+)\(", re.MULTILINE)
_TO_SECTION = re.compile(r"docs/(\w+\.md), (?:section )?\"([^\"\n]+)\"")


@cache
def known_tests(pattern: str) -> frozenset[str]:
    """Names of the test functions in the files that match."""
    return frozenset(name for path in ROOT.glob(pattern) for name in _TEST.findall(path.read_text("utf-8")))


def headings(page: Path) -> list[str]:
    return _HEADING.findall(_FENCE.sub("", page.read_text("utf-8")))


def anchor(heading: str) -> str:
    """As GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def missing(text: str, page: Path) -> Iterator[str]:
    """What `text` on `page` names as code or links to, and is not there."""
    text = _FENCE.sub("", text)
    for code in _CODE.findall(text):
        path, _, test = code.partition("::")
        if path.startswith(FOLDERS):
            if not any(ROOT.glob(path)) or (test and test not in known_tests(path)):
                yield code
        elif re.fullmatch(r"test_\w+", code) and code not in known_tests("tests/**/test_*.py"):
            yield code
    for name, section in _LINK.findall(text):
        target = page.parent / name if name else page
        if not target.exists() or (section and section not in map(anchor, headings(target))):
            yield f"{name}#{section}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_what_a_page_names_exists(page: Path) -> None:
    assert list(missing(page.read_text("utf-8"), page)) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_addresses_elsewhere_have_a_form(page: Path) -> None:
    """Whether somebody answers there is not asked: checks run without a network."""
    assert [link for link in _ADDRESS.findall(page.read_text("utf-8")) if not is_address(link)] == []


@pytest.mark.parametrize(
    ("text", "gone"),
    [
        ("`fmu_src/kernel/chain.c`, `fmu_src/kernel/*.c`, `build/x.fmu`, `a/b`, [x](model.md#in-on), [y](#errata)", []),
        ("[x](numerics.md), [y](numerics.md#heavy-ends)", []),
        ("`fmu_src/kernel/chains.c`", ["fmu_src/kernel/chains.c"]),
        ("`tests/*/test_chian.py`", ["tests/*/test_chian.py"]),
        ("`test_what_a_page_names_exists`, `test_nothing`", ["test_nothing"]),
        ("`tests/test_docs.py::test_what_a_page_names_exists`, `tests/test_docs.py::test_hanging_cable_stays_at_rest`",
         ["tests/test_docs.py::test_hanging_cable_stays_at_rest"]),
        ("[x](models.md), [y](#erratum), [z](model.md#in-n)", ["models.md#", "#erratum", "model.md#in-n"]),
        ("```\n`tests/in_a_fence.py`\n```", []),
    ],
)  # fmt: skip
def test_what_is_gone_is_found(text: str, gone: list[str]) -> None:
    assert list(missing(text, ROOT / "docs" / "model.md")) == gone


def test_sections_that_the_source_points_to_exist() -> None:
    sources = [path for suffix in ("c", "h", "py") for path in ROOT.glob(f"[fm][mo]*/**/*.{suffix}")]
    found = {match for path in sources for match in _TO_SECTION.findall(path.read_text("utf-8"))}
    assert ("model.md", "In O(n)") in found
    assert [(page, name) for page, name in found if name not in headings(ROOT / "docs" / page)] == []


def test_the_size_that_the_readme_gives_is_that_of_an_fmu(tmp_path: Path) -> None:
    size = build_fmu("free-60-water", tmp_path / "cable.fmu").stat().st_size
    assert f"; {size / 1e6:.1f} MB in all" in " ".join((ROOT / "README.md").read_text("utf-8").split())
