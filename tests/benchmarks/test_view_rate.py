"""The benchmark of the moving page measures what it says."""

from __future__ import annotations

import pytest

from tests.benchmarks import view_rate


@pytest.mark.system
def test_every_page_plays_and_is_small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(view_rate, "SECONDS", 2)
    rows = view_rate.measured()
    assert [(row["runs"], row["window"][:3]) for row in rows] == [(1, "120"), (1, "390"), (2, "120"), (2, "390")]
    assert all(1_000_000 < row["bytes"] < 3_000_000 for row in rows)
    assert all(1.0 < row["least"] <= row["pictures_per_second"] < 130.0 for row in rows)
