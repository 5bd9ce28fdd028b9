"""An hour of irregular sea: buoy, sea and 60 links coupled, then the cable alone under the motion that was recorded.

`python -m tests.benchmarks.coupled_hour [SECONDS]` prints how much faster than real time each is on one core, and how
far the load of the second run is from that of the first: its motion is a spline through samples every 0.1 s.
"""

from __future__ import annotations

import sys
import tempfile
import time as clock
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from cablefmu import load_scene, simulate
from cablefmu.coupling import load_coupling
from cablefmu.coupling.run import run_system
from cablefmu.coupling.system import opened, varied
from cablefmu.scene import Scene

COUPLING, VESSEL, CABLE, SCENE = "buoy-in-waves", "buoy", "cable", "lift-60"
HOUR = 3600.0  # s


@dataclass(slots=True)
class Stopwatch:
    """CPU time of the steps alone: of building, loading and the first step nothing."""

    seen: list[tuple[float, float]] = field(default_factory=list)

    def __call__(self, time: float, stop_time: float) -> None:
        self.seen[1:] = [(time, clock.process_time())]

    @property
    def speed(self) -> float:
        """Simulated over CPU time."""
        (start, begun), (end, ended) = self.seen
        return (end - start) / (ended - begun)


@dataclass(frozen=True, slots=True)
class Hour:
    """What was measured."""

    coupled: xr.Dataset
    alone: xr.Dataset
    speeds: tuple[float, float]
    """Simulated over CPU time: coupled, and the cable alone."""

    @property
    def apart(self) -> float:
        """Of the load in the two runs, the most [m]."""
        off = [self.coupled[f"{CABLE}.{name}"].values - self.alone[name].values for name in ("x_c", "y_c")]
        return float(np.max(np.hypot(*off)))


def recorded(coupled: xr.Dataset, folder: Path) -> Scene:
    """The cable's scene with the vessel's motion as it came out of a coupled run, from a file in `folder`."""
    columns = [coupled["time"].values, *(coupled[f"{VESSEL}.{axis}"].values for axis in "xy")]
    np.savetxt(folder / "motion.csv", np.transpose(columns), "%.17g", ",", header="time,x,y", comments="")
    text, _, _ = load_scene(SCENE).text.partition("[inputs]")
    moved = "".join(f'{axis}_1 = {{ signal = "csv", file = "motion.csv", value = "{axis}" }}\n' for axis in "xy")
    run = f"[run]\nstop_time = {coupled.attrs['stop_time']!r}\nstep = {coupled.attrs['step']!r}\n"
    (folder / "recorded.toml").write_text(f"{text}[inputs]\n{moved}\n{run}", encoding="utf-8")
    return load_scene(folder / "recorded.toml")


def measure(stop_time: float) -> Hour:
    """Run both, so long [s]."""
    watches = Stopwatch(), Stopwatch()
    with opened(load_coupling(COUPLING)) as system:
        coupled = run_system(varied(system, stop_time=stop_time), watches[0])
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        alone = simulate(recorded(coupled, Path(folder)), progress=watches[1])
    return Hour(coupled, alone, (watches[0].speed, watches[1].speed))


def main(stop_time: float) -> None:
    hour = measure(stop_time)
    for name, speed in zip(("coupled", "cable alone"), hour.speeds, strict=True):
        print(f"{name}: {stop_time:g} s in {stop_time / speed:.3g} s of CPU time, {speed:,.0f} times real time")
    print(f"the load is at most {hour.apart:.2g} m apart")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else HOUR)
