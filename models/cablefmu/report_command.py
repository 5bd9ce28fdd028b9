"""`cablefmu report`: measures scenes one after the other, and shows and keeps what was found."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from .errors import OptionError, RunError
from .files import check_writable
from .plot import need_matplotlib
from .report import ACCURACY, LIMIT, Report, check_options, make_report
from .report_files import write_index, write_markdown, write_report
from .report_ladder import PEERS, Said
from .report_runs import SOLVERS, is_measured
from .report_tables import Sheet, overview, sheets
from .scene import Scene, load_scene, shipped_scenes

__all__ = ["Asked", "print_sheet", "showing", "write_scene_reports"]


@dataclass(frozen=True, slots=True)
class Asked:
    """What the command was given."""

    names: Sequence[str]
    all_: bool
    """All scenes that ship, instead of names"""
    accuracy: float | None
    """[m]; None: `ACCURACY` of a scene, 1 % of the motion of a coupling"""
    limit: float
    """[s]"""
    peers: bool
    markdown: Path | None

    def __str__(self) -> str:
        """As it is typed."""
        words = ["--all"] if self.all_ else list(self.names)
        words += ["--accuracy", f"{self.accuracy:g}"] if self.accuracy not in (None, ACCURACY) else []
        words += ["--limit", f"{self.limit:g}"] if self.limit != LIMIT else []
        words += [] if self.peers else ["--no-peers"]
        words += ["--markdown", str(self.markdown)] if self.markdown is not None else []
        return shlex.join(["cablefmu", "report", *words])


def write_scene_reports(asked: Asked, *, folder: Path) -> None:
    """Report on scenes; what can be refused is refused before the first is run.

    Raises
    ------
    UserError
        No scene, one that is not in order, an option out of range, a place that cannot be written to, or no matplotlib.
    RunError
        If a scene has no trusted reference; the others are reported on nevertheless.
    """
    scenes = _scenes(asked.names, asked.all_)
    accuracy = ACCURACY if asked.accuracy is None else asked.accuracy
    check_options(accuracy, asked.limit)
    need_matplotlib()
    check_writable(folder / f"{scenes[0].name}.report.html")
    if asked.markdown is not None:
        check_writable(asked.markdown)
    solvers = (*SOLVERS, *(PEERS if asked.peers else ()))
    reports, failures = [], []
    for scene in scenes:
        try:
            with showing(scene.name) as say:
                report = make_report(scene, accuracy=accuracy, limit=asked.limit, solvers=solvers, say=say)
        except RunError as error:
            failures.append(str(error))
            continue
        reports.append(report)
        written = write_report(report, folder)
        _print(report, brief=len(scenes) > 1)
        print(f"{scene.name}: {written[-1]}")
    if len(reports) > 1:
        print(f"all: {write_index(reports, folder)}")
        print_sheet(_narrow(overview(reports)), Console())
    if reports and asked.markdown is not None:
        write_markdown(reports, asked.markdown, str(asked))
        print(f"table: {asked.markdown}")
    if failures:
        raise RunError("\n".join(failures))


def _scenes(names: Sequence[str], all_: bool) -> list[Scene]:
    if all_ == bool(names):
        raise OptionError("scenes: names of scenes are expected, or --all for those that ship, and not both")
    scenes = [load_scene(name) for name in (shipped_scenes() if all_ else names)]
    scenes = [scene for scene in scenes if not all_ or is_measured(scene)]
    for k, scene in enumerate(scenes):
        if scene.name in {before.name for before in scenes[:k]}:
            raise OptionError(
                f"scene {scene.name}: it was named before; once is allowed, as its files are named after it"
            )
    return scenes


@contextmanager
def showing(name: str) -> Iterator[Said]:
    """What is being run, at a terminal only."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    with Console(stderr=True).status(name) as status:
        yield lambda text: status.update(f"{name}: {text}")


def _print(report: Report, *, brief: bool) -> None:
    console = Console()
    tables = sheets(report)
    console.print(f"\n{report.scene.name}: {report.scene.description}", markup=False, highlight=False)
    for sheet in tables[:1] if brief else tables:
        print_sheet(sheet, console)


def _narrow(sheet: Sheet) -> Sheet:
    """What fits a terminal: scene, horizon, error and CPU time at the default, recommended setting."""
    rows = [tuple(row[k] for k in (0, 3, 4, 5, 6)) for row in (sheet.head, *sheet.rows)]
    return Sheet(sheet.title, rows[0], rows[1:], sheet.note)


def print_sheet(sheet: Sheet, console: Console) -> None:
    """One table at the terminal."""
    has_head = any(sheet.head)
    table = Table(title=sheet.title, title_justify="left", show_header=has_head, box=SIMPLE, collapse_padding=True)
    for k, name in enumerate(sheet.head):
        table.add_column(name, justify="left" if k == 0 or not has_head else "right", no_wrap=k == 0)
    for row in sheet.rows:
        table.add_row(*row)
    console.print(table, markup=False)
    if sheet.note:
        console.print(sheet.note, markup=False, highlight=False)
