"""Ecos' fixed-step algorithm. It reads zeros where an instance could not be made: whoever asks compares values."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path
from typing import Any

from exchange import Request, answer, held, steps

# Its library asks for libtbb and brings none; PyPI's tbb puts it where the loader does not look.
ctypes.CDLL(str(Path(sys.prefix, "lib", "libtbb.so.12")), mode=ctypes.RTLD_GLOBAL)

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure  # noqa: E402  # after its library's library


def run(request: Request) -> dict[str, Any]:
    with EcosSimulationStructure() as structure:
        structure.add_model("cable", request["fmu"])
        with EcosSimulation(structure=structure, step_size=request["step"]) as simulation:
            if not simulation.init():
                raise RuntimeError(EcosLib.get_last_error())
            for step in range(steps(request)):
                for name, value in held(request, step).items():
                    simulation.set_real(f"cable::{name}", value)
                simulation.step()
            end = {name: simulation.get_real(f"cable::{name}") for name in request["outputs"]}
            time = simulation.get_time()
            simulation.terminate()
    return {"time": time, "end": end}


if __name__ == "__main__":
    answer("ecospy", run)
