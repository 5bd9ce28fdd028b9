"""Stiff cables: the implicit method beside the explicit one, scipy's Radau, CVODE, and other Rosenbrock methods.

All solve the same right-hand side, the kernel's. The cases are of one cable of 240 m, submerged, Cd = 1.2, with 60 kg
at its end: so stiff in bending that explicit steps are a tenth of a millisecond, or of 1,000 links.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from cablefmu.cable import Cable, Floats, SolverChoice
from cablefmu.scene import Scene
from tests.kernel.library import Kernel, compile_kernel, inputs_of, load, toolchain

__all__ = ["growth", "rows"]

SPAN = 10.0
"""[s]"""
TABLES = ("RODAS4", "RODAS4P2")
"""Methods that were measured and not taken; the kernel has RODAS5P."""

_SCENE = """
format = 1
description = "A stiff cable with a load"
[cable]
links = {links}
length = 240.0
diameter = 0.02
density = 7850.0
joint_stiffness = {stiffness}
joint_damping = 2.8
[water]
Cd = 1.2
[top]
kind = "floater"
mass = 6000.0
stiffness = 1200.0
damping = 237.6
[terminal]
kind = "load"
mass = 60.0
volume = 1e-9
[shape]
kind = "straight"
angle = {angle}
[run]
stop_time = 10.0
"""


@dataclass(frozen=True)
class Case:
    """One motion."""

    name: str
    links: int
    bending: float
    """EI of the beam that the joints stand for [N m^2]; 5/6 of it is what counts [Table 6.1]."""
    angle: float
    """Of all links at the start [rad]"""
    forces: Mapping[str, float]

    @property
    def scene(self) -> Scene:
        """Ready to run."""
        stiffness = 5.0 / 6.0 * self.links * self.bending / 240.0
        text = _SCENE.format(links=self.links, stiffness=repr(stiffness), angle=repr(self.angle))
        return Scene.from_text(text, name="stiff")

    @property
    def cable(self) -> Cable:
        """The scene's numbers."""
        return self.scene.cable


TABLE_6_1 = 8e10 * np.pi / 4 * 0.01**4
"""E I of the dissertation's cable [N m^2]"""

CASES = (
    Case("EI = 1e7, n = 240, pulled sideways", 240, 1e7, 0.0, {"F_cx": 200.0}),
    Case("EI = 1e5, n = 240, pulled sideways", 240, 1e5, 0.0, {"F_cx": 200.0}),
    Case("Table 6.1, n = 1000, falling from 30 degrees", 1000, TABLE_6_1, np.pi / 6, {}),
)


@cache
def library(table: str = "RODAS5P") -> Path:
    """The kernel compiled with one of the Rosenbrock methods."""
    folder = Path(tempfile.mkdtemp(prefix=f"cablefmu-{table}-"))
    flags = [flag for flag in toolchain().RELEASE if flag != "-fvisibility=hidden"]
    return compile_kernel(folder, flags=[*flags, f"-DROSENBROCK_TABLE={table}"])


def tip(cable: Cable, q: Floats) -> Floats:
    """P_n, from the angles."""
    length = cable.links.length
    return np.array([np.sum(length * np.sin(q[1:])), q[0] + np.sum(length * np.cos(q[1:]))])


def own(
    case: Case, solver: SolverChoice, tolerance: float, *, table: str = "RODAS5P", repeats: int = 3
) -> dict[str, float]:
    """Best CPU time of a few runs, steps, and where the terminal ends."""
    cable = case.cable
    waves = {name: (force, 0.0, 0.0) for name, force in case.forces.items()}
    seconds = []
    for _ in range(repeats):
        kernel = Kernel(load(library(table)), cable)
        begun = time.process_time()
        run = kernel.run(np.array([0.0, SPAN]), tolerance=tolerance, waves=waves, solver=solver)[-1]
        seconds.append(time.process_time() - begun)
        if run.status != "ok":
            raise SystemExit(f"{case.name}: {run.status}")
    x, y = tip(cable, run.q)
    return {"seconds": min(seconds), "steps": run.counters["steps"] + run.counters["rejected"], "x": x, "y": y}


def radau(case: Case, tolerance: float) -> dict[str, float]:
    """Scipy's Radau IIA of order 5 with its dense Jacobian by differences."""
    cable = case.cable
    kernel, u = Kernel(load(library()), cable), inputs_of(case.forces)
    start = np.concatenate([cable.position, cable.velocity])
    begun = time.process_time()
    found = solve_ivp(
        lambda t, x: kernel.derivatives(np.ascontiguousarray(x), u),
        (0.0, SPAN),
        start,
        "Radau",
        rtol=tolerance,
        atol=tolerance,
    )
    x, y = tip(cable, found.y[: cable.n + 1, -1])
    return {"seconds": time.process_time() - begun, "steps": len(found.t) - 1, "x": x, "y": y}


def cvode(case: Case, tolerance: float) -> dict[str, float]:
    """FMPy's CVODE on the Model Exchange FMU: BDF with a dense Jacobian by differences."""
    import cablefmu

    begun = time.process_time()
    result = cablefmu.simulate(case.scene, interface="me", tolerance=tolerance, step=SPAN, parameters=dict(case.forces))
    x, y = (float(result[name].values[-1]) for name in ("x_c", "y_c"))
    steps = float(result.attrs["solver_steps"])
    return {
        "seconds": float(result.attrs["run_time"]),
        "steps": steps,
        "x": x,
        "y": y,
        "all": time.process_time() - begun,
    }


def rows() -> list[dict[str, object]]:
    """Every case by every method: CPU seconds, steps, error of the terminal [m] against tolerance 1e-9."""
    found: list[dict[str, object]] = []

    def add(case: Case, method: str, tolerance: float, run: Mapping[str, float]) -> None:
        error = float(np.hypot(run["x"] - exact["x"], run["y"] - exact["y"]))
        row = {"case": case.name, "method": method, "tolerance": tolerance, "error_m": error}
        found.append(row | {name: run[name] for name in ("seconds", "steps")})

    for case in CASES:
        exact = own(case, SolverChoice.IMPLICIT, 1e-9, repeats=1)
        for tolerance in (5e-3, 1e-3, 1e-4, 1e-6):
            add(case, "implicit", tolerance, own(case, SolverChoice.IMPLICIT, tolerance, repeats=5))
        for table in TABLES:
            for tolerance in (5e-3, 1e-3, 1e-4, 1e-6):
                add(case, table, tolerance, own(case, SolverChoice.IMPLICIT, tolerance, table=table))
        for tolerance in (1e-3, 1e-4):
            add(case, "automatic", tolerance, own(case, SolverChoice.AUTOMATIC, tolerance))
            add(case, "explicit", tolerance, own(case, SolverChoice.EXPLICIT, tolerance, repeats=1))
        if case.links > 240:
            continue  # dense matrices of 2,002 states
        for tolerance in (1e-3, 1e-4):
            add(case, "scipy Radau", tolerance, radau(case, tolerance))
            add(case, "CVODE BDF", tolerance, cvode(case, tolerance))
    return found


def growth() -> dict[str, object]:
    """CPU time of an implicit step by number of links, and the exponent that fits it."""
    links, seconds = (100, 300, 1000, 3000, 10000), []
    for n in links:
        cable = Case("", n, TABLE_6_1, np.pi / 6, {}).cable
        best = np.inf
        for _ in range(3):
            kernel = Kernel(load(library()), cable)
            kernel.start(0.0, cable.position, cable.velocity, tolerance=1e-4, solver=SolverChoice.IMPLICIT)
            begun = time.process_time()
            run = kernel.advance(0.5 if n < 1000 else 0.05, {})
            best = min(best, (time.process_time() - begun) / (run.counters["steps"] + run.counters["rejected"]))
        seconds.append(best)
    exponent = float(np.polyfit(np.log(links), np.log(seconds), 1)[0])
    return {"links": list(links), "seconds_per_step": seconds, "exponent": exponent}
