"""Two FMUs and a script, stepped together: what the first coupled run of a cable looks like.

A wave-force FMU (fmu_src/partners/wave_force.py) and a scripted vessel force, which depends on the floater's
displacement `y_m1` and velocity `v_m1`, drive the input `u_m1` of a cable's FMU. The master below is the
simplest there is: every communication step h it reads all outputs, sets the sum of the forces, holds it, and
steps both FMUs (Jacobi, zero-order hold). A held force lags by h/2 on average, so the run has an error of
first order in h. It is measured against one integration of the whole system, cable, wave and vessel in one
right-hand side, by the dense reference model, which shares no code with the FMUs.

Run `python docs/examples/coupled_wave.py`: it prints the errors and draws build/coupled_wave.png. SI, y down.
"""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import cablefmu
from cablefmu.reference import Reference

ROOT = Path(__file__).resolve().parents[2]
SCENE = "free-12-water"  # 12 links fall from 45 degrees under a floater of 6 t
STOP, WATCH = 16.0, 0.4  # end of the run, interval at which solutions are compared [s]
STEPS = (0.2, 0.1, 0.05, 0.025)  # communication steps h [s]
TOLERANCE = 1e-9  # of the cable's solver: its error must not show beside that of the coupling
WAVE = {"amplitude": 6_000.0, "period": 8.0, "phase": 0.3, "ramp": 4.0}  # N, s, rad, s

Floats = NDArray[np.float64]


def vessel_force(y: float, v: float) -> float:
    """Scripted force of the vessel on floater 1 [N], positive down: a winch that holds depth, and a heave plate."""
    return -1500.0 * y - 1000.0 * v - 400.0 * abs(v) * v


def wave_force(t: float) -> float:
    """What the wave FMU should say, for the whole-system integration: sin^2 ramp times sine [N], positive down."""
    growth = math.sin(0.5 * math.pi * min(t / WAVE["ramp"], 1.0)) ** 2
    return WAVE["amplitude"] * growth * math.sin(2.0 * math.pi / WAVE["period"] * t + WAVE["phase"])


def build(folder: Path) -> tuple[Path, Path]:
    """Build both FMUs into `folder`; the paths of the cable's and the wave's."""
    # pythonfmu imports the script that it packs. In a process of its own that leaves no trace in this one,
    # where the FMU's copy of the script is to be imported, under the same module name.
    script = ROOT / "fmu_src" / "partners" / "wave_force.py"
    command = [sys.executable, "-B", "-m", "pythonfmu", "build", "-f", str(script), "-d", str(folder)]
    subprocess.run(command, check=True)
    return cablefmu.build_fmu(SCENE, folder / f"{SCENE}.fmu"), folder / "WaveForce.fmu"


@contextmanager
def instance(path: Path, parameters: Mapping[str, float]) -> Iterator[tuple[Any, dict[str, int]]]:
    """Instance of an FMU with these parameters, in initialisation mode, and its value references by name."""
    description, folder = read_model_description(path), extract(path)
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=path.stem,
    )
    try:
        fmu.instantiate()
        fmu.setReal([reference[name] for name in parameters], list(parameters.values()))
        fmu.setupExperiment(tolerance=TOLERANCE, startTime=0.0)
        fmu.enterInitializationMode()
        yield fmu, reference
        fmu.terminate()
    finally:
        fmu.freeInstance()  # and unloads the library
        shutil.rmtree(folder)


def coupled(cable_path: Path, wave_path: Path, step: float, stop: float = STOP) -> Floats:
    """The FMUs stepped together; columns y_m1, x_c [m] every WATCH seconds from 0 to `stop`."""
    with instance(cable_path, {}) as (cable, at), instance(wave_path, WAVE) as (wave, wave_at):
        for fmu in (cable, wave):
            fmu.exitInitializationMode()
        watched, every = [], round(WATCH / step)
        for k in range(round(stop / step) + 1):  # t = k h, never t += h: no rounding adds up
            y, v, x_c = cable.getReal([at["y_m1"], at["v_m1"], at["x_c"]])
            (wave_now,) = wave.getReal([wave_at["force"]])
            if k % every == 0:
                watched.append((y, x_c))
            cable.setReal([at["u_m1"]], [wave_now + vessel_force(y, v)])
            for fmu in (cable, wave):
                fmu.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
    return np.array(watched)


def whole_system(stop: float = STOP) -> Floats:
    """The same columns from one integration of everything, to 1e-10 (DOP853)."""
    model = Reference(cablefmu.load_scene(SCENE).cable)
    start, size = np.concatenate([model.cable.position, model.cable.velocity]), model.cable.n + 1

    def forces(t: float, state: Floats) -> dict[str, float]:
        return {"u_m1": wave_force(t) + vessel_force(state[0], state[size])}

    def right_side(t: float, state: Floats) -> Floats:
        q, v = state[:size], state[size:]
        return np.concatenate([v, model.acceleration(q, v, forces(t, state))])

    times = np.arange(round(stop / WATCH) + 1) * WATCH
    states = [start]
    for begin, end in pairwise(times):  # steps end at the watched times, and so where the ramp does
        piece = solve_ivp(right_side, (begin, end), states[-1], method="DOP853", rtol=1e-10, atol=1e-12)
        states.append(piece.y[:, -1])
    outputs = [model.outputs(s[:size], s[size:], forces(t, s)) for t, s in zip(times, states, strict=True)]
    return np.array([(out["y_m1"], out["x_c"]) for out in outputs])


def orders(errors: Floats) -> Floats:
    """Observed order between successive halvings: log2 of the ratio of errors."""
    return np.asarray(np.log2(errors[:-1] / errors[1:]), dtype=float)


def draw(path: Path, exact: Floats, runs: Mapping[float, Floats], errors: Floats) -> None:
    """Convergence on the left, the motion itself on the right."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.5), layout="constrained")
    left, *right = figure.subplot_mosaic([["error", "y_m1"], ["error", "x_c"]]).values()
    times = np.arange(len(exact)) * WATCH
    for axes, name, column in zip(right, ("y_m1", "x_c"), (0, 1), strict=True):
        left.loglog(STEPS, errors[:, column], "o-", label=f"largest error of {name}")
        axes.plot(times, exact[:, column], "k-", label="whole system")
        axes.plot(times, runs[STEPS[0]][:, column], ".", label=f"coupled, h = {STEPS[0]} s")
        axes.set(xlabel="time [s]", ylabel=f"{name} [m]")
        axes.legend()
    left.loglog(STEPS, errors[-1, 0] * np.array(STEPS) / STEPS[-1], "k--", label="first order")
    left.set(xlabel="communication step h [s]", ylabel="error [m]")
    left.set_xticks(STEPS, labels=[str(step) for step in STEPS])
    left.minorticks_off()
    left.legend()
    FigureCanvasAgg(figure).print_figure(path, dpi=120)


def study(folder: Path) -> tuple[Floats, dict[float, Floats], Floats]:
    """The whole system, the coupled run for every step, and its largest errors: one row a step, columns as above."""
    exact, paths = whole_system(), build(folder)
    runs = {step: coupled(*paths, step) for step in STEPS}
    return exact, runs, np.array([np.abs(run - exact).max(axis=0) for run in runs.values()])


def table(errors: Floats) -> str:
    """Errors against communication steps, with the order between successive halvings."""
    lines = [f"{'h [s]':>7}{'error y_m1 [m]':>17}{'order':>7}{'error x_c [m]':>17}{'order':>7}"]
    seen = [("", ""), *((f"{y:.2f}", f"{x:.2f}") for y, x in orders(errors))]
    for step, (y, x), (order_y, order_x) in zip(STEPS, errors, seen, strict=True):
        lines.append(f"{step:7g}{y:17.3e}{order_y:>7}{x:17.3e}{order_x:>7}")
    return "\n".join(lines)


def main(folder: Path = ROOT / "build") -> None:
    """Run, compare, print and draw."""
    exact, runs, errors = study(folder)
    print(table(errors))
    draw(folder / "coupled_wave.png", exact, runs, errors)
    print(f"drawn: {folder / 'coupled_wave.png'}")


if __name__ == "__main__":
    main()
