"""What the picture of a sweep shows: values, labels, units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablefmu.errors import OptionError
from cablefmu.sweeping.picture import draw_sweep, plot_sweep

COUNT = 40


@pytest.fixture
def result() -> xr.Dataset:
    rng = np.random.default_rng(3)
    made = xr.Dataset(coords={"case": np.arange(1, COUNT + 1)}, attrs={"title": "masses", "varied": "M_1 solver Cd"})
    made["scene"] = ("case", np.array(["a", "b"] * (COUNT // 2), dtype=object))
    made["status"] = ("case", np.array(["failed"] + ["ended"] * (COUNT - 1), dtype=object))
    made["M_1"], made["Cd"] = ("case", rng.random(COUNT)), ("case", rng.random(COUNT))
    made["solver"] = ("case", np.array(["explicit"] * COUNT, dtype=object))
    made["x_c.max"] = ("case", rng.random(COUNT), {"units": "m"})
    made["tension_max.max"] = ("case", np.where(np.arange(COUNT) == 0, np.nan, rng.random(COUNT)), {"units": "N"})
    return made


def test_histogram_exceedance_and_scatter(result: xr.Dataset) -> None:
    figure = draw_sweep(result)
    histogram, beyond, by_mass, by_drag = figure.axes
    values = np.sort(result["tension_max.max"].values[1:])
    assert sum(bar.get_height() for bar in histogram.patches) == COUNT - 1
    assert histogram.get_xlabel() == "tension_max.max [N]"
    np.testing.assert_array_equal(beyond.lines[0].get_xdata(), values)
    np.testing.assert_allclose(beyond.lines[0].get_ydata(), 1.0 - np.arange(1, COUNT) / COUNT)
    assert beyond.get_yscale() == "log"
    assert [axes.get_xlabel() for axes in (by_mass, by_drag)] == ["M_1", "Cd"]
    first = by_mass.lines[0]
    np.testing.assert_array_equal(first.get_xdata(), result["M_1"].values[::2])
    np.testing.assert_array_equal(first.get_ydata(), result["tension_max.max"].values[::2])
    assert [text.get_text() for text in by_mass.get_legend().get_texts()] == ["a", "b"]
    assert figure.get_suptitle() == "masses: 39 cases, 1 failed"


def test_another_figure_and_what_there_is_not(result: xr.Dataset, tmp_path: Path) -> None:
    assert draw_sweep(result, "x_c.max").axes[0].get_xlabel() == "x_c.max [m]"
    with pytest.raises(OptionError, match=r"of = x_c: there is no such figure; .* allowed: x_c\.max, tension_max\.max"):
        draw_sweep(result, "x_c")
    plot_sweep(result, tmp_path / "p.svg")
    assert (tmp_path / "p.svg").read_text().count('<g id="axes_') == 4
    result["status"].values[:] = "failed"
    with pytest.raises(OptionError, match="no case ended"):
        draw_sweep(result)
