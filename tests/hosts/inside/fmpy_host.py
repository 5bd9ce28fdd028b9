"""FMPy's simulate_fmu: Co-Simulation, and Model Exchange under its CVode and its Euler."""

from __future__ import annotations

from typing import Any

import numpy as np
from exchange import Request, answer
from fmpy import simulate_fmu


def signals(request: Request, ahead: float) -> Any:
    """The forces as FMPy takes them, `ahead` seconds early."""
    if not request["forces"]:
        return None
    names = list(request["forces"])
    times = np.array(request["forces"][names[0]]["times"]) - ahead
    found = np.zeros(len(times), dtype=[("time", float), *((name, float) for name in names)])
    found["time"] = times
    for name in names:
        found[name] = request["forces"][name]["values"]
    return found


def run(request: Request) -> dict[str, Any]:
    # Co-Simulation holds what it reads at a step's start: half a step early that is the force in the step's middle.
    # In Model Exchange Euler's step is the output interval, whatever step_size says that divides it.
    co_simulation, step = request["interface"] == "cs", request["step"]
    method = {} if co_simulation else {"solver": request["solver"], "relative_tolerance": request["tolerance"]}
    rows = simulate_fmu(
        request["fmu"],
        fmi_type="CoSimulation" if co_simulation else "ModelExchange",
        stop_time=request["stop"],
        output_interval=step,
        step_size=step,
        input=signals(request, step / 2 if co_simulation else 0.0),
        output=request["outputs"],
        **method,
    )
    return {"time": float(rows[-1]["time"]), "end": {name: float(rows[-1][name]) for name in request["outputs"]}}


if __name__ == "__main__":
    answer("fmpy", run)
