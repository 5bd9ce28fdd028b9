"""`python -m docs.site [FOLDER]`: build the pages into FOLDER/html, build/docs/html by default, and check their links.

A warning of Sphinx, a link to what is not there and an address that is none end it with status 1.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from docs.site.links import broken_links
from docs.site.performance import performance_page
from docs.site.variables import variables_page
from sphinx.cmd.build import build_main

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
_COPIED = ("*.md", "*.svg", "*.png", "*.ipynb", "report/*", "stress/*", "tutorials/*", "examples/*.png",
           "site/*.md")  # fmt: skip
_FURTHER = "<!-- further pages -->"


def gather(source: Path) -> None:
    """Put together what Sphinx reads: docs/ as it stands, and the pages that are generated."""
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for pattern in _COPIED:
        for path in sorted(DOCS.glob(pattern)):
            target = source / path.relative_to(DOCS / "site" if pattern.startswith("site/") else DOCS)
            target.parent.mkdir(exist_ok=True)
            shutil.copyfile(path, target)
    shutil.copyfile(ROOT / "CHANGELOG.md", source / "changelog.md")
    index = source / "index.md"
    index.write_text(with_further_pages(index.read_text("utf-8"), source), "utf-8")
    (source / "variables.md").write_text(variables_page(), "utf-8")
    (source / "performance.md").write_text(performance_page(ROOT), "utf-8")


def with_further_pages(index: str, source: Path) -> str:
    """The front page with a list of those pages that it does not name itself."""
    pages = (path.relative_to(source).with_suffix("").as_posix() for path in sorted(source.rglob("*.md")))
    further = [page for page in pages if page != "index" and page not in index.splitlines()]
    listed = "\n".join(["```{toctree}", ":caption: Further", ":maxdepth: 1", "", *further, "```"])
    return index.replace(_FURTHER, listed if further else "")


def main(folder: Path = ROOT / "build" / "docs") -> int:
    source, pages = folder / "source", folder / "html"
    gather(source)
    shutil.rmtree(pages, ignore_errors=True)
    conf = str(Path(__file__).parent)
    # -W --keep-going: warnings are errors, and all of them are told at once.
    status = build_main(["-q", "-W", "--keep-going", "-b", "html", "-c", conf, "-d", str(folder / "cache"), str(source),
                         str(pages)])  # fmt: skip
    if status:
        return status
    broken = broken_links(pages)
    for text in broken:
        print(text, file=sys.stderr)
    print(pages / "index.html")
    return int(bool(broken))


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:2])))
