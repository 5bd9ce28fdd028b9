"""Pages in Debian's Chromium, without a head and without a network."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

__all__ = ["CHROMIUM", "PHONE", "Opened", "browser", "opened"]

CHROMIUM = "/usr/bin/chromium"
PHONE = {"viewport": {"width": 390, "height": 844}, "device_scale_factor": 2, "has_touch": True, "is_mobile": True}


class Opened:
    """A page, what it complained of, and what it asked for beside itself."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.complaints: list[str] = []
        self.asked: list[str] = []
        page.on("console", lambda message: self._said(message.type, message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.asked.append(request.url))

    def _said(self, kind: str, text: str) -> None:
        if kind in ("error", "warning"):
            self.complaints.append(text)

    def call(self, script: str, *given: Any) -> Any:
        """`window.cablefmu`'s answer."""
        return self.page.evaluate(f"given => cablefmu.{script}", *given)

    def wait(self, condition: str, seconds: float = 20.0) -> None:
        """Until that is so. The page's policy lets no text become a script within, so it is asked again and again."""
        deadline = time.monotonic() + seconds
        while not self.page.evaluate(condition):
            assert time.monotonic() < deadline, f"{condition} is not so after {seconds} s"
            self.page.wait_for_timeout(20)

    def settled(self) -> None:
        """Wait until what was asked for has been painted."""
        self.page.evaluate("() => new Promise(done => setTimeout(() => requestAnimationFrame(done), 200))")

    def pixels_of(self, k: int = 0) -> list[tuple[float, float]]:
        """Where on the screen a run's nodes must be, by what the axes say [CSS pixels]."""
        view, shape, box = self.call("view()"), self.call("shape(given)", k), self.frame()
        (left, right), (bottom, top) = view["x"], view["y"]
        return [
            (
                box["x"] + (x - left) / (right - left) * view["width"],
                box["y"] + (y - top) / (bottom - top) * view["height"],
            )
            for x, y in zip(shape["x"], shape["y"], strict=True)
        ]

    def frame(self) -> dict[str, float]:
        """Upper left corner of what the axes enclose [CSS pixels]."""
        found: dict[str, float] = self.page.evaluate(
            """() => {
              const frame = Bokeh.index.get_one(Bokeh.documents[0].get_model_by_name("plot")).frame.bbox;
              const box = document.getElementById("plot").getBoundingClientRect();
              return { x: box.x + frame.left, y: box.y + frame.top };
            }"""
        )
        return found


@contextmanager
def browser() -> Iterator[Browser]:
    """Debian's own; no other is fetched."""
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        try:
            yield started
        finally:
            started.close()


@contextmanager
def opened(browser: Browser, path: Path, **settings: Any) -> Iterator[Opened]:
    """The file, ready to play, in a window of its own."""
    context = browser.new_context(offline=True, **({"viewport": {"width": 1200, "height": 800}} | settings))
    try:
        found = Opened(context.new_page())
        found.page.goto(path.resolve().as_uri())
        found.wait("window.cablefmu !== undefined", 60.0)
        found.settled()
        yield found
    finally:
        context.close()
