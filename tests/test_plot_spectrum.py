"""Spectra of numbers whose spectra are known, and what their picture shows."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from cablefmu.errors import OptionError
from cablefmu.plot_spectrum import draw_spectrum, spectrum
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene

TIMES = np.arange(0.0, 200.0, 0.1)


def test_a_sine_has_its_power_at_its_frequency() -> None:
    """Half the square of its amplitude, within Hann's four bins; the mean has no part in it."""
    frequency, density = spectrum(TIMES, 7.0 + 3.0 * np.sin(2.0 * np.pi * 0.8 * TIMES))
    assert frequency[np.argmax(density)] == pytest.approx(0.8, abs=0.01)
    near = np.abs(frequency - 0.8) < 0.025
    assert density[near].sum() * frequency[1] == pytest.approx(4.5, rel=1e-3)
    assert density[~near].sum() * frequency[1] < 1e-3


def test_white_noise_is_flat_at_its_variance() -> None:
    """Over 0 to 5 Hz a density of variance / 5 Hz; three segments scatter, a thousand frequencies even that out."""
    noise = np.random.default_rng(3).normal(scale=2.0, size=len(TIMES))
    frequency, density = spectrum(TIMES, noise)
    assert frequency[-1] == pytest.approx(5.0)
    assert density[1:].mean() == pytest.approx(4.0 / 5.0, rel=0.1)


def test_a_short_last_interval_is_left_out() -> None:
    values = np.sin(TIMES)
    whole = spectrum(TIMES, values)
    longer = spectrum(np.append(TIMES, TIMES[-1] + 0.03), np.append(values, 1e6))
    np.testing.assert_array_equal(whole, longer)


def test_what_has_no_spectrum() -> None:
    with pytest.raises(OptionError, match="needs 16 output times or more, and there are 15"):
        spectrum(TIMES[:15], TIMES[:15])
    uneven = np.delete(TIMES, 7)
    with pytest.raises(OptionError, match="at regular intervals, and these are not"):
        spectrum(uneven, uneven)


def test_its_picture() -> None:
    result = simulate(small_scene("load"), stop_time=4.0)
    figure = draw_spectrum(result, ["x_c", "solver.stiff", "y_c", "vx_c"])
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["position [m^2/Hz]", "solver.stiff [1/Hz]", "vx_c [(m/s)^2/Hz]"]
    assert figure.axes[-1].get_xlabel() == "frequency [Hz]"
    assert [axes.get_yscale() for axes in figure.axes] == ["log", "linear", "log"], "what never moves has no logarithm"
    assert [line.get_label() for axes in figure.axes for line in axes.lines] == [
        "x_c", "y_c", "solver.stiff (constant)", "vx_c",
    ]  # fmt: skip
    frequency, density = spectrum(result["time"].values, result["y_c"].values)
    np.testing.assert_array_equal(figure.axes[0].lines[1].get_xydata(), np.column_stack([frequency, density])[1:])
    assert figure.get_suptitle() == "load: power spectral density (Welch, Hann, halves of the record)"


def test_arrays_and_other_runs_have_one_as_well() -> None:
    """Names with a dot, as those of coupled runs; a line for each link."""
    time = TIMES[:64]
    waves = np.sin(np.outer(time, [1.0, 2.0, 3.0]))
    values = {
        "hull.y_1": ("time", waves[:, 0], {"units": "m"}),
        "theta": (("time", "link"), waves, {"units": "rad"}),
    }
    result = xr.Dataset(values, {"time": time, "link": [1, 2, 3]}, {"title": "both"})
    figure = draw_spectrum(result, ["hull.y_1", "theta"])
    assert [axes.get_ylabel() for axes in figure.axes] == ["hull.y_1 [m^2/Hz]", "angle [rad^2/Hz]"]
    assert len(figure.axes[1].lines) == 3
