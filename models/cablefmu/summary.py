"""The short table that a run ends with."""

from __future__ import annotations

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table

__all__ = ["print_summary", "summary"]


def summary(result: xr.Dataset) -> dict[str, str]:
    """What one looks at first, as texts: only what the result holds."""
    lines: dict[str, str] = {}
    end = float(result["time"].values[-1])
    if "x_c" in result and "y_c" in result:
        lines["terminal position"] = (
            f"x_c = {_last(result, 'x_c'):.6g} m, y_c = {_last(result, 'y_c'):.6g} m at t = {end:g} s"
        )
    if "tension_max" in result:
        tension = result["tension_max"].values
        k = int(np.argmax(tension))
        lines["largest tension"] = f"{tension[k]:.6g} N at t = {float(result['time'].values[k]):g} s"
    if "energy" in result:
        energy = result["energy"].values
        lines["energy drift"] = f"{energy[-1] - energy[0]:+.6g} J, start to end (work of forces and damping included)"
    for key, label in (
        ("solver_steps", "steps"),
        ("solver_rejected", "rejected steps"),
        ("solver_rhs", "right-hand sides"),
    ):
        if key in result.attrs:
            lines[label] = f"{result.attrs[key]:,.0f}"
    if "run_time" in result.attrs:
        run_time = float(result.attrs["run_time"])
        lines["run time"] = f"{run_time:.4g} s"
        lines["faster than real time"] = f"{end / run_time:,.0f} times"
    return lines


def _last(result: xr.Dataset, name: str) -> float:
    return float(result[name].values[-1])


def print_summary(result: xr.Dataset, console: Console) -> None:
    """Print it as a table of two columns."""
    table = Table(title=str(result.attrs["title"]), show_header=False, title_justify="left")
    for label, text in summary(result).items():
        table.add_row(label, text)
    console.print(table)
