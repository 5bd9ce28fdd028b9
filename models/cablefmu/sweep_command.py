"""`cablefmu sweep`: many runs, from a file or from options, and what they say as a whole."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Literal

import xarray as xr
from cyclopts import Parameter
from rich.box import SIMPLE
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from .coupling_report_command import names_coupling
from .errors import OptionError, RunError
from .files import check_writable
from .plot import need_matplotlib
from .sweeping.api import Crew, default_folder, needs, open_sweep
from .sweeping.description import Sweep, is_sweep_file, make_sweep, read_tables
from .sweeping.statistics import LEVELS, Summary, summary_of

__all__ = ["sweep"]

Names = Parameter(consume_multiple=True)


def sweep(
    *names: Annotated[str, Parameter(help="A sweep file; or scenes, scene files, FMUs; or a coupling.")],
    set_: Annotated[
        list[str] | None, Parameter(name="--set", consume_multiple=True, help="NAME=VALUE in every case.")
    ] = None,
    grid: Annotated[
        list[str] | None,
        Parameter(consume_multiple=True, help="NAME=VALUE,VALUE,...: every combination is a case."),
    ] = None,
    list_: Annotated[
        Path | None, Parameter(name="--list", help="Cases one by one, FILE.csv; its first line names what is set.")
    ] = None,
    sample: Annotated[
        list[str] | None,
        Parameter(consume_multiple=True, help="NAME=LOW:HIGH: --count points of a Latin hypercube in these ranges."),
    ] = None,
    count: Annotated[int | None, Parameter(help="Points of the sample.")] = None,
    seed: Annotated[int | None, Parameter(help="Of the sample; 0 by default.")] = None,
    stop_time: Annotated[float | None, Parameter(help="[s]; the scene's by default.")] = None,
    step: Annotated[float | None, Parameter(help="Output interval [s]; the scene's by default.")] = None,
    tolerance: Annotated[float | None, Parameter(help="Relative tolerance; the scene's by default.")] = None,
    interface: Annotated[Literal["cs", "me"] | None, Parameter(help="Co-Simulation by default.")] = None,
    fmi: Annotated[Literal[2, 3] | None, Parameter(help="Version of FMI; 2 by default.")] = None,
    slope: Annotated[float | None, Parameter(help="m of the S-N curve that tensions are counted for; 3.")] = None,
    workers: Annotated[
        int | None, Parameter(help="Processes on this machine, one a core by default; 0: none but this one.")
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Address of a Dask scheduler, whose workers are used instead: tcp://HOST:8786.")
    ] = None,
    wait: Annotated[float, Parameter(help="Seconds to wait for workers that are not there.")] = 30.0,
    keep_series: Annotated[
        bool, Parameter(negative=(), help="Keep the outputs of every case over time as well.")
    ] = False,
    restart: Annotated[bool, Parameter(negative=(), help="Begin anew, whatever is finished already.")] = False,
    plot: Annotated[
        Path | None, Parameter(help="Picture of how --of is spread, and of what it depends on, FILE.png.")
    ] = None,
    of: Annotated[str | None, Parameter(help="Figure to draw; tension_max.max by default.")] = None,
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], help="Folder of results; ./build/NAME.sweep by default."),
    ] = None,
) -> None:
    """Run many cases; what is finished is kept, and the same command goes on where it was interrupted."""
    run = {"stop_time": stop_time, "step": step, "tolerance": tolerance, "interface": interface, "fmi": fmi}
    sampled = {"count": count, "seed": seed, "ranges": dict(map(_range, sample)) if sample else None}
    options = {
        "set": dict(map(_assignment, set_)) if set_ else None,
        "grid": dict(map(_values, grid)) if grid else None,
        "list": {"file": str(list_.resolve())} if list_ else None,
        "sample": _given(sampled) or None,
        "run": _given(run) or None,
        "statistics": _given({"slope": slope}) or None,
    }
    for option, values in (("set", set_), ("grid", grid), ("sample", sample)):
        if values == []:
            raise OptionError(f"{option}: at least one value is expected behind it")
    asked = _asked(names, _given(options))
    folder = output or default_folder(asked)
    if plot is not None:
        need_matplotlib()
        check_writable(plot)
    elif of is not None:
        raise OptionError(f"of = {of}: it names what --plot FILE.png draws, which is expected")
    run_sweep = needs("run").run_sweep
    with _showing(asked.name) as progress:
        files = run_sweep(
            asked, folder, Crew(workers, scheduler, wait), keep_series=keep_series, restart=restart, progress=progress
        )
    result = open_sweep(folder)
    if plot is not None:
        needs("picture").plot_sweep(result, plot, of)
        files = [*files, plot]
    failed = result["reason"].values[result["status"].values != "ended"]
    _print(summary_of(result), result, Console())
    print("results: " + ", ".join(map(str, files)))
    if len(failed):
        raise RunError(f"{len(failed)} of {result.sizes['case']} cases failed, the first because: {failed[0]}")


def _asked(names: Sequence[str], options: dict[str, Any]) -> Sweep:
    """The file with what options say in its place, or options alone."""
    files = [name for name in names if is_sweep_file(name)]
    if files and len(names) > 1:
        raise OptionError(f"{files[0]}: a sweep file says itself what is run; leave the others out")
    if files:
        path = Path(files[0])
        return make_sweep(_over(read_tables(path), options), name=path.stem, folder=path.parent, source=str(path))
    coupled = [name for name in names if names_coupling(name)]
    if coupled and len(names) > 1:
        raise OptionError(f"{coupled[0]}: a sweep of a coupling is of one alone; leave the others out")
    if not names:
        raise OptionError("a sweep file is expected, or scenes with --grid, --list or --sample")
    what = {"coupling": coupled[0]} if coupled else {"scenes": list(names)}
    return make_sweep({**what, **options}, name=Path(names[0]).stem, source="sweep")


def _over(tables: dict[str, Any], options: dict[str, Any]) -> dict[str, Any]:
    """An option takes the place of what the file has of the same name; a grid, list or sample that of the file's."""
    whole = ("grid", "list")
    return tables | {
        key: {**tables[key], **value} if key not in whole and isinstance(tables.get(key), dict) else value
        for key, value in options.items()
    }


def _given(options: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in options.items() if value is not None}


def _assignment(text: str) -> tuple[str, float | str]:
    name, equals, word = text.partition("=")
    if not (equals and name and word):
        raise OptionError(f"{text}: NAME=VALUE is expected, in SI units, for example M_1=6000")
    return name, _number_or_word(word)


def _values(text: str) -> tuple[str, list[float | str]]:
    name, equals, words = text.partition("=")
    parts = words.split(",") if words else []
    if not (equals and name and parts and all(parts)):
        raise OptionError(f"grid {text}: NAME=VALUE,VALUE,... is expected, for example M_1=4000,6000,8000")
    return name, [_number_or_word(word) for word in parts]


def _range(text: str) -> tuple[str, list[float | str]]:
    name, equals, words = text.partition("=")
    low, colon, high = words.partition(":")
    if not (equals and name and colon and low and high):
        raise OptionError(f"sample {text}: NAME=LOW:HIGH is expected, for example M_1=4000:8000")
    return name, [_number_or_word(low), _number_or_word(high)]


def _number_or_word(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word


@contextmanager
def _showing(name: str) -> Iterator[Callable[[int, int, int], None] | None]:
    """A bar with what is left, at a terminal; lines now and then where there is none."""
    if not sys.stderr.isatty():
        yield _telling(name)
        return
    columns = (
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[failed]}"),
        TimeRemainingColumn(elapsed_when_finished=True),
    )  # fmt: skip
    with Progress(*columns, console=Console(stderr=True), transient=True, refresh_per_second=4) as bar:
        task = bar.add_task(name, total=None, failed="")

        def update(done: int, failed: int, total: int) -> None:
            bar.update(task, completed=done, total=total, failed=f"{failed} failed" if failed else "")

        yield update


_PAUSE = 30.0
"""Between two lines [s]"""


def _telling(name: str) -> Callable[[int, int, int], None]:
    """Says how far it is where a log is written: at the start if something is finished, then every half minute."""
    begun, said, before = time.monotonic(), time.monotonic(), -1

    def update(done: int, failed: int, total: int) -> None:
        nonlocal said, before, begun
        now = time.monotonic()
        if before < 0:
            begun, before = now, done
            if done:
                print(f"{name}: {done} of {total} cases are finished already", file=sys.stderr)
        elif now - said > _PAUSE and done > before:
            left = (now - begun) / (done - before) * (total - done)
            said = now
            print(f"{name}: {done} of {total} cases, {failed} failed, {left:.0f} s left", file=sys.stderr)

    return update


def _print(summaries: Sequence[Summary], result: xr.Dataset, console: Console) -> None:
    """Largest values and what tires, which one looks at first; the rest is in summary.csv."""
    shown = [s for s in summaries if s.name.endswith((".max", ".equivalent"))]
    title = f"{result.attrs['title']}: {result.sizes['case']} cases"
    table = Table(title=title, title_justify="left", box=SIMPLE)
    for k, head in enumerate(("figure", "mean", "1 in 10", "largest", "case")):
        table.add_column(head, justify="right" if k else "left", no_wrap=True)
    for s in shown:
        exceeded = s.exceeded[LEVELS.index(0.1)]
        numbers = [s.mean, exceeded, s.largest]
        texts = ["-" if value is None else f"{value:.4g}" for value in numbers]
        table.add_row(f"{s.name} [{s.unit}]" if s.unit else s.name, *texts, str(s.case))
    console.print(table, markup=False)
