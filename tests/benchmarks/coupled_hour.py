"""An hour of irregular sea: buoy, sea and 60 links coupled, then the cable alone under the motion that was recorded.

`python -m tests.benchmarks.coupled_hour [SECONDS]` prints how much faster than real time each is on one core, and how
far the load of the second run is from that of the first: its motion is a spline through samples every 0.1 s.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
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


@dataclass(frozen=True, slots=True)
class Hour:
    """What was measured."""

    coupled: xr.Dataset
    alone: xr.Dataset

    @property
    def speeds(self) -> tuple[float, float]:
        """Simulated over run time, without building FMUs: coupled, and the cable alone."""
        return tuple(run.attrs["stop_time"] / run.attrs["run_time"] for run in (self.coupled, self.alone))

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
    with opened(load_coupling(COUPLING)) as system:
        coupled = run_system(varied(system, stop_time=stop_time))
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        alone = simulate(recorded(coupled, Path(folder)))
    return Hour(coupled, alone)


def main(stop_time: float) -> None:
    hour = measure(stop_time)
    for name, run, speed in zip(("coupled", "cable alone"), (hour.coupled, hour.alone), hour.speeds, strict=True):
        print(f"{name}: {stop_time:g} s in {run.attrs['run_time']:.3g} s, {speed:,.0f} times real time")
    print(f"the load is at most {hour.apart:.2g} m apart")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else HOUR)
