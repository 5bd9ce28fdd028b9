"""The link checker: what is there passes, and every kind of link that leads nowhere is told."""

from __future__ import annotations

from pathlib import Path

import pytest
from docs.site.links import broken_links


def site(folder: Path, link: str) -> Path:
    (folder / "sub").mkdir()
    (folder / "sub" / "index.html").write_text('<h1 id="top">x</h1>')
    (folder / "a b.html").write_text('<p id="été"><img src="sub/../x.png">')
    (folder / "x.png").write_bytes(b"")
    (folder / "page.html").write_text(f'<p id="here"><a href="{link}">x</a>')
    return folder


@pytest.mark.parametrize(
    "link",
    ["#here", "#", "sub/index.html#top", "sub/", "a%20b.html#%C3%A9t%C3%A9", "x.png", "https://fmi-standard.org/docs/3.0#x",
     "data:image/png;base64,AA"],
)  # fmt: skip
def test_what_is_there_passes(link: str, tmp_path: Path) -> None:
    assert broken_links(site(tmp_path, link)) == []


@pytest.mark.parametrize(
    ("link", "why"),
    [
        ("#gone", "no such anchor"),
        ("sub/index.html#bottom", "no such anchor"),
        ("gone.html", "no such file"),
        ("sub/gone.png", "no such file"),
        ("http://fmi-standard.org", "https:// with a host is expected"),
        ("https://fmi-standard", "https:// with a host is expected"),
        ("https://fmi-standard.org/a b", "https:// with a host is expected"),
        ("//fmi-standard.org", "https:// with a host is expected"),
        ("file:///etc/passwd", "https:// with a host is expected"),
    ],
)
def test_what_leads_nowhere_is_told(link: str, why: str, tmp_path: Path) -> None:
    assert broken_links(site(tmp_path, link)) == [f"page.html: {link}: {why}"]
