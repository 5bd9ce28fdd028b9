"""CPU time of the automatic choice beside the two methods it chooses from: shipped scenes, and twenty random ones.

`python -m tests.benchmarks.automatic` prints them alone. The tests in tests/kernel/test_choice.py count work instead.
"""

from __future__ import annotations

import ctypes
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from cablefmu.cable import SolverChoice
from cablefmu.scene import Scene, load_scene, shipped_scenes
from tests.kernel.library import Kernel, Wave, compile_kernel, load
from tests.kernel.motions import waves_of
from tests.kernel.random_scenes import COUNT, random_scene

__all__ = ["rows"]

ROUNDS = 5
"""Of which the best counts."""

Row = dict[str, float | str]


def seconds(library: ctypes.CDLL, scene: Scene, waves: Mapping[str, Wave], span: float) -> dict[SolverChoice, float]:
    """CPU seconds of a run by each solver in communication steps of the scene's, the solvers taking turns."""
    times = scene.step * np.arange(round(span / scene.step) + 1.0)
    best = dict.fromkeys(SolverChoice, float("inf"))
    for _ in range(ROUNDS):
        for solver in SolverChoice:
            kernel = Kernel(library, scene.cable)
            begun = time.process_time()
            run = kernel.run(times, tolerance=scene.tolerance, waves=waves, solver=solver)[-1]
            best[solver] = min(best[solver], time.process_time() - begun)
            if run.status != "ok":
                raise SystemExit(f"{scene.name}: {run.status}")
    return best


def rows() -> list[Row]:
    """Per scene: links, CPU seconds by solver, the automatic one's over those of the cheaper and the explicit one."""
    found: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        library = load(compile_kernel(Path(folder)))
        shipped = ((name, load_scene(name)) for name in shipped_scenes())
        cases = [(name, scene, waves_of(scene), scene.stop_time) for name, scene in shipped]
        cases += [(f"random {number}", *random_scene(number), 10.0) for number in range(COUNT)]
        for name, scene, waves, span in cases:
            best = seconds(library, scene, waves, span)
            explicit, implicit = best[SolverChoice.EXPLICIT], best[SolverChoice.IMPLICIT]
            chosen = best[SolverChoice.AUTOMATIC]
            row: Row = {"scene": name, "links": scene.cable.n}
            row |= {solver.value: cost for solver, cost in best.items()}
            found.append(row | {"of_cheaper": chosen / min(explicit, implicit), "of_explicit": chosen / explicit})
    return found


if __name__ == "__main__":
    for row in rows():
        print("  ".join(f"{value:.4g}" if isinstance(value, float) else str(value) for value in row.values()))
