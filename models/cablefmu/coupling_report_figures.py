"""Figures of a coupling's report as SVG: error over step and over price; and of several over step, side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .coupling.schema import ALGORITHMS
from .coupling_report import CoupledRow, CouplingReport
from .coupling_report_tables import ORDER_NAMES
from .plot_style import COLORS, style
from .report_figures import log_axes, prepare_log_axes, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

__all__ = ["coupling_figures", "orders_figure"]

_COLORS = dict(zip(ALGORITHMS, (COLORS[1], COLORS[0], COLORS[2]), strict=True))
_STYLES = (":o", "--s", "-^")
"""By the order of inputs."""
_ZERO = 1e-16
"""An error of nothing has no place on a logarithmic axis."""
_STEP, _LATER = "communication step [s]", "position error after start-up [m]"

Number = Callable[[CoupledRow], float]


def coupling_figures(report: CouplingReport) -> list[str]:
    """Every figure as the text of one <svg> element.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    with style():
        over_step, axes = log_axes("Error over communication step", _STEP, _LATER)
        _add_constant(axes, report, _step, _later)
        _finish(axes, report)
        over_price, axes = log_axes("Error over CPU time", "CPU time [s]", "position error [m]")
        _add_constant(axes, report, _cpu_time, _position)
        _add_adaptive(axes, report)
        _finish(axes, report)
        return [svg(figure, f"c{k}-") for k, figure in enumerate((over_step, over_price))]


def orders_figure(reports: Sequence[CouplingReport]) -> str:
    """Error over communication step, one panel a coupling, beside slopes of 1, 2 and 3; the text of one <svg> element.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    with style():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(4.8 * len(reports), 5.0), layout="constrained")
        panels = figure.subplots(1, len(reports), squeeze=False)[0]
        labelled: dict[str, Line2D] = {}
        for axes, report in zip(panels, reports, strict=True):
            prepare_log_axes(axes, report.coupling.name, _STEP, _LATER if axes is panels[0] else "")
            _add_constant(axes, report, _step, _later)
            labelled |= {str(line.get_label()): line for line in axes.get_lines()}
            _add_slopes(axes, report)
        handles, labels = list(labelled.values()), list(labelled)
        figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize="x-small")
        return svg(figure, "o-")


def _step(row: CoupledRow) -> float:
    return row.step


def _cpu_time(row: CoupledRow) -> float:
    return row.cpu_time


def _later(row: CoupledRow) -> float:
    return max(row.later or 0.0, _ZERO)


def _position(row: CoupledRow) -> float:
    return max(row.position or 0.0, _ZERO)


def _add_constant(axes: Axes, report: CouplingReport, across: Number, up: Number) -> None:
    """A line for every algorithm and order of inputs that has a stable step."""
    for algorithm, color in _COLORS.items():
        for extrapolation, marks in enumerate(_STYLES):
            family = [row for row in report.rows if (row.algorithm, row.extrapolation) == (algorithm, extrapolation)]
            points = [(across(row), up(row)) for row in family if row.is_stable and not row.adaptive]
            label = f"{algorithm}, {ORDER_NAMES[extrapolation]}"
            if points:
                name = f"{report.coupling.name}-{algorithm}-{extrapolation}"
                (line,) = axes.plot(*zip(*points, strict=True), marks, color=color, markersize=4, linewidth=1.2)
                line.set(label=label, gid=name)


def _add_adaptive(axes: Axes, report: CouplingReport) -> None:
    for algorithm, color in _COLORS.items():
        rows = [row for row in report.rows if row.algorithm == algorithm and row.adaptive and row.is_stable]
        points = [(row.cpu_time, _position(row)) for row in rows]
        if points:
            axes.plot(*zip(*points, strict=True), "x", color=color, label=f"{algorithm}, adaptive")


def _add_slopes(axes: Axes, report: CouplingReport) -> None:
    """What errors of order 1, 2 and 3 fall like, from above the largest error at the longest step."""
    rows = [row for row in report.rows if row.is_stable and not row.adaptive]
    if not rows:
        return
    steps = np.array([min(map(_step, rows)), max(map(_step, rows))])
    for slope in (1, 2, 3):
        errors = 2.0 * max(map(_later, rows)) * (steps / steps[1]) ** slope
        axes.plot(steps, errors, color="0.6", linewidth=0.8, zorder=0, gid=f"{report.coupling.name}-slope-{slope}")
        axes.annotate(
            f"{slope}", (steps[0], errors[0]), (-3, 0), textcoords="offset points", ha="right", va="center",
            color="0.4", fontsize="small",
        )  # fmt: skip


def _finish(axes: Axes, report: CouplingReport) -> None:
    """The accuracy asked for, and what is what."""
    axes.axhline(report.accuracy, color="black", linewidth=0.8, linestyle=":")
    axes.legend(fontsize="x-small")
