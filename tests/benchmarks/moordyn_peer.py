"""MoorDyn's own line, as near to the 120-link cable as its model allows; run by an interpreter that has it.

`PYTHON tests/benchmarks/moordyn_peer.py SEGMENTS SECONDS` prints one JSON line: version, largest step that stays
stable (halved from 0.01 s), CPU seconds at it. MoorDyn's line stretches (EA = E A of the steel) and its top is held,
not on a floater: a comparison of what users would run, not of the same equations.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path

LENGTH, DIAMETER, DENSITY, YOUNG = 240.0, 0.02, 7850.0, 8e10
LOAD, LOAD_VOLUME, DEPTH = 60.0, 60.0 / 7850.0, 400.0


def deck(segments: int, step: float) -> str:
    """The input file: straight at 45 degrees, top held, load at the free end."""
    area = math.pi * DIAMETER**2 / 4.0
    reach = LENGTH / math.sqrt(2.0)
    return f"""Cable for a comparison
---------------------- LINE TYPES --------------------------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
cable {DIAMETER} {area * DENSITY} {YOUNG * area} -0.8 0 1.0 0.0 0.0 0.0
---------------------- POINTS ------------------------------------------
ID Attachment X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Coupled 0 0 0 0 0 0 0
2 Free {reach} 0 {-reach} {LOAD} {LOAD_VOLUME} 0 0
---------------------- LINES -------------------------------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 cable 1 2 {LENGTH} {segments} -
---------------------- OPTIONS -----------------------------------------
{step} dtM
rk2 tScheme
9.81 g
1000 WtrDnsty
{DEPTH} WtrDpth
0 TmaxIC
1 disableOutput
0 writeLog
------------------------- END ------------------------------------------
"""


def run(segments: int, step: float, seconds: float, folder: Path) -> tuple[float, bool]:
    """CPU seconds, and whether the load ended where a load can be."""
    import moordyn

    path = folder / "cable.txt"
    path.write_text(deck(segments, step), encoding="ascii")
    system = moordyn.Create(str(path))
    position, velocity = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    moordyn.Init(system, position, velocity)
    begun, t = time.process_time(), 0.0
    try:
        for _ in range(round(seconds / 0.1)):
            moordyn.Step(system, position, velocity, t, 0.1)
            t += 0.1
        spent = time.process_time() - begun
        end = moordyn.GetPointPos(moordyn.GetPoint(system, 2))
        stable = math.isfinite(sum(end)) and math.hypot(*end) < 1.02 * LENGTH
    except RuntimeError:  # it stops when it meets a NaN
        return time.process_time() - begun, False
    finally:
        moordyn.Close(system)
    return spent, stable


def main() -> None:
    segments, seconds, step = int(sys.argv[1]), float(sys.argv[2]), 0.01
    with tempfile.TemporaryDirectory() as name:
        spent, stable = run(segments, step, seconds, Path(name))
        while not stable and step > 1e-7:
            step /= 2.0
            spent, stable = run(segments, step, seconds, Path(name))
        best = min([spent, *(run(segments, step, seconds, Path(name))[0] for _ in range(2))])
    print(json.dumps({"version": version("moordyn"), "step": step, "seconds": best, "stable": stable}))


if __name__ == "__main__":
    main()
