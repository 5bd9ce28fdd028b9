"""`cablefmu doctor`: what is installed, which machines it serves, and whether it works here."""

from __future__ import annotations

from itertools import chain

from rich.console import Console
from rich.table import Table
from rich.text import Text

from .doctor import Finding, examine
from .doctor_check import self_check
from .errors import CableError

__all__ = ["doctor"]


def doctor() -> None:
    """Look at what is installed, which machines FMUs serve, and run a self-check of some seconds.

    Ends with status 1 and a sentence for every failure, if there is one.
    """
    console = Console()
    table = Table(show_header=False, title="cablefmu doctor", title_justify="left")
    table.add_column()
    table.add_column(overflow="fold")  # paths are told whole
    table.add_column()
    failures: list[str] = []
    before = None
    with console.status("looking, then running a few short scenes"):
        for finding in chain(examine(), self_check()):
            if before not in (None, finding.part):
                table.add_section()
            before = finding.part
            table.add_row(Text(finding.what), Text(finding.said), _mark(finding))
            if finding.failure is not None:
                failures.append(finding.failure)
    console.print(table)
    if failures:
        raise CableError("\n".join(failures))
    console.print("everything works")


def _mark(finding: Finding) -> Text:
    if finding.failure is not None:
        return Text("FAILS", style="bold red")
    return Text("-") if finding.is_absent else Text("ok", style="green")
