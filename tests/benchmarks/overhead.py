"""What is around the integration: building an FMU, and a communication step through FMPy."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

import cablefmu

__all__ = ["rows"]


def best(call: Callable[[], object], rounds: int) -> float:
    """Seconds of the fastest round."""
    found = float("inf")
    for _ in range(rounds):
        begun = time.perf_counter()
        call()
        found = min(found, time.perf_counter() - begun)
    return found


def rows() -> list[dict[str, float | str]]:
    """Seconds each."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found: list[dict[str, float | str]] = [
            {
                "what": f"build_fmu({scene})",
                "seconds": best(lambda scene=scene: cablefmu.build_fmu(scene, folder / "a.fmu"), 5),
            }  # type: ignore[misc]
            for scene in ("free-12-water", "timing-120")
        ]
        path = cablefmu.build_fmu("free-12-water", folder / "b.fmu")
        description, unpacked = read_model_description(path), extract(path, unzipdir=str(folder / "fmu"))
        fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=unpacked,
            modelIdentifier=description.coSimulation.modelIdentifier, instanceName="a",
        )  # fmt: skip
        fmu.instantiate()
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        steps, h = 20_000, 1e-5

        def all_steps() -> None:
            for k in range(steps):
                fmu.doStep(currentCommunicationPoint=k * h, communicationStepSize=h)

        found.append({"what": "doStep through FMPy, 12 links, one solver step", "seconds": best(all_steps, 1) / steps})
        fmu.terminate()
        fmu.freeInstance()
    return found
