"""What the site is made of, and that what is wrong with it ends the command with status 1."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from docs.site import __main__ as site

ROOT = Path(__file__).parents[2]
_PICTURE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")


def test_pages_are_gathered_with_those_that_are_generated(tmp_path: Path) -> None:
    (tmp_path / "left_over.md").write_text("")
    site.gather(tmp_path)
    found = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert {"index.md", "api.md", "model.md", "tutorials/fmpy.md", "stress/README.md", "notebook.ipynb", "variables.md",
            "performance.md", "changelog.md", "free-60-air.png"} <= found  # fmt: skip
    assert "left_over.md" not in found
    assert all(page.endswith((".md", ".ipynb", ".png", ".svg", ".csv", ".json", ".html")) for page in found)


def test_pictures_are_gathered_with_the_pages_that_show_them(tmp_path: Path) -> None:
    site.gather(tmp_path)
    shown = {
        page.parent / name for page in tmp_path.rglob("*.md") for name in _PICTURE.findall(page.read_text("utf-8"))
        if "://" not in name
    }  # fmt: skip
    assert len(shown) > 5 and [path for path in shown if not path.is_file()] == []


def test_a_page_that_the_front_page_does_not_name_is_listed_there(tmp_path: Path) -> None:
    for name in ("index.md", "model.md", "new.md"):
        (tmp_path / name).write_text("# x")
    index = "```{toctree}\nmodel\n```\n<!-- further pages -->\n"
    assert site.with_further_pages(index, tmp_path).splitlines()[-3:] == ["", "new", "```"]
    (tmp_path / "new.md").unlink()
    assert site.with_further_pages(index, tmp_path) == "```{toctree}\nmodel\n```\n\n"


@pytest.mark.parametrize(("status", "broken", "expected"), [(0, [], 0), (0, ["a: b: no such file"], 1), (2, [], 2)])
def test_status(
    status: int, broken: list[str], expected: int, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    asked: list[str] = []
    monkeypatch.setattr(site, "gather", lambda _: None)
    monkeypatch.setattr(site, "build_main", lambda arguments: asked.extend(arguments) or status)
    monkeypatch.setattr(site, "broken_links", lambda _: broken)
    assert site.main(tmp_path) == expected
    assert {"-W", "--keep-going"} <= set(asked)
    assert capsys.readouterr().err == "".join(f"{line}\n" for line in broken)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "status", "told"),
    [
        ("[there](#x)", 0, ""),
        ("[gone](gone.md)", 1, "gone"),
        ("[gone](#gone)", 1, "gone"),
        ('<a href="http://fmi-standard.org">x</a>', 1, "https:// with a host is expected"),
        ("```{nothing}\n```", 1, "nothing"),
    ],
)
def test_what_sphinx_or_the_links_complain_of_ends_it(text: str, status: int, told: str, tmp_path: Path) -> None:
    """In a process of its own, as Sphinx leaves its marks in one."""
    source = tmp_path / "source"
    source.mkdir()
    (source / "index.md").write_text(f"# x\n\n{text}\n")
    script = (
        "import sys; from pathlib import Path; from docs.site import __main__ as site; site.gather = lambda _: None; "
        f"sys.exit(site.main(Path({str(tmp_path)!r})))"
    )
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, told in done.stderr) == (status, True), done.stderr
