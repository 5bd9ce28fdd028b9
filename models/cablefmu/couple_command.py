"""`cablefmu couple`: runs a coupling, or writes it for another engine, and shows what was found."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table

from .coupling.description import load_coupling
from .coupling.engines import ENGINES, run_with
from .coupling.export_osp import write_osp
from .coupling.export_ssp import write_ssp
from .coupling.system import opened, varied
from .coupling_plot import plot_coupling
from .errors import OptionError, RunError
from .files import check_writable
from .plot import check_picture
from .progress import showing_progress
from .results import write_results

__all__ = ["couple_and_show", "export_coupling"]


def couple_and_show(
    name: str, engine: str, output: Path | None, *, stop_time: float | None = None, plot: Path | None = None
) -> None:
    """Run a coupling, to another stop time [s] if there is one, keep its results and print a summary.

    Raises
    ------
    UserError
        A mistake in the coupling or an option, or what the engine cannot do.
    RunError
        If the run could not go on; results up to then are kept.
    """
    if engine not in ENGINES:
        raise OptionError(f"engine = {engine!r}: one of {', '.join(ENGINES)} is expected")
    coupling = load_coupling(name)
    results = output or Path("build") / f"{coupling.name}.csv"
    if results.suffix not in {".csv", ".nc"}:
        raise OptionError(f"output = {results}: a name that ends with .csv or .nc is expected")
    check_writable(results)
    if plot is not None:
        check_picture(plot)
    if stop_time is not None and not (math.isfinite(stop_time) and stop_time > 0.0):
        raise OptionError(f"stop time = {stop_time:g}: a number above 0 [s] is expected")
    failure: RunError | None = None
    with opened(coupling) as asked, showing_progress(coupling.name) as progress:
        system = asked if stop_time is None else varied(asked, stop_time=stop_time)
        try:
            result = run_with(engine, system, progress)
        except RunError as error:
            if not isinstance(error.partial, xr.Dataset):
                raise
            failure, result = error, error.partial
    written = write_results(result, results)
    _print(result, Console())
    if plot is not None:
        plot_coupling(result, plot)
    print(f"results: {', '.join(map(str, written))}" + (f", picture: {plot}" if plot is not None else ""))
    if failure is not None:
        raise RunError(f"the run ended at t = {failure.time:g} s; the results up to then are kept.\n{failure}")


def export_coupling(name: str, ssp: Path | None, osp: Path | None) -> None:
    """Write a coupling for other engines: an .ssp file, a folder with OspSystemStructure.xml.

    Raises
    ------
    UserError
        A mistake in the coupling, or what the format cannot say.
    """
    if ssp is not None and ssp.suffix != ".ssp":
        raise OptionError(f"ssp = {ssp}: a name that ends with .ssp is expected")
    with opened(load_coupling(name), elsewhere=True) as system:
        if ssp is not None:
            print(write_ssp(system, ssp))
        if osp is not None:
            print(write_osp(system, osp))


def summary(result: xr.Dataset) -> dict[str, str]:
    """What one looks at first, as texts."""
    attributes = result.attrs
    lines = {"algorithm": _algorithm(result), "steps": f"{attributes['steps']:,.0f}"}
    if attributes.get("shortest_step", 0.0) < 0.999 * attributes.get("longest_step", 0.0):
        lines["steps"] += f", of {attributes['shortest_step']:.3g} to {attributes['longest_step']:.3g} s"
    if attributes.get("rejected"):
        lines["steps beyond the tolerance"] = f"{attributes['rejected']:,.0f}"
    if attributes["algorithm"] == "iterated":
        lines["iterations"] = f"{attributes['evaluations'] / max(attributes['steps'], 1):.3g} per step"
    for name in result.data_vars:
        if str(name).endswith(".residual") and str(name).startswith("power."):
            lines[str(name).removesuffix(".residual")] = _power(result, str(name).removesuffix(".residual"))
    lines["run time"] = f"{attributes['run_time']:.4g} s"
    if attributes.get("notes"):
        lines["note"] = str(attributes["notes"])
    return lines


def _algorithm(result: xr.Dataset) -> str:
    attributes = result.attrs
    text = f"{attributes['algorithm']}, inputs of order {attributes['extrapolation']} in a step"
    return text if attributes["engine"] == "own" else f"{text}, by {attributes['engine']}"


def _power(result: xr.Dataset, name: str) -> str:
    """Largest residual, and the energy that it adds up to beside what went through."""
    time, power, residual = (result[n].values for n in ("time", name, f"{name}.residual"))
    step = np.diff(time, prepend=time[:1])
    made, through = float(residual @ step), float(np.abs(power) @ step)
    return f"residual {np.abs(residual).max():.3g} W at most, {made:+.3g} J in all; {through:.4g} J went through"


def _print(result: xr.Dataset, console: Console) -> None:
    table = Table(title=str(result.attrs["title"]), show_header=False, title_justify="left")
    for label, text in summary(result).items():
        table.add_row(label, text)
    console.print(table, markup=False)
