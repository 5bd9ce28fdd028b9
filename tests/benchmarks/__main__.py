"""`python -m tests.benchmarks [PYTHON]`: measure, print tables, write build/benchmarks.json and docs/benchmarks.json.

The documentation's page is made of the latter; with peers the README's figures are as well.

PYTHON is an interpreter that has the peers: `pip install mujoco pin dartpy moordyn scipy` in an environment of its own.
"""

from __future__ import annotations

import json
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

from tests.benchmarks import automatic, overhead, readme, rhs, stiff, table_6_6, work_precision
from tests.benchmarks.tables import tables

LINKS = 120
REPEATS = 2_000
SPAN = 10.0
"""Of the peers' motions [s]."""


def machine() -> str:
    """Processor, as the system names it."""
    info = Path("/proc/cpuinfo")
    names = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor()


def peers(python: str) -> dict[str, dict[str, object]]:
    """What the libraries need for the same chain, after a look that they solve the same chain."""
    script = Path(__file__).with_name("peers.py")
    done = subprocess.run(
        [python, str(script), str(LINKS), str(REPEATS), str(SPAN)], capture_output=True, text=True, check=True
    )
    found: dict[str, dict[str, object]] = json.loads(done.stdout)
    own = rhs.single(LINKS, SPAN)
    for name, peer in found.items():
        difference = np.max(np.abs(np.subtract(peer.pop("accelerations"), own["accelerations"])))  # type: ignore[call-overload]
        if not difference < 1e-6:
            raise SystemExit(f"{name} solves another chain: accelerations differ by {difference}")
    found["cablefmu"] = {"version": version("cablefmu"), "seconds": own["seconds"], "motions": own["motions"][:-1]}
    exact = own["motions"][-1]["end"]
    for peer in found.values():
        for motion in peer["motions"]:  # type: ignore[attr-defined]
            motion["error_m"] = float(np.max(np.abs(np.subtract(motion["end"], exact))))
    found["dense NumPy (cablefmu.reference)"] = {"version": np.__version__, "seconds": own["dense_seconds"]}
    return found


def moordyn(python: str) -> dict[str, float | str]:
    """Ten seconds of MoorDyn's own line of as many segments."""
    script = Path(__file__).with_name("moordyn_peer.py")
    done = subprocess.run([python, str(script), str(LINKS), "10"], capture_output=True, text=True, check=True)
    found: dict[str, float | str] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    results: dict[str, object] = {
        "machine": machine(),
        "versions": {name: version(name) for name in ("cablefmu", "fmpy", "numpy", "ziglang")},
        "per_link": rhs.per_link(),
        "table_6_6": table_6_6.rows(),
        "work_precision": work_precision.rows(),
        "overhead": overhead.rows(),
        "stiff": stiff.rows(),
        "growth": stiff.growth(),
        "automatic": automatic.rows(),
    }
    if len(sys.argv) > 1:
        results["peers"] = peers(sys.argv[1])
        results["moordyn"] = moordyn(sys.argv[1])
    Path("build").mkdir(exist_ok=True)
    for path in (
        "build/benchmarks.json",
        "docs/benchmarks.json",
    ):  # the second is kept, for the documentation
        Path(path).write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(tables(results))
    if "peers" in results:
        readme.main()


if __name__ == "__main__":
    main()
