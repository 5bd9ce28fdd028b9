"""A coupling's report as tables of texts, for the terminal and the page alike."""

from __future__ import annotations

from collections.abc import Sequence

from .coupling_report import STARTUP, CoupledRow, CouplingReport
from .report_tables import Sheet

__all__ = ["coupling_setting", "coupling_sheets"]

ORDER_NAMES = ("held", "linear", "quadratic")
"""Inputs inside a step, by their order."""


def coupling_sheets(report: CouplingReport) -> list[Sheet]:
    """What a report says: first the conclusions, then every measurement."""
    found = [_conclusions(report), _families(report), _constant(report)]
    return [*found, _adaptive(report)] if any(row.adaptive for row in report.rows) else found


def coupling_setting(row: CoupledRow | None) -> str:
    """Algorithm, inputs and steps."""
    if row is None:
        return "none of those tried"
    how = f"step {row.step:g} s" if row.adaptive is None else f"adaptive at {row.adaptive:g}"
    return f"{row.algorithm}, inputs {ORDER_NAMES[row.extrapolation]}, {how}"


def _conclusions(report: CouplingReport) -> Sheet:
    truth = report.truth
    rows = [
        ("reference", truth.words),
        ("it is good to", f"{truth.good_to:.2g} m"),
        ("the motion itself", f"{truth.motion:.3g} m"),
        ("setting of the file", _judged(report.own) if report.own else "not among those tried"),
        (f"recommended for {report.accuracy:.3g} m", _judged(report.recommended)),
    ]
    rows += [("refused", text) for text in report.refused]
    return Sheet("What it says", ("", ""), rows)


def _judged(row: CoupledRow | None) -> str:
    if row is None or row.position is None:
        return coupling_setting(row) if row is None else f"{coupling_setting(row)}: {row.note}"
    diverged = "" if row.is_stable else "; " + row.note.partition(":")[0]
    return f"{coupling_setting(row)}: {row.position:.2g} m off{diverged}, {1e3 * row.cpu_time:.3g} ms"


def _families(report: CouplingReport) -> Sheet:
    rows = [
        (
            family.algorithm, ORDER_NAMES[family.extrapolation], _number(family.order, ".2f"),
            _number(family.longest_stable, "g"), _number(family.longest_accurate, "g"), family.note,
        )
        for family in report.families
    ]  # fmt: skip
    head = ("algorithm", "inputs", "order", "stable up to [s]", "accurate up to [s]", "others")
    note = (
        "Order in the step of the error after the start-up; 1, 2, 3 are expected of inputs held, linear, quadratic. "
        "Stable: the run ends, and errs by less than the motion itself, with this step and all shorter ones."
    )
    return Sheet("Orders and largest steps", head, rows, note)


def _number(value: float | None, form: str) -> str:
    return "none" if value is None else format(value, form)


_RESULTS = ("position [m]", "after start-up [m]", "power residual [W]", "CPU [ms]", "steps", "evaluations")


def _constant(report: CouplingReport) -> Sheet:
    rows = [row for row in report.rows if row.adaptive is None]
    texts = [(row.algorithm, ORDER_NAMES[row.extrapolation], f"{row.step:g}", *_results(row)) for row in rows]
    note = (
        "Errors: the largest of all positions at the communication points, over the whole run and after its first "
        f"{100.0 * STARTUP:g} %. Power residual: the largest at the end of a step. CPU time without building the FMUs."
    )
    return Sheet("Constant steps", ("algorithm", "inputs", "step [s]", *_RESULTS), texts, note + _reasons(rows))


def _adaptive(report: CouplingReport) -> Sheet:
    rows = [row for row in report.rows if row.adaptive is not None]
    texts = [(row.algorithm, f"{row.adaptive:g}", f"{row.step:.3g}", *_results(row)) for row in rows]
    head = ("algorithm", "tolerance", "mean step [s]", *_RESULTS)
    return Sheet("Adaptive steps, inputs linear", head, texts, _reasons(rows).strip())


def _results(row: CoupledRow) -> tuple[str, ...]:
    price = (f"{1e3 * row.cpu_time:.3g}", f"{row.steps:,}", f"{row.evaluations:,}")
    if not row.is_stable:
        return (row.note.partition(":")[0], "", "", *(price if row.position is not None else ("", "", "")))
    return (f"{row.position:.2g}", f"{row.later:.2g}", _number(row.residual, ".2g"), *price)


def _reasons(rows: Sequence[CoupledRow]) -> str:
    """Why runs failed: one example of each model's message."""
    failed = [row.note for row in rows if row.position is None]
    return f" {failed[0].rstrip('.')}." if failed else ""
