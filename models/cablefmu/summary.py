"""The short table that a run ends with."""

from __future__ import annotations

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table

from .cable import Floats

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
    return lines | _modes(result) | _solver(result) | _speed(result, end)


def _modes(result: xr.Dataset) -> dict[str, str]:
    """The slowest natural frequencies."""
    if "frequency" not in result or not result["frequency"].size:
        return {}
    slowest = ", ".join(f"{frequency:.4g}" for frequency in result["frequency"].values[:3])
    return {"natural frequencies": f"{slowest} Hz at the equilibrium of the start, undamped"}


def _solver(result: xr.Dataset) -> dict[str, str]:
    """Which method integrated, how much work that was, and how well it did."""
    lines: dict[str, str] = {}
    own = result.attrs.get("interface") == "cs"  # what the FMU says of its solver is true of a run by it alone
    if own and "solver.stiff" in result:
        lines["solver"] = _method(result["solver.stiff"].values[1:])
    for key, label in (
        ("solver_steps", "steps"),
        ("solver_rejected", "rejected steps"),
        ("solver_rhs", "right-hand sides"),
        ("solver_jacobians", "Jacobians"),
    ):
        if key in result.attrs:
            lines[label] = f"{result.attrs[key]:,.0f}"
    if own and "solver.error_estimate" in result:
        largest = float(np.max(result["solver.error_estimate"].values))
        lines["error estimate"] = f"{largest:.3g} at most in a step (tolerance {result.attrs['tolerance']:g})"
    if "solver_energy_residual" in result.attrs:
        lines["energy residual"] = _energy_residual(result, float(result.attrs["solver_energy_residual"]))
    return lines


def _method(stiff: Floats) -> str:
    """In words, from whether it was implicit when each output interval ended."""
    share = float(np.mean(stiff)) if stiff.size else 0.0
    if share in (0.0, 1.0):
        return "implicit" if share else "explicit"
    return f"implicit in {100.0 * share:.3g} % of the output intervals, else explicit"


def _energy_residual(result: xr.Dataset, residual: float) -> str:
    """The error of the balance at the end, beside what went in and out of the cable's energy."""
    text = f"{residual:.3g} J"
    exchanged = float(np.ptp(result["energy"].values)) if "energy" in result else 0.0
    return f"{text}, {abs(residual) / exchanged:.2g} of the range of the energy" if exchanged > 0.0 else text


def _speed(result: xr.Dataset, end: float) -> dict[str, str]:
    lines: dict[str, str] = {}
    if "run_time" in result.attrs:
        run_time = float(result.attrs["run_time"])
        lines["run time"] = f"{run_time:.4g} s"
        lines["faster than real time"] = f"{(end - float(result['time'].values[0])) / run_time:,.0f} times"
    return lines


def _last(result: xr.Dataset, name: str) -> float:
    return float(result[name].values[-1])


def print_summary(result: xr.Dataset, console: Console) -> None:
    """Print it as a table of two columns."""
    table = Table(title=str(result.attrs["title"]), show_header=False, title_justify="left")
    for label, text in summary(result).items():
        table.add_row(label, text)
    console.print(table)
