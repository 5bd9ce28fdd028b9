"""What every page has: a title that is text, its own style, light and dark, and nothing to fetch."""

from __future__ import annotations

from html.parser import HTMLParser

from cablefmu.pages import html_page


class Reader(HTMLParser):
    """Tags in order, and the text of each kind."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: dict[str, str] = {}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        if self.tags:
            tag = self.tags[-1][0]
            self.text[tag] = self.text.get(tag, "") + data


def test_a_page_is_whole_and_its_words_are_escaped() -> None:
    page = html_page("a < b", ["<h1>One</h1>", "<p>Two</p>"], style="h1 { color: var(--ink); }", made_with="x & y")
    reader = Reader()
    reader.feed(page)
    assert page.startswith("<!DOCTYPE html>")
    assert reader.text["title"].strip() == "a < b"
    assert page.index("<h1>One</h1>") < page.index("<p>Two</p>") < page.index("x &amp; y")
    assert "h1 { color: var(--ink); }" in reader.text["style"]
    assert "@media (prefers-color-scheme: dark)" in reader.text["style"]
    assert ("meta", {"name": "viewport", "content": "width=device-width, initial-scale=1"}) in reader.tags
    assert not {"script", "link", "img"} & {tag for tag, _ in reader.tags}


def test_what_is_for_the_head_is_there() -> None:
    page = html_page("", [], style="", made_with="", head=['<meta name="a">', '<meta name="b">'])
    assert '<meta name="a">\n<meta name="b">\n' in page.partition("</head>")[0]


def test_every_colour_of_the_light_page_has_its_dark_one() -> None:
    style = html_page("", [], style="", made_with="").partition("<style>")[2]
    light, dark = style.split("@media")[:2]
    names = {word.strip(" ;{") for word in light.replace(":", " ").split() if word.startswith("--")}
    assert len(names) == 5
    assert all(f"{name}:" in dark for name in names)
