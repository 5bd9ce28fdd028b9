"""`cablefmu stress`: run the grid of stiff and extreme cases, and say what came of each.

- `stress_grid` the cases, from stress.toml
- `stress_run` one run in a process that may hang or crash
- `stress_accelerations` the FMU's right-hand side beside the dense equation
- `stress_verdict` references, horizon, verdict
- `stress_baseline` what was measured once
- `stress_table` lines for the terminal, CSV, JSON, Markdown
- `stress_page` a page with a heat map
"""

from __future__ import annotations

import difflib
import os
import sys
import tempfile
import threading
import traceback
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .errors import OptionError, RunError
from .files import check_writable
from .stress_baseline import Measured, baseline, write_baseline
from .stress_grid import Case, grid
from .stress_page import write_page
from .stress_run import Worker
from .stress_table import header, line, summary, write_markdown, write_results
from .stress_verdict import Row, judge

__all__ = ["rows_of", "stress"]

FOLDER = Path("build") / "stress"


def stress(
    *,
    only: Annotated[str | None, Parameter(help="Cases whose name matches, for example 'links-*'; or a group.")] = None,
    short: Annotated[bool, Parameter(negative=(), help="The short subset, less than a minute.")] = False,
    show: Annotated[str | None, Parameter(help="Print this case as a scene file, and run nothing.")] = None,
    markdown: Annotated[Path | None, Parameter(help="Write the table of the whole grid, FILE.md.")] = None,
    record: Annotated[
        Path | None, Parameter(help="Write what the whole grid measured, FILE.csv, and compare with nothing measured.")
    ] = None,
    jobs: Annotated[int | None, Parameter(help="Cases at a time; as many as there are cores by default.")] = None,
) -> None:
    """Run stiff and extreme cases, each against references, and say what came of them."""
    if show is not None:
        if only is not None or short or markdown is not None or record is not None:
            raise OptionError("show: it goes with no other option")
        sys.stdout.write(_named(show).text)
        return
    for name, path, suffix in (("markdown", markdown, ".md"), ("record", record, ".csv")):
        if path is not None and (short or only is not None):
            raise OptionError(f"{name}: the table is that of the whole grid; leave --short and --only out")
        if path is not None and path.suffix != suffix:
            raise OptionError(f"{name} = {path}: a name that ends with {suffix} is expected")
    if jobs is not None and not 1 <= jobs <= 256:
        raise OptionError(f"jobs = {jobs}: 1 to 256 are expected")
    cases = _chosen(only, short)
    for path in (FOLDER / "stress.csv", *(file for file in (markdown, record) if file)):
        check_writable(path)
    rows: list[Row] = []
    print(header())
    for row in rows_of(cases, jobs or _cores(), {} if record else baseline()):
        print(line(row), flush=True)
        rows.append(row)
    files = [*write_results(rows, FOLDER), write_page(rows, FOLDER / "stress.html")]
    if markdown is not None:
        write_markdown(rows, markdown)
        files.append(markdown)
    if record is not None:
        ended = [row for row in rows if row.verdict == "within tolerance"]
        write_baseline(
            ((row.case.name, Measured(row.ratio, row.energy, int(row.figures["steps"]))) for row in ended), record
        )
        files.append(record)
    print(summary(rows))
    print("results: " + ", ".join(map(str, files)))
    failed = [row.case.name for row in rows if not row.passed]
    if failed:
        raise RunError(f"{len(failed)} of {len(rows)} cases failed: {', '.join(failed)}")


def rows_of(cases: Sequence[Case], jobs: int, measured: Mapping[str, Measured]) -> Iterator[Row]:
    """Judge cases, so many at a time, each in a process; in the order given, as they come.

    Whatever happens to one of them, the others are run, and it has its row.
    """
    own = threading.local()
    workers: list[Worker] = []

    def one(case: Case) -> Row:
        if not hasattr(own, "worker"):
            own.worker = Worker()
            workers.append(own.worker)
        try:
            return judge(case, own.worker.ask, Path(folder), measured.get(case.name))
        except Exception:
            return Row(case, "crash", traceback.format_exc())

    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder, ThreadPoolExecutor(jobs) as pool:
        try:
            yield from pool.map(one, cases)
        finally:
            pool.shutdown(cancel_futures=True)
            for worker in workers:
                worker.close()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _chosen(only: str | None, short: bool) -> list[Case]:
    cases = [case for case in grid() if case.short or not short]
    if only is None:
        return cases
    chosen = [case for case in cases if fnmatchcase(case.name, only) or case.group == only]
    if not chosen:
        groups = ", ".join(dict.fromkeys(case.group for case in cases))
        raise OptionError(f"only {only}: no case matches; 'links-*' would be a pattern; groups: {groups}")
    return chosen


def _named(name: str) -> Case:
    cases = {case.name: case for case in grid()}
    if name not in cases:
        close = difflib.get_close_matches(name, cases, n=3)
        hint = f"; did you mean {' or '.join(close)}?" if close else "; their names are those in the table"
        raise OptionError(f"show {name}: there is no such case{hint}")
    return cases[name]
