"""`python -m tests.benchmarks.hosts PYTHON`: a stiff cable in implicit hosts, with our derivatives and by differences.

PYTHON is an interpreter that has the hosts: `pip install casadi scikit-sundae fmpy` in an environment of its own. It
prints the table of docs/derivatives.md.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import cablefmu
from tests.benchmarks.stiff import Case

__all__ = ["rows"]

CASES = (Case("EI = 1e5", 60, 1e5, 0.0, {"F_cx": 200.0}), Case("EI = 1e7", 60, 1e7, 0.0, {"F_cx": 200.0}))
"""60 links that a force pulls sideways from rest."""
TOLERANCES = (1e-5, 1e-6, 1e-8)
SPAN = 10.0
"""[s]"""


def end_of(row: dict[str, Any], links: int) -> tuple[float, float]:
    """Where the terminal ends [m]; casadi tells the states."""
    if "x" in row:
        return row["x"], row["y"]
    state = dict(zip(row["names"], row["state"], strict=True))
    angles = np.array([state[f"theta[{i}]"] for i in range(1, links + 1)])
    length = 240.0 / links
    return float(length * np.sin(angles).sum()), float(state["y_m1"] + length * np.cos(angles).sum())


def steps_of(row: dict[str, Any]) -> str:
    """Steps and failures, where the host tells; else the evaluations that no Jacobian needed."""
    if "stats" in row:
        return f"{row['stats']['nsteps']} steps, {row['stats']['netfails']} failed"
    if "steps" in row:
        return f"{row['steps']:.0f} steps, {row['rejected']:.0f} failed"
    return f"{row['newton']} evaluations"


def rows(python: str) -> list[dict[str, Any]]:
    """Case, tolerance, host and Jacobian -> steps, Jacobians, CPU seconds, error against tolerance 1e-10 [m]."""
    script = Path(__file__).with_name("hosts_peer.py")
    found = []
    for case in CASES:
        with tempfile.TemporaryDirectory() as name:
            path = cablefmu.build_fmu(case.scene, Path(name) / "stiff.fmu")
            for tolerance in TOLERANCES:
                command = [python, str(script), str(path), str(SPAN), str(tolerance)]
                said = subprocess.run(command, capture_output=True, text=True, check=True)
                measured = json.loads(said.stdout)
                versions = measured.pop("versions")
                exact = end_of(measured.pop("reference"), case.links)
                for host, row in measured.items():
                    off = max(abs(a - b) for a, b in zip(end_of(row, case.links), exact, strict=True))
                    jacobians = row.get("jacobians", row.get("stats", {}).get("nlinsetups"))
                    found.append({
                        "case": case.name, "tolerance": tolerance, "host": host, "steps": steps_of(row),
                        "jacobians": jacobians, "seconds": row["seconds"], "error": off, "versions": versions,
                    })  # fmt: skip
    return found


def main() -> None:
    measured = rows(sys.argv[1])
    print(f"{measured[0]['versions']}\n")
    print(
        "| cable | tolerance | host, its Jacobian | | Jacobians | CPU [ms] | error [m] |\n|---|---|---|---|---|---|---|"
    )
    for row in measured:
        print(
            f"| {row['case']} | {row['tolerance']:g} | {row['host']} | {row['steps']} | {row['jacobians']:.0f} | "
            f"{1e3 * row['seconds']:.0f} | {row['error']:.0e} |"
        )


if __name__ == "__main__":
    main()
