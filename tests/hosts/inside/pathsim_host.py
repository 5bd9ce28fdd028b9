"""PathSim's two FMU blocks: Co-Simulation by its scheduled steps, Model Exchange under its RKDP54."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from exchange import Request, answer, force, steps
from pathsim import Connection, Simulation
from pathsim.blocks import Source
from pathsim.solvers import RKDP54
from pathsim_fmi import CoSimulationFMU, ModelExchangeFMU


def source(request: Request, name: str, start: float, ahead: float) -> Callable[[float], float]:
    """An input over time; the block feeds 0 to what is not connected, so constant inputs get their start value."""
    table = request["forces"].get(name)
    return (lambda time: force(table, time + ahead)) if table else (lambda time: start)


def run(request: Request) -> dict[str, Any]:
    co_simulation, step = request["interface"] == "cs", request["step"]
    block = CoSimulationFMU(request["fmu"], dt=step) if co_simulation else ModelExchangeFMU(request["fmu"])
    wrapper, blocks, connections = block.fmu_wrapper, [block], []
    for name in wrapper.input_refs:
        start = float(wrapper.variable_map[name].start)
        # In Co-Simulation forces are held over a step: those in its middle.
        feed = Source(source(request, name, start, step / 2 if co_simulation else 0.0))
        blocks.append(feed)
        connections.append(Connection(feed, block[name]))
    if co_simulation:
        # Its block steps at 0 as well: at time t its outputs are those of t + step.
        simulation = Simulation(blocks, connections, dt=step, log=False)
        simulation.run((steps(request) - 1) * step, adaptive=False)
        time = simulation.time + step
    else:
        error = {"tolerance_lte_abs": request["tolerance"], "tolerance_lte_rel": request["tolerance"]}
        simulation = Simulation(blocks, connections, dt=step, log=False, Solver=RKDP54, **error)
        simulation.run(request["stop"], adaptive=True)
        time = simulation.time
    values = dict(zip(wrapper.output_refs, block.outputs.to_array(), strict=True))
    return {"time": float(time), "end": {name: float(values[name]) for name in request["outputs"]}}


if __name__ == "__main__":
    answer("pathsim-fmi", run)
