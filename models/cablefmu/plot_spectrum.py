"""Power spectral densities of numbers over time, by Welch's method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .cable import Floats
from .errors import OptionError
from .plot_lines import chosen_lines, panels_of
from .plot_style import entitle, labelled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_spectrum", "spectrum"]

_LEAST = 16
"""Output times below which there is no spectrum to speak of."""

_REGULAR = 1e-6
"""Relative: intervals that differ by less are one."""


def spectrum(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """One-sided power spectral density of a number over time, its mean taken away.

    Welch's method [P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967)]: Hann windows on halves of the record,
    which overlap by half, averaged.

    Parameters
    ----------
    times, values
        At regular times [s], shape (times,); the last interval may be shorter, as a run's is.

    Returns
    -------
    frequency, density
        [Hz] and [unit^2/Hz]; the density's integral over the frequency is the variance.

    Raises
    ------
    OptionError
        If there are too few times, or they are not regular.
    """
    from scipy.signal import welch  # slow to import, and few need it

    step = np.diff(times)
    if len(step) > 1 and step[-1] < step[0] * (1.0 - _REGULAR):
        times, values, step = times[:-1], values[:-1], step[:-1]
    if len(times) < _LEAST:
        raise OptionError(f"a spectrum needs {_LEAST} output times or more, and there are {len(times)}")
    if np.ptp(step) > _REGULAR * step[0]:
        raise OptionError("a spectrum needs output times at regular intervals, and these are not")
    frequency, density = welch(values, fs=1.0 / float(np.mean(step)), nperseg=len(values) // 2, detrend="constant")
    return frequency, density


def draw_spectrum(result: xr.Dataset, names: Sequence[str] = ()) -> Figure:
    """Draw spectra of variables; arguments and errors as for `chosen_lines` and `spectrum`."""
    groups = chosen_lines(result, names)
    figure, panels = panels_of(groups)
    times = result["time"].values
    for axes, (units, lines) in zip(panels, groups.items(), strict=True):
        for line in lines:
            frequency, density = spectrum(times, line.values)
            moves = np.ptp(line.values) > 0.0
            label = line.name if moves else f"{line.name} (constant)"
            more = {} if line.color is None else {"color": line.color}
            # at 0 Hz there is but what is left of the mean; what never moves has no place on this axis
            shown = density[1:] if moves else np.full(len(density) - 1, np.nan)
            axes.plot(frequency[1:], shown, label=label if line.is_named else f"_{label}", **more)
        what = labelled(units, [line.name for line in lines]).partition(" [")[0]
        axes.set_ylabel(f"{what} [{_squared(units)}/Hz]")
        if any(np.ptp(line.values) > 0.0 for line in lines):
            axes.set_yscale("log")
        axes.legend(loc="best")
    panels[-1].set_xlabel("frequency [Hz]")
    entitle(figure, result, "power spectral density (Welch, Hann, halves of the record)")
    return figure


def _squared(units: str) -> str:
    if units in ("", "1"):
        return "1"
    return f"{units}^2" if units.isalpha() else f"({units})^2"
