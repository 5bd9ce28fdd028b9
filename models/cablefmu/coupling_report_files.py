"""What a coupling's report leaves behind: JSON, CSV and a page."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from .coupling_report import CoupledRow, CouplingReport
from .coupling_report_figures import coupling_figures, orders_figure
from .coupling_report_tables import coupling_sheets
from .files import replacing
from .report import made_on
from .report_page import page_of

__all__ = ["write_coupling_report", "write_orders"]


def write_coupling_report(report: CouplingReport, folder: Path) -> list[Path]:
    """NAME.report.json, .csv and .html.

    Raises
    ------
    OptionError
        If the folder is not writable, or matplotlib is not installed.
    """
    coupling = report.coupling
    paths = [folder / f"{coupling.name}.report.{kind}" for kind in ("json", "csv", "html")]
    drawn = coupling_figures(report)
    page = page_of(coupling.name, coupling.spec.coupling.description, coupling_sheets(report), drawn)
    for path, text in ((paths[0], json.dumps(_data(report), indent=1) + "\n"), (paths[2], page)):
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
    with replacing(paths[1]) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(CoupledRow)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(row) for row in report.rows)
    return paths


def write_orders(reports: Sequence[CouplingReport], folder: Path) -> Path:
    """coupling-orders.svg: the errors of several couplings over their steps; the same file for the same numbers.

    Raises
    ------
    OptionError
        If the folder is not writable, or matplotlib is not installed.
    """
    path = folder / "coupling-orders.svg"
    with replacing(path) as temporary:
        temporary.write_text(orders_figure(reports) + "\n", encoding="utf-8")
    return path


def _data(report: CouplingReport) -> dict[str, Any]:
    truth, own, best = report.truth, report.own, report.recommended
    return {
        "coupling": report.coupling.name,
        "made_on": made_on(),
        "accuracy_m": report.accuracy,
        "limit_s": report.limit,
        "reference": {
            "what": truth.words, "is_whole": truth.is_whole, "good_to_m": truth.good_to, "motion_m": truth.motion
        },
        "own": asdict(own) if own else None,
        "recommended": asdict(best) if best else None,
        "families": [asdict(family) for family in report.families],
        "rows": [asdict(row) for row in report.rows],
        "refused": list(report.refused),
    }  # fmt: skip
