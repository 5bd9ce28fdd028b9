"""`cablefmu report COUPLING`: measures couplings one after the other, and shows and keeps what was found."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from .coupling.description import load_coupling, shipped_couplings
from .coupling_report import check_coupling_options, make_coupling_report
from .coupling_report_files import write_coupling_report, write_orders
from .coupling_report_tables import coupling_sheets
from .errors import OptionError, RunError
from .files import check_writable
from .plot import need_matplotlib
from .report_command import print_sheet, showing

__all__ = ["names_coupling", "write_coupling_reports"]


def names_coupling(name: str) -> bool:
    """Whether a name is that of a shipped coupling, or of a TOML file with a table [coupling]."""
    if not name.endswith(".toml"):
        return name in shipped_couplings()
    try:
        return "coupling" in tomllib.loads(Path(name).read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return False  # whoever reads it as a scene says what is wrong


def write_coupling_reports(names: Sequence[str], *, accuracy: float | None, limit: float, folder: Path) -> None:
    """Report on couplings; what can be refused is refused before the first is run.

    Raises
    ------
    UserError
        A coupling that is not in order, one named twice, an option out of range, or a place that cannot be written to.
    RunError
        If a coupling has no trusted reference; the others are reported on nevertheless.
    """
    couplings = [load_coupling(name) for name in names]
    for k, coupling in enumerate(couplings):
        if coupling.name in {before.name for before in couplings[:k]}:
            raise OptionError(f"coupling {coupling.name}: it was named before; once is allowed")
    check_coupling_options(accuracy, limit)
    need_matplotlib()
    check_writable(folder / f"{couplings[0].name}.report.html")
    failures, reports = [], []
    for coupling in couplings:
        try:
            with showing(coupling.name) as say:
                report = make_coupling_report(coupling, accuracy=accuracy, limit=limit, say=say)
        except RunError as error:
            failures.append(str(error))
            continue
        reports.append(report)
        written = write_coupling_report(report, folder)
        console = Console()
        console.print(f"\n{coupling.name}: {coupling.spec.coupling.description}", markup=False, highlight=False)
        for sheet in coupling_sheets(report):
            print_sheet(sheet, console)
        print(f"{coupling.name}: {written[-1]}")
    if reports:
        print(f"orders: {write_orders(reports, folder)}")
    if failures:
        raise RunError("\n".join(failures))
