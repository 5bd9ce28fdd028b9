"""What is around the integration: building an FMU, a communication step from C, and one through FMPy.

Beside each figure stands what it is measured against in the same run: the integration alone, and an empty FMU whose
functions return at once.
"""

from __future__ import annotations

import json
import re
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

import cablefmu
from cablefmu.scene import Scene
from tests.benchmarks.stiff import TABLE_6_1, Case
from tests.kernel.library import toolchain

__all__ = ["empty_fmu", "from_c", "rows", "through_fmpy"]

STEPS, ROUNDS = 1_000, 100
"""Short rounds, the fastest of many: the machine is shared."""
STEP = 1e-5
"""Communication step [s]: one step of the solver in each."""


def scene(links: int) -> Scene:
    """A cable of so many links that moves from the start."""
    return Case("Table 6.1, from 0.3 rad", links, TABLE_6_1, 0.3, {}).scene


def best(call: Callable[[], object], rounds: int) -> float:
    """Seconds of the fastest round."""
    found = float("inf")
    for _ in range(rounds):
        begun = time.perf_counter()
        call()
        found = min(found, time.perf_counter() - begun)
    return found


def from_c(links: int, folder: Path) -> dict[str, float]:
    """Seconds of a communication step from C, and of the same integration without FMI."""
    recipe, program = toolchain(), folder / "step_cost"
    flags = [flag for flag in recipe.RELEASE if flag not in ("-shared", "-s")]
    sources = [Path(__file__).with_name("step_cost.c"), *recipe.kernel_sources(), *recipe.fmi_sources()]
    recipe.compile_library(program, sources, flags, target=recipe.TARGETS["x86_64-linux"][0])
    path = cablefmu.build_fmu(scene(links), folder / f"{links}.fmu")
    unpacked = extract(str(path), unzipdir=str(folder / f"{links}"))
    token = read_model_description(unpacked).guid
    command = [program, Path(unpacked) / "resources", token, str(STEPS), str(STEP)]
    found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    if not found.pop("same"):
        raise SystemExit("a step through FMI and the integration alone end on different bits")
    return {name: 1e-9 * value for name, value in found.items()}


def empty_fmu(path: str | Path, folder: Path) -> str:
    """The same FMU unpacked, with a binary whose functions return at once; Instantiate returns something."""
    unpacked = extract(str(path), unzipdir=str(folder / f"empty-{Path(path).stem}"))
    headers = Path(fmpy.__file__).parent / "c-code"
    version = read_model_description(unpacked).fmiVersion[0]
    declared = (headers / f"fmi{version}FunctionTypes.h").read_text(encoding="utf-8")
    functions = sorted(set(re.findall(rf"\b(fmi{version}[A-Z]\w+?)TYPE\b", declared)))
    source = folder / f"empty{version}.c"
    lines = [f'__attribute__((visibility("default"))) void *{name}(void);' for name in functions]
    lines += [
        f"void *{name}(void) {{ return {'(void *)&here' if 'Instantiate' in name else '0'}; }}" for name in functions
    ]
    source.write_text("static int here;\n" + "\n".join(lines) + "\n", encoding="utf-8")
    (binary,) = Path(unpacked).glob("binaries/*/*.so")
    recipe = toolchain()
    recipe.compile_library(binary, [source], recipe.RELEASE, target=recipe.TARGETS["x86_64-linux"][0])
    return str(unpacked)


def stepping(folder: str, *, initialize: bool) -> Any:
    """An instance in step mode."""
    description = read_model_description(folder)
    kind = FMU2Slave if description.fmiVersion.startswith("2") else FMU3Slave
    fmu = kind(guid=description.guid, unzipDirectory=folder, instanceName="a",
               modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    fmu.instantiate()
    if initialize:
        if kind is FMU2Slave:
            fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
    return fmu


def through_fmpy(fmi: int, folder: Path) -> dict[str, float]:
    """Seconds of a communication step of one link through FMPy, and of an empty FMU."""
    path = cablefmu.build_fmu(scene(1), folder / f"fmpy-{fmi}.fmu", fmi=fmi, platforms=["x86_64-linux"])
    ours = stepping(extract(str(path), unzipdir=str(folder / f"fmpy-{fmi}")), initialize=True)
    empty = stepping(empty_fmu(path, folder), initialize=False)
    at = [0]

    def steps_of(fmu: Any, first: int) -> None:
        for k in range(first, first + STEPS):
            fmu.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)

    def ours_on() -> None:
        steps_of(ours, at[0])
        at[0] += STEPS

    found = {"ours": float("inf"), "empty": float("inf")}
    for _ in range(ROUNDS):  # by turns
        found["ours"] = min(found["ours"], best(ours_on, 1) / STEPS)
        found["empty"] = min(found["empty"], best(lambda: steps_of(empty, 0), 1) / STEPS)
    ours.freeInstance()
    return found


def rows() -> list[dict[str, float | str]]:
    """Seconds each."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found: list[dict[str, float | str]] = []
        for shipped in ("free-12-water", "timing-120"):
            seconds = best(lambda shipped=shipped: cablefmu.build_fmu(shipped, folder / "a.fmu"), 5)  # type: ignore[misc]
            found.append({"what": f"build_fmu({shipped})", "seconds": seconds})
        beyond = {}
        for links in (1, 12, 120):
            cost = from_c(links, folder)
            beyond[links] = cost["through_fmi"] - cost["alone"]
            what = f"fmi2DoStep from C, {links} links, beyond the integration"
            found.append({"what": what, "seconds": beyond[links]})
        for fmi in (2, 3):
            cost = through_fmpy(fmi, folder)
            found.append({"what": f"doStep through FMPy, FMI {fmi}, empty FMU", "seconds": cost["empty"]})
            found.append({"what": f"doStep through FMPy, FMI {fmi}, one link, all of it", "seconds": cost["ours"]})
            # what FMPy does is the same for both, and so is what C adds beyond the integration
            ratio = 1.0 + beyond[1] / cost["empty"]
            found.append(
                {"what": f"... but for the integration, over the empty FMU's, FMI {fmi} (a ratio)", "seconds": ratio}
            )
    return found


if __name__ == "__main__":
    for row in rows():
        print(f"{row['what']}: {row['seconds']:.3g}")
