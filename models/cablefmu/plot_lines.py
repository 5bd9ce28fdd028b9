"""Which variables of a result are drawn as lines: those that were named, or all outputs, in panels of one unit each."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from .cable import Floats
from .errors import OptionError
from .plot_style import new_figure, sequence
from .scene_mistakes import nearest
from .statics_results import is_over_time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Line", "chosen_lines", "panels_of"]


_HEALTH = re.compile(r"(^|\.)(solver|statics)\.")
"""What tells of the solver and of statics, also in a coupled run, where the model's name stands before it."""


@dataclass(frozen=True, slots=True)
class Line:
    """One number over time."""

    name: str
    units: str
    values: Floats
    """shape (times,)"""
    color: Any = None
    """Its place among the elements of an array; None: by the legend."""
    is_named: bool = True
    """Whether the legend has it; of an array it has the first and the last element."""


def chosen_lines(result: xr.Dataset, names: Sequence[str] = ()) -> dict[str, list[Line]]:
    """By unit, in the order of the names: variables, arrays such as theta, elements such as theta[3].

    Without names all numbers over time but arrays and what tells of the solver and of statics.

    Raises
    ------
    OptionError
        If there is no such variable, or none at all.
    """
    every = {str(name): v for name, v in result.data_vars.items() if is_over_time(v)}
    plain = [name for name, v in every.items() if v.ndim == 1 and not _HEALTH.search(name)]
    lines = [line for name in names or plain for line in _lines(result, every, name)]
    if not lines:
        raise OptionError("there are no numbers over time to draw; the scene drops its outputs")
    units = dict.fromkeys(line.units for line in lines)
    return {unit: [line for line in lines if line.units == unit] for unit in units}


def _lines(result: xr.Dataset, every: dict[str, xr.DataArray], name: str) -> list[Line]:
    stem, _, label = name.removesuffix("]").partition("[")
    variable = every.get(name, every.get(stem))
    labels = [] if variable is None or variable.ndim == 1 else result[variable.dims[1]].values.tolist()
    if variable is None or (name not in every and label not in map(str, labels)):
        raise OptionError(f"names {name}: the result has no such variable over time; {nearest(name, list(every))}")
    units = str(variable.attrs.get("units", ""))
    if variable.ndim == 1:
        return [Line(name, units, variable.values)]
    if name not in every:
        return [Line(name, units, variable.values[:, list(map(str, labels)).index(label)])]
    ends = (0, len(labels) - 1)
    return [
        Line(f"{name}[{label}]", units, variable.values[:, k], color, k in ends)
        for k, (label, color) in enumerate(zip(labels, sequence(len(labels)), strict=True))
    ]


def panels_of(groups: dict[str, list[Line]]) -> tuple[Figure, list[Axes]]:
    """A figure with a panel for each unit, below each other."""
    return new_figure(len(groups), 1, size=(8.0, float(np.clip(1.0 + 2.0 * len(groups), 4.0, 30.0))))
