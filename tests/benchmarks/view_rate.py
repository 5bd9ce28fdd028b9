"""`python -m tests.benchmarks.view_rate`: pictures in a second of a page that plays, by its own counter.

110 links and 620 moments in Debian's Chromium without a head, which has no graphics processor: a browser with one does
more. Prints JSON; the aim is 30.
"""

from __future__ import annotations

import json
import statistics
import tempfile
from pathlib import Path
from typing import Any

from cablefmu.view import Motion, write_page
from tests.view.chromium import PHONE, browser, opened
from tests.view.made import made_motion

__all__ = ["measured"]

LINKS, MOMENTS = 110, 620
SECONDS = 6
"""Of playing; the counter is read once in each, of the second before."""

_PLAY = """async (seconds) => {
  const rates = [];
  cablefmu.play();
  for (let k = 0; k < seconds; k++) {
    await new Promise((done) => setTimeout(done, 1000));
    rates.push(cablefmu.rate());
  }
  cablefmu.pause();
  return rates;
}"""


def measured() -> list[dict[str, Any]]:
    """A row for one run and for two in one picture, in a window and on a phone: size of the page [B], pictures/s."""
    rows = []
    with tempfile.TemporaryDirectory() as folder, browser() as chromium:
        for runs in (1, 2):
            page = Path(folder) / f"{runs}.html"
            write_page([_motion(f"run {k}", 0.4 * k) for k in range(runs)], page)
            for where, settings in (("1200 x 800", {}), ("390 x 844, two pixels each", PHONE)):
                with opened(chromium, page, **settings) as found:
                    rates = found.page.evaluate(_PLAY, SECONDS)
                rows.append({
                    "runs": runs, "window": where, "bytes": page.stat().st_size,
                    "pictures_per_second": statistics.median(rates), "least": min(rates),
                })  # fmt: skip
    return rows


def _motion(name: str, lag: float) -> Motion:
    return made_motion(name, links=LINKS, times=MOMENTS, step=0.025, length=240.0, lag=lag)


if __name__ == "__main__":
    print(json.dumps({"links": LINKS, "moments": MOMENTS, "pages": measured()}, indent=1))
