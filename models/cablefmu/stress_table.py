"""What a run of the stress grid leaves in words and numbers: lines for the terminal, CSV, JSON, Markdown."""

from __future__ import annotations

import csv
import json
import math
import os
import platform
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import version
from itertools import groupby
from pathlib import Path

from . import __version__
from .files import replacing
from .stress_accelerations import MOST_LINKS, SPOTS
from .stress_accelerations import MULTIPLE as SPOT_MULTIPLE
from .stress_verdict import (
    ANYTHING,
    DENSE_LINKS,
    ENERGY,
    FEW,
    LONGER,
    LOOSEST,
    MULTIPLE,
    NUDGE,
    PARTING,
    TIGHTER,
    TIGHTEST,
    WORSE,
    Row,
)

__all__ = ["COLUMNS", "explained", "header", "line", "made_with", "plain", "summary", "write_markdown", "write_results"]


def _figure(name: str, row: Row) -> float:
    """One of the solver's figures; NaN where it has none."""
    return row.figures.get(name, math.nan)


_LETTERS = {"explicit": "E", "implicit": "I", "dense": "D", "explicit at a tenth": "E'", "implicit at a tenth": "I'"}

COLUMNS: tuple[tuple[str, Callable[[Row], object]], ...] = (
    ("case", lambda row: row.case.name),
    ("group", lambda row: row.case.group),
    ("base", lambda row: row.case.base),
    ("changed", lambda row: row.case.changed),
    ("fmi", lambda row: row.case.fmi),
    ("n", lambda row: row.n),
    ("tolerance", lambda row: row.tolerance),
    ("stop_time", lambda row: row.stop_time),
    ("verdict", lambda row: row.verdict),
    ("solver", lambda row: row.solver),
    *((name, partial(_figure, name)) for name in ("steps", "rejected", "rhs", "jacobians", "energy_residual")),
    ("seconds", lambda row: row.seconds),
    ("error", lambda row: row.error),
    ("ratio", lambda row: row.ratio),
    ("energy", lambda row: row.energy),
    ("accelerations", lambda row: row.accelerations),
    ("worse", lambda row: row.worse),
    ("longer", lambda row: row.longer),
    ("growth", lambda row: row.growth),
    ("spread", lambda row: row.spread),
    ("horizon", lambda row: row.horizon),
    ("references", lambda row: row.references),
    ("message", lambda row: row.message),
    ("reason", lambda row: row.case.fails),
)  # fmt: skip


# ------------------------------------------------------------------------------------------------- terminal


def header() -> str:
    """Above the lines."""
    return (
        f"{'case':<34}{'n':>6}{'tol.':>7} {'solver':<9}{'steps':>8}{'time [s]':>10}{'error [m]':>11}"
        f"{'of allowed':>12}  verdict"
    )


def line(row: Row) -> str:
    """One case."""
    numbers = (
        f"{plain(row.tolerance, '.0e'):>7} {row.solver:<9}{plain(row.figures.get('steps', math.nan), ',.0f'):>8}"
        f"{plain(row.seconds, '.3g'):>10}{plain(row.error, '.1e'):>11}{plain(row.ratio, '.2g'):>12}"
    )
    return f"{row.case.name:<34}{row.n or '':>6}{numbers}  {row.verdict}{_until(row)}" + (
        f": {row.message}" if row.message else ""
    )


def summary(rows: Sequence[Row]) -> str:
    """How many of each verdict."""
    counts = Counter(row.verdict for row in rows).most_common()
    return f"{len(rows)} case{'s'[: len(rows) > 1]}: " + ", ".join(f"{count} {verdict}" for verdict, count in counts)


def plain(value: float, form: str) -> str:
    return "" if math.isnan(value) else format(value, form)


def _until(row: Row) -> str:
    return f" up to {row.horizon:.3g} s" if row.horizon < row.stop_time * (1.0 - 1e-9) else ""


# --------------------------------------------------------------------------------------------------- files


def write_results(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write stress.csv and stress.json into a folder.

    Raises
    ------
    OptionError
        If a file cannot be written.
    """
    files = [folder / "stress.csv", folder / "stress.json"]
    with replacing(files[0]) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([name for name, _ in COLUMNS])
        writer.writerows([value(row) for _, value in COLUMNS] for row in rows)
    with replacing(files[1]) as temporary:
        cases = [{name: _finite(value(row)) for name, value in COLUMNS} for row in rows]
        text = json.dumps({"made": made_with(), "cases": cases}, indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    return files


def _finite(value: object) -> object:
    """JSON knows no NaN."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def made_with() -> str:
    """Versions and machine."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("fmpy", "numpy", "scipy"))
    return (
        f"cablefmu {__version__}, {packages}, Python {platform.python_version()}; {_processor()}, "
        f"{os.cpu_count()} cores, {platform.system()}"
    )


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.exists():
        for text in information.read_text(encoding="utf-8", errors="replace").splitlines():
            if text.startswith("model name"):
                return " ".join(text.partition(":")[2].split())
    return platform.machine()


def explained() -> list[str]:
    return [
        "Every case is an FMU, run through FMPy by its own solver as the case has it: the automatic choice. References"
        f" are its explicit and its implicit method at a tolerance {TIGHTER:g} times tighter (between {TIGHTEST:g} and"
        f" {LOOSEST:g}) and, up to {DENSE_LINKS} links, the dense matrices of the dissertation under scipy's DOP853 or"
        " Radau: E, I, D in the table. One that takes too long is left out; if only one remains, it is run once more at"
        " a tenth of its tolerance, E' or I'.",
        "The error is the largest distance of any joint of the cable from where the farthest of the references has it."
        f" Allowed are {MULTIPLE:g} r S K: r the tolerance; S the cable's length, or how far from the origin it gets;"
        " K, at least 1, by how much the motion lets a small disturbance grow, whenever it enters (measured by two"
        f" starts whose angles differ by {NUDGE:g} rad); and {MULTIPLE:g} for the errors of many steps. Where the two"
        f" starts are {PARTING:g} times as far apart as they were, or r K passes {ANYTHING:g}, the motion is chaotic:"
        " it is compared up to there, and the verdict names that time.",
        "Explicit and implicit method share the kernel's right-hand side. So, up to"
        f" {MOST_LINKS} links, the FMU's accelerations at {SPOTS} states of the motion are compared with those of the"
        f" dense matrices in long doubles: allowed are {SPOT_MULTIPLE:g} times what rounding does to the state and to"
        " the forces on a link. And the energy balance E(t) - E(0) = work - losses, which needs no reference, may be"
        f" off by {ENERGY:g} r^0.8 F D at the end: F the largest force, D the farthest way of any joint.",
        "Most use a thousandth of all that. What each case was once measured to use is kept. One that uses"
        f" {WORSE:g} times as much, or that much more than references can tell apart, has failed as well (times once is"
        f" 1 where nothing has changed), and so has one that takes {LONGER:g} times the steps and {FEW} more.",
    ]


# ---------------------------------------------------------------------------------------------------- Markdown


def write_markdown(rows: Sequence[Row], path: Path) -> None:
    """Write the table of all cases.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    lines = [
        "# Stiff and extreme cases", "",
        "Made by `cablefmu stress --markdown docs/stress/README.md`.",
        "`cablefmu stress --show GROUP-CASE` prints a case as a scene file.", "",
        f"{made_with()}.", "", f"**{summary(rows)}.**", "", *(f"{text}\n" for text in explained()),
    ]  # fmt: skip
    for group, members in groupby(rows, lambda row: row.case.group):
        lines += [
            f"## {group}", "",
            "| case | scene | FMI | n | r | solver | steps | time [s] | error [m] | of allowed | energy "
            "| accelerations | times once | by | verdict |",
            "|---" * 15 + "|", *(_markdown(row) for row in members), "",
        ]  # fmt: skip
    with replacing(path) as temporary:
        temporary.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


def _markdown(row: Row) -> str:
    cells = [
        row.case.name.removeprefix(f"{row.case.group}-"),
        f"{row.case.base}" + (f": {row.case.changed}" if row.case.changed else ""),
        str(row.case.fmi), str(row.n or ""), plain(row.tolerance, ".0e"), row.solver,
        plain(row.figures.get("steps", math.nan), ",.0f"), plain(row.seconds, ".3g"), plain(row.error, ".1e"),
        plain(row.ratio, ".2g"), plain(row.energy, ".1e"), plain(row.accelerations, ".1e"), plain(row.worse, ".2g"),
        " ".join(_LETTERS[name] for name in row.references.split(", ") if name),
        row.verdict + _until(row) + (f": {row.message}" if row.message else "")
        + (f" ({row.case.fails})" if row.case.fails else ""),
    ]  # fmt: skip
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
