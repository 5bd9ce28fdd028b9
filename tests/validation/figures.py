"""The page's figures: docs/validation-*.svg."""

from __future__ import annotations

import ctypes
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cablefmu.shapes import catenary as rest_shape
from tests.kernel.library import Kernel
from tests.validation.cables import cantilever, sinking_cable
from tests.validation.catenary import shift
from tests.validation.checks import read_table
from tests.validation.elastica import BENDING_STIFFNESS, LENGTH, LINKS
from tests.validation.frequencies import Chain, leading_error
from tests.validation.motion import rest
from tests.validation.sinking import depths, terminal_speed

__all__ = ["draw"]


def draw(library: ctypes.CDLL, folder: Path) -> None:
    """Write every figure into `folder`; the same file for the same numbers."""
    matplotlib.rcParams["svg.hashsalt"] = "cablefmu"
    for name, paint in (
        ("frequencies", _frequencies), ("elastica", _elastica), ("catenary", _catenary), ("sinking", _sinking),
    ):  # fmt: skip
        figure = Figure(figsize=(6.4, 4.0), layout="constrained")
        axes = figure.subplots()
        paint(axes, library)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
        figure.savefig(folder / f"validation-{name}.svg", metadata={"Date": None})


def _frequencies(axes: Axes, library: ctypes.CDLL) -> None:
    chain = Chain(library)
    rows = [row for row in read_table("hanging_chain_frequencies") if row["N"] == 10 and row["mode"] <= 5]
    links = np.array([5, 10, 20, 40, 80, 120])
    for row in rows:
        mode, lam = int(row["mode"]), row["continuous_bessel"]
        found = [chain.lambdas(int(n))[mode - 1] / lam - 1.0 for n in links]
        (line,) = axes.loglog(links, found, "o", label=f"mode {mode}")
        axes.loglog(links, leading_error(lam, 0.0) / links**2, color=line.get_color(), linewidth=0.8)
    axes.set(
        xlabel="links",
        ylabel="relative error of the frequency",
        title="Points: kernel. Lines: derived c/n²",
    )


def _elastica(axes: Axes, library: ctypes.CDLL) -> None:
    cable = cantilever(LINKS, LENGTH, BENDING_STIFFNESS, wall=2.0)
    kernel, q = Kernel(library, cable), cable.position
    rows = read_table("elastica_cantilever_tip_load")
    for row in rows:
        q = rest(kernel, q, {"F_cx": row["PL2_over_EI"] * BENDING_STIFFNESS / LENGTH**2})
        across, along = (np.concatenate([[0.0], np.cumsum(part(q[1:])) / LINKS]) for part in (np.sin, np.cos))
        axes.plot(along, across, linewidth=1.0, label=f"a = {row['PL2_over_EI']:g}")
    axes.plot(
        [r["x_over_L"] for r in rows],
        [r["w_over_L"] for r in rows],
        "k+",
        markersize=10,
        label="published tips",
    )
    axes.set(
        xlabel="x/L along the unbent beam",
        ylabel="w/L across it",
        title=f"Cantilever under a tip load, {LINKS} links",
    )
    axes.set_aspect("equal")


def _catenary(axes: Axes, library: ctypes.CDLL) -> None:
    links = np.array([30, 60, 120, 240, 480, 960])
    for row in read_table("catenary_inextensible")[:6]:
        pull, length = row["H_N"], row["L_m"]
        found = [
            rest_shape(
                np.full(n, length / n), np.full(n, row["w_N_per_m"] * length / n), (row["x_m"], row["z_m"])
            ).horizontal
            for n in links
        ]
        (line,) = axes.loglog(
            links,
            np.abs(np.array(found) / pull - 1.0),
            "o",
            label=f"({row['x_m']:g}, {row['z_m']:g}) m, {length:g} m",
        )
        axes.loglog(links, np.abs(shift(row)[0]) / pull / links**2, color=line.get_color(), linewidth=0.8)
    axes.set(
        xlabel="links",
        ylabel="relative difference of the horizontal pull",
        title="Points: rest shape. Lines: derived c/n²",
    )


def _sinking(axes: Axes, library: ctypes.CDLL) -> None:
    times = np.linspace(0.0, 0.8, 33)
    runs = Kernel(library, sinking_cable(12)).run(times, tolerance=1e-8)
    smooth = np.linspace(0.0, 0.8, 200)
    axes.plot(smooth, depths(smooth)[1], linewidth=0.8, label="V tanh(t/s)")
    axes.plot(times[1:], [run.v[0] for run in runs], "o", markersize=4, label="kernel, 12 links")
    axes.axhline(terminal_speed(), color="0.5", linestyle="--", linewidth=0.8, label="V = sqrt(2w/(rho Cd D))")
    axes.set(xlabel="time [s]", ylabel="speed [m/s]", title="A level cable sinks from rest")
