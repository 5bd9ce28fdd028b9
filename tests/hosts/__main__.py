"""`python -m tests.hosts [--markdown FILE] [--readme FILE]`: see the package."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.hosts.catalogue import WAYS
from tests.hosts.runs import outcomes
from tests.hosts.table import FAILS, page, readme, row_of, short


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.hosts", description="Run the cable's FMUs in every host.")
    parser.add_argument("--markdown", type=Path, help="write the page with every scene's error here")
    parser.add_argument("--readme", type=Path, help="renew the short table between this file's marks")
    asked = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for way in WAYS:
            print(f"{way.host}, FMI {way.fmi}, {way.interface}", file=sys.stderr)
            rows.append(row_of(way, outcomes(way, Path(name))))
    if asked.markdown:
        asked.markdown.write_text(page(rows), "utf-8")
    if asked.readme:
        asked.readme.write_text(readme(asked.readme.read_text("utf-8"), rows), "utf-8")
    print(short(rows))
    return int(any(row.result.startswith(FAILS) for row in rows))


if __name__ == "__main__":
    sys.exit(main())
