"""Figures of a report as SVG, to be put into a page: texts are drawn as paths, and nothing is fetched."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .plot_style import COLORS, new_figure, style
from .report import Report
from .report_ladder import Row
from .report_runs import SOLVERS, Apart

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["figures", "log_axes", "prepare_log_axes", "svg"]

_COLORS = dict(zip(("explicit", "implicit", "automatic", "CVode", "DOP853", "Radau", "LSODA"), COLORS, strict=True))
_ZERO = 1e-16
"""An error of nothing has no place on a logarithmic axis."""


def figures(report: Report) -> list[str]:
    """Every figure as the text of one <svg> element.

    Raises
    ------
    OptionError
        If matplotlib is not installed.
    """
    with style():
        return [svg(figure, f"f{k}-") for k, figure in enumerate(_drawn(report))]


def _drawn(report: Report) -> Iterator[Figure]:
    price = [("CPU time [s]", _cpu_time), ("right-hand sides", _rhs)]
    for label, x in price:
        yield _work_precision(report, label, x, "position error [m]", lambda e: e.position)
    for name, of in _OTHER_ERRORS:
        yield _work_precision(report, "CPU time [s]", _cpu_time, name, of)
    yield _communication(report)
    if report.refinement.steps:
        yield _links(report)
    yield _growth(report)


_OTHER_ERRORS: tuple[tuple[str, Callable[[Apart], float]], ...] = (
    ("pull at the top, relative error", lambda e: e.tension_relative),
    ("energy error [J]", lambda e: e.energy),
)


def _cpu_time(row: Row) -> float:
    return row.cpu_time


def _rhs(row: Row) -> float:
    return float(row.rhs)


def log_axes(title: str, x: str, y: str) -> tuple[Figure, Axes]:
    """A figure with one pair of logarithmic axes."""
    figure, (axes,) = new_figure(size=(6.0, 4.2))
    prepare_log_axes(axes, title, x, y)
    return figure, axes


def prepare_log_axes(axes: Axes, title: str, x: str, y: str) -> None:
    """Logarithmic axes, their names, and what is easily read across."""
    axes.set(xlabel=x, ylabel=y, title=title, xscale="log", yscale="log")
    _plain_ticks(axes)


def _plain_ticks(axes: Axes) -> None:
    """1, 2, 5, 10 across, written out: a decade or two is all there is, and powers of ten would run into each other."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=8))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:,.10g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _work_precision(
    report: Report, x: str, price: Callable[[Row], float], y: str, error: Callable[[Apart], float]
) -> Figure:
    figure, axes = log_axes(
        f"{y.partition(' [')[0]} against {x.partition(' [')[0]}".capitalize().replace("cpu", "CPU"), x, y
    )
    for solver, color in _COLORS.items():
        ended = [(price(row), error(row.error)) for row in report.ladder if row.solver == solver and row.error]
        if not ended:
            continue
        across, up = np.maximum(np.array(ended), _ZERO).T
        style = "-o" if solver in SOLVERS else "--s"
        axes.plot(across, up, style, color=color, markersize=4, linewidth=1.4, label=solver)
    if y.startswith("position"):
        axes.axhline(report.accuracy, color="black", linewidth=0.8, linestyle=":")
        best = report.recommended
        if best is not None and best.error is not None:
            axes.plot(
                price(best), max(best.error.position, _ZERO), "*", color="black", markersize=11, label="recommended"
            )
    axes.legend()
    return figure


def _communication(report: Report) -> Figure:
    figure, axes = log_axes("Communication step (automatic, 1e-6)", "communication step [s]", "position error [m]")
    for inputs, color in (("exact", COLORS[2]), ("held", COLORS[1])):
        ended = [(row.step, row.error.position) for row in report.communication if row.inputs == inputs and row.error]
        if ended:
            across, up = np.maximum(np.array(ended), _ZERO).T
            axes.plot(across, up, "-o", color=color, markersize=4, label=f"inputs {inputs}")
    axes.axhline(report.accuracy, color="black", linewidth=0.8, linestyle=":")
    axes.legend()
    return figure


def _links(report: Report) -> Figure:
    figure, axes = log_axes("The same cable in more links", "links", "error")
    steps = report.refinement.steps
    lines: Sequence[tuple[str, str, list[float]]] = (
        ("position over the cable's length", COLORS[0], [step.position for step in steps]),
        ("largest tension, relative", COLORS[1], [step.tension for step in steps]),
    )
    for label, color, errors in lines:
        axes.plot(
            [step.links for step in steps], np.maximum(errors, _ZERO), "-o", color=color, markersize=4, label=label
        )
    axes.legend()
    return figure


def _growth(report: Report) -> Figure:
    figure, axes = log_axes("Two starts 1e-9 rad apart", "time [s]", "distance [m]")
    axes.set_xscale("linear")  # with ticks of its own
    axes.plot(report.reference.course.times, np.maximum(report.reference.horizon.growth, _ZERO), color=COLORS[0])
    axes.axhline(report.accuracy, color="black", linewidth=0.8, linestyle=":")
    if report.reference.horizon.is_chaotic:
        axes.axvline(report.reference.horizon.time, color=COLORS[1], linewidth=1.0, label="horizon")
        axes.legend()
    return figure


# --- SVG ---


def svg(figure: Figure, prefix: str) -> str:
    """The <svg> element alone, without metadata; its ids are marked so that several go on one page."""
    from matplotlib import rc_context

    text = io.StringIO()
    with rc_context({"svg.fonttype": "path", "svg.hashsalt": prefix}):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    element = text.getvalue()
    element = element[element.index("<svg") :]
    element = re.sub(r"<metadata>.*?</metadata>", "", element, flags=re.DOTALL)
    element = re.sub(r'\bid="', f'id="{prefix}', element)
    element = element.replace('href="#', f'href="#{prefix}').replace("url(#", f"url(#{prefix}")
    return element.strip()
