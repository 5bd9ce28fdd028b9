"""What was once measured is kept for every case that must end, and read back as it was written."""

from __future__ import annotations

import csv
from pathlib import Path

from cablefmu.stress_baseline import Measured, baseline, write_baseline
from cablefmu.stress_grid import grid


def test_every_case_that_ends_has_its_figures_and_no_other() -> None:
    assert list(baseline()) == [case.name for case in grid() if not case.fails]
    shares = [share for found in baseline().values() for share in (found.position, found.energy)]
    assert all(0.0 <= share <= 1.0 for share in shares)
    assert all(found.steps >= 1 for found in baseline().values())


def test_shares_are_written_with_two_digits(tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    write_baseline([("g-a", Measured(1.2345e-3, 0.0, 1234567)), ("g-b", Measured(0.5, 6e-12, 3))], path)
    with path.open(encoding="utf-8", newline="") as file:
        assert list(csv.DictReader(file)) == [
            {"case": "g-a", "position": "1.2e-03", "energy": "0.0e+00", "steps": "1234567"},
            {"case": "g-b", "position": "5.0e-01", "energy": "6.0e-12", "steps": "3"},
        ]
