"""Table 6.6 of the dissertation: ten seconds of a falling cable, beside the dense reference and MATLAB."""

from __future__ import annotations

import time

import numpy as np

import cablefmu
from cablefmu.reference import integrate

__all__ = ["MATLAB", "rows"]

MATLAB = {20: 56, 40: 173, 60: 408, 80: 806, 100: 1272, 120: 1856}
"""Links -> seconds, as printed in Table 6.6 (2015)."""
TOLERANCES = (1e-4, 1e-6)


def rows() -> list[dict[str, float]]:
    """Per number of links and tolerance: seconds (best of five), error of the terminal [m], right-hand sides; the dense
    matrices under DOP853 at 1e-6; MATLAB as printed."""
    found = []
    for n, matlab in MATLAB.items():
        scene = cablefmu.load_scene(f"timing-{n}")
        exact = cablefmu.simulate(scene, tolerance=1e-12)
        begun = time.perf_counter()
        integrate(scene.cable, lambda t: {}, [0.0, scene.stop_time], rtol=1e-6, atol=1e-6)
        dense = time.perf_counter() - begun
        for tolerance in TOLERANCES:
            runs = [cablefmu.simulate(scene, tolerance=tolerance) for _ in range(5)]
            error = max(float(np.max(np.abs((runs[0][name] - exact[name]).values))) for name in ("x_c", "y_c"))
            found.append(
                {
                    "links": n,
                    "tolerance": tolerance,
                    "seconds": min(float(run.attrs["run_time"]) for run in runs),
                    "error_m": error,
                    "rhs": float(runs[0].attrs["solver_rhs"]),
                    "dense_seconds": dense,
                    "matlab_seconds": matlab,
                }
            )
    return found
