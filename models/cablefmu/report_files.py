"""What a report leaves behind: JSON, CSV, one page per scene, a table of all scenes."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from .files import replacing
from .report import Report, made_on
from .report_ladder import Row
from .report_page import index_page, page
from .report_runs import Apart
from .report_tables import Sheet, overview

__all__ = ["write_index", "write_markdown", "write_report"]


def write_report(report: Report, folder: Path) -> list[Path]:
    """NAME.report.json, .csv and .html.

    Raises
    ------
    OptionError
        If the folder is not writable, or matplotlib is not installed.
    """
    paths = [folder / f"{report.scene.name}.report.{kind}" for kind in ("json", "csv", "html")]
    _write(paths[0], json.dumps(_data(report), indent=1) + "\n")
    with replacing(paths[1]) as temporary:
        _write_csv(report, temporary)
    _write(paths[2], page(report))
    return paths


def write_index(reports: Sequence[Report], folder: Path) -> Path:
    """index.html, which leads to the page of every report.

    Raises
    ------
    OptionError
        If the folder is not writable.
    """
    path = folder / "index.html"
    _write(path, index_page(overview(reports), [f"{report.scene.name}.report.html" for report in reports]))
    return path


def _write(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _data(report: Report) -> dict[str, Any]:
    reference, best, held = report.reference, report.recommended, report.longest_held
    return {
        "scene": report.scene.name,
        "links": report.scene.cable.n,
        "made_on": made_on(),
        "accuracy_m": report.accuracy,
        "limit_s": report.limit,
        "reference": {
            "tolerance": reference.tolerance,
            "checked_by": reference.checked_by,
            "is_independent": reference.is_independent,
            "difference": asdict(reference.difference),
            "energy_residual_J": reference.course.energy_residual,
        },
        "horizon": {
            "time_s": reference.horizon.time,
            "is_chaotic": reference.horizon.is_chaotic,
            "growth_m": reference.horizon.growth.tolist(),
        },
        "default": asdict(report.default),
        "recommended": asdict(best) if best else None,
        "longest_held": asdict(held) if held else None,
        "ladder": [asdict(row) for row in report.ladder],
        "at_best_step": [asdict(row) for row in report.at_best_step],
        "communication": [asdict(row) for row in report.communication],
        "refinement": asdict(report.refinement),
    }


_PRICE = ("cpu_time", "rhs", "steps", "energy_residual", "note")


def _write_csv(report: Report, path: Path) -> None:
    """One line per run; `part` says of which table, and what has no meaning there is empty."""
    errors = [field.name for field in fields(Apart)]
    head = ["part", "solver", "tolerance", "step", "inputs", "links", *errors, "tension_peak", *_PRICE]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, head, lineterminator="\n", restval="")
        writer.writeheader()
        tables = (
            ("ladder", report.ladder), ("communication", report.communication), ("at_best_step", report.at_best_step)
        )  # fmt: skip
        for part, rows in tables:
            writer.writerows({"part": part, "links": report.scene.cable.n, **_flat(row)} for row in rows)
        length = float(report.scene.cable.links.length.sum())
        writer.writerows(
            {
                "part": "refinement", "links": step.links, "position": step.position * length,
                "tension_peak": step.tension, "cpu_time": step.cpu_time,
            }
            for step in report.refinement.steps
        )  # fmt: skip


def _flat(row: Row) -> dict[str, Any]:
    values = asdict(row)
    error: dict[str, Any] = values.pop("error") or {}
    return error | values


# --- Markdown ---


def write_markdown(reports: Sequence[Report], path: Path, command: str) -> None:
    """The table of all scenes with what it was made by and on.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    accuracy, tolerance = reports[0].accuracy, max(report.reference.tolerance for report in reports)
    text = f"""# How wrong, how fast: all scenes

Made by `{command}`; do not edit.
{made_on()}. What is measured and how: [report](../report.md).

* Errors are the largest of the terminal's and the floater's distance from the reference over all output times up to
  the horizon. The reference is the scene's own FMU at tolerance {tolerance:g}; what it is good to is its distance
  from a dense NumPy model under scipy's DOP853, which shares no code with it. Where that takes more than a minute, the
  FMU's explicit method is compared with its implicit one ("own solver only").
* Default: automatic, 1e-6, the scene's step. Recommended: the cheapest of all that keep {accuracy:g} m. CPU times
  contain what FMPy takes for each communication step, often the larger part.
* Held inputs: the longest communication step that keeps {accuracy:g} m in a host that holds inputs constant over each
  step; "about" where that is shorter than any tried, by the order 1 of the error; "any" where inputs are constant.
* Links: how many the same continuous cable needs for an error of 1 %, 0.1 % and 0.01 % of its length, and of its
  largest tension; "more" where even 240 are not known to be enough.

{_markdown(overview(reports))}
"""
    _write(path, text)


def _markdown(sheet: Sheet) -> str:
    lines = [sheet.head, tuple("---" for _ in sheet.head), *sheet.rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
