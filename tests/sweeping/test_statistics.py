"""What a sweep says as a whole, against distributions whose quantiles are known."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablefmu.sweeping.statistics import exceedance, summary_of, write_summary


def table(values: list[float], status: list[str]) -> xr.Dataset:
    result = xr.Dataset(coords={"case": np.arange(1, len(values) + 1)})
    result["status"] = ("case", np.array(status, dtype=object))
    result["M_1"] = ("case", np.arange(len(values), dtype=float))
    result["t.max"] = ("case", np.array(values), {"units": "N"})
    return result


def test_shares_of_evenly_spread_values() -> None:
    """Values k / (N + 1) of a uniform distribution are exceeded by 1 - k / (N + 1) of it, exactly."""
    values = np.arange(1, 100) / 100.0
    ordered, shares = exceedance(np.random.default_rng(1).permutation(values))
    np.testing.assert_array_equal(ordered, values)
    np.testing.assert_allclose(shares, 1.0 - values, atol=1e-15)


def test_a_summary_is_of_the_cases_that_ended() -> None:
    values = [3.0, float("nan"), 1.0, *np.linspace(1.1, 2.9, 100)]
    (found,) = summary_of(table(values, ["ended", "failed", *["ended"] * 101]))
    ended = np.array([v for v in values if v == v])
    assert (found.name, found.unit, found.count) == ("t.max", "N", 102)
    assert (found.smallest, found.largest, found.case) == (1.0, 3.0, 1)
    assert found.mean == pytest.approx(ended.mean())
    assert found.deviation == pytest.approx(ended.std(ddof=1))
    median, tenth, hundredth = found.exceeded
    assert median == pytest.approx(2.0, abs=0.02)
    assert tenth == pytest.approx(np.quantile(ended, 0.9, method="weibull"), rel=1e-12)
    assert hundredth == pytest.approx(np.quantile(ended, 0.99, method="weibull"), rel=1e-12)


def test_of_few_cases_no_rare_value_is_made_up(tmp_path: Path) -> None:
    (found,) = summary_of(table([1.0, 2.0, 4.0], ["ended"] * 3))
    assert found.exceeded == [2.0, None, None]
    (alone,) = summary_of(table([1.0], ["ended"]))
    assert alone.deviation == 0.0
    assert summary_of(table([float("nan")], ["failed"])) == []
    write_summary([found], tmp_path / "s.csv")
    with (tmp_path / "s.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["figure"] == "t.max"
    assert (row["exceeded by 50 %"], row["exceeded by 10 %"], row["largest"], row["in case"]) == ("2.0", "", "4.0", "3")
