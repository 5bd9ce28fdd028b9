"""Whether what the pages link to is there.

Pages, files and anchors of ours must exist. Addresses elsewhere are not called, as checks run without a network: only
their form is looked at.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

__all__ = ["broken_links", "is_address"]


class _Page(HTMLParser):
    """What a page links to, and what can be linked to in it."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = {""}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


@cache
def _parsed(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text("utf-8"))
    return page


def broken_links(folder: Path) -> list[str]:
    """One line for every link below `folder` that leads nowhere: page, link, why."""
    return [
        f"{path.relative_to(folder)}: {link}: {why}"
        for path in sorted(folder.rglob("*.html"))
        for link, why in _broken(path)
    ]


def _broken(path: Path) -> Iterator[tuple[str, str]]:
    for link in dict.fromkeys(_parsed(path).links):
        parts = urlsplit(link)
        if parts.scheme == "data":
            continue
        if parts.scheme or parts.netloc:
            if not is_address(link):
                yield link, "https:// with a host is expected"
            continue
        target = path.parent / unquote(parts.path) if parts.path else path
        if target.is_dir():
            target = target / "index.html"
        if not target.exists():
            yield link, "no such file"
        elif target.suffix == ".html" and unquote(parts.fragment) not in _parsed(target).anchors:
            yield link, "no such anchor"


def is_address(link: str) -> bool:
    """Whether an address elsewhere has the form of one: encrypted, with a host and nothing that must be encoded."""
    parts = urlsplit(link)
    host = parts.hostname or ""
    return parts.scheme == "https" and "." in host.strip(".") and not set(link) & set(" <>\"'{}|\\^`")
