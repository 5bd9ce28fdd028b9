"""Draw docs/hydrodynamics.svg: coefficients that ship, and the filters that stand for them.

pip install -e '.[plot]'
python fmu_src/hydrodynamics/figure.py
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np

from cablefmu.fmu.vessel_waves import fitted
from cablefmu.hydrodynamics import SHIPPED, read_database, shipped_database

TARGET = Path(__file__).resolve().parents[2] / "docs" / "hydrodynamics.svg"


def main() -> None:
    mpl.rcParams |= {"svg.hashsalt": "cablefmu", "font.size": 7, "svg.fonttype": "none"}
    figure, grid = plt.subplots(4, 2, figsize=(7.5, 8.5), layout="constrained")
    for column, name in enumerate(SHIPPED):
        body = read_database(shipped_database(name))
        radiation, excitation = fitted(body, tuple(body.points.tolist()))
        fine = np.linspace(body.omega[0], body.omega[-1], 90)
        arriving = np.exp(-1j * fine[:, None] ** 2 / body.gravity * body.points)
        for axis, mode in enumerate(("surge", "heave")):
            curves = (
                (f"{name}, {mode}: K [kN s/m]", body.memory[:, axis], radiation[axis].response(fine)),
                (f"{name}, {mode}: X [kN/m]", body.excitation[:, axis], excitation[axis].response(fine, arriving)),
            )
            for row, (title, known, met) in enumerate(curves):
                panel = grid[2 * row + axis, column]
                for part, colour in (("real", "tab:blue"), ("imag", "tab:orange")):
                    panel.plot(body.omega[::3], 1e-3 * getattr(known[::3], part), ".", ms=2.5, color=colour)
                    panel.plot(fine, 1e-3 * getattr(met, part), "-", lw=0.8, color=colour, label=part)
                panel.set_title(title)
                panel.grid(lw=0.3)
    for panel in grid[-1]:
        panel.set_xlabel("angular frequency [rad/s]; dots: coefficients, lines: filters")
    grid[0, 0].legend()
    figure.savefig(TARGET, metadata={"Date": None})


if __name__ == "__main__":
    main()
