"""Figures of a coupling's report as SVG: error over step and over price."""

from __future__ import annotations

from collections.abc import Callable

from .coupling.schema import ALGORITHMS
from .coupling_report import CoupledRow, CouplingReport
from .coupling_report_tables import ORDER_NAMES
from .plot_style import COLORS, style
from .report_figures import log_axes, svg

__all__ = ["coupling_figures"]

_COLORS = dict(zip(ALGORITHMS, (COLORS[1], COLORS[0], COLORS[2]), strict=True))
_STYLES = (":o", "--s", "-^")
"""By the order of inputs."""
_ZERO = 1e-16
"""An error of nothing has no place on a logarithmic axis."""


def coupling_figures(report: CouplingReport) -> list[str]:
    """Every figure as the text of one <svg> element.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    drawn = [
        ("Error over communication step", "communication step [s]", lambda row: row.step, _later, False),
        ("Error over CPU time", "CPU time [s]", lambda row: row.cpu_time, _position, True),
    ]
    with style():
        return [_figure(report, *about, prefix=f"c{k}-") for k, about in enumerate(drawn)]


def _later(row: CoupledRow) -> float:
    return row.later or 0.0


def _position(row: CoupledRow) -> float:
    return row.position or 0.0


def _figure(
    report: CouplingReport, title: str, x: str, across: Callable[[CoupledRow], float],
    up: Callable[[CoupledRow], float], with_adaptive: bool, *, prefix: str,
) -> str:  # fmt: skip
    figure, axes = log_axes(title, x, "position error after start-up [m]" if up is _later else "position error [m]")
    for algorithm, color in _COLORS.items():
        for extrapolation, marks in enumerate(_STYLES):
            rows = [
                row for row in report.rows if (row.algorithm, row.extrapolation) == (algorithm, extrapolation)
            ]  # fmt: skip
            label = f"{algorithm}, {ORDER_NAMES[extrapolation]}"
            points = [(across(row), max(up(row), _ZERO)) for row in rows if row.is_stable and not row.adaptive]
            if points:
                axes.plot(*zip(*points, strict=True), marks, color=color, markersize=4, linewidth=1.2, label=label)
        rows = [row for row in report.rows if row.algorithm == algorithm and row.adaptive and row.is_stable]
        points = [(across(row), max(up(row), _ZERO)) for row in rows]
        if points and with_adaptive:
            axes.plot(*zip(*points, strict=True), "x", color=color, label=f"{algorithm}, adaptive")
    axes.axhline(report.accuracy, color="black", linewidth=0.8, linestyle=":")
    axes.legend(fontsize="x-small")
    return svg(figure, prefix)
