"""Every scene in one way of one host, and how far off it ends."""

from __future__ import annotations

import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cablefmu.fmu.archive import build_fmu
from cablefmu.scene import load_scene
from cablefmu.signals import Constant
from tests.hosts.catalogue import SCENES, SHORT, Way
from tests.hosts.environments import INSIDE, interpreter
from tests.hosts.expected import OUTPUTS, jacobian, start_and_end

__all__ = ["Outcome", "ask", "outcomes"]

_PATIENCE = 180
"""[s] for one scene."""
_TOLERANCE = 1e-8
"""Of hosts' adaptive solvers, relative and absolute."""


@dataclass(frozen=True)
class Outcome:
    """One scene in one way."""

    scene: str
    version: str
    """Of the host, as its package says."""
    error: float | None
    """Largest over `OUTPUTS` [m], or over the Jacobian, of its largest entry; None where nothing was compared."""
    allowed: float
    said: str
    """A refusal, or a checker's complaints; else empty."""


def outcomes(way: Way, folder: Path) -> list[Outcome]:
    """The FMUs are built in `folder` once, so that the same file goes to every host.

    Raises
    ------
    RuntimeError
        A host that cannot be installed, crashes, or leaves the FMU changed.
    """
    return [_outcome(way, scene, _fmu(scene, way.fmi, folder)) for scene in SCENES]


def _fmu(scene: str, fmi: int, folder: Path) -> Path:
    path = folder / f"{scene}-{fmi}.fmu"
    return path if path.exists() else build_fmu(load_scene(scene), path, fmi=fmi)


def _outcome(way: Way, scene: str, fmu: Path) -> Outcome:
    loaded, content = load_scene(scene), fmu.read_bytes()
    varying = {name: signal for name, signal in loaded.signals.items() if not isinstance(signal, Constant)}
    times = [k * SHORT for k in range(round(loaded.stop_time / SHORT) + 1)]
    which = 1 if varying else 0
    said = ask(way.host, {
        **way.ask, "fmu": str(fmu), "fmi": way.fmi, "stop": loaded.stop_time, "step": way.step[which],
        "tolerance": _TOLERANCE, "outputs": OUTPUTS,
        "forces": {name: {"times": times, "values": [signal(t) for t in times]} for name, signal in varying.items()},
    })  # fmt: skip
    if fmu.read_bytes() != content:
        raise RuntimeError(f"{way.host} changed {fmu.name}: others would not get the same file.")
    words = said.get("refused", "") or "; ".join(said.get("complaints", []))
    if said.get("checkers") == []:
        raise RuntimeError(f"{way.host} has no checker: that nothing was found says nothing.")
    return Outcome(scene, said["version"], None if words else _error(scene, said), way.allowed[which], words)


def ask(host: str, request: dict[str, Any]) -> dict[str, Any]:
    """What the host's script answers, see inside/exchange.py.

    Raises
    ------
    RuntimeError
        If the host cannot be installed, or its process ends in an error.
    """
    with tempfile.TemporaryDirectory() as name:
        asked, told = Path(name, "request.json"), Path(name, "answer.json")
        asked.write_text(json.dumps(request), "utf-8")
        command = [str(interpreter(host)), str(INSIDE / f"{host}.py"), str(asked), str(told)]
        done = subprocess.run(command, cwd=name, capture_output=True, text=True, timeout=_PATIENCE)
        if done.returncode:
            raise RuntimeError(f"{host} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        found: dict[str, Any] = json.loads(told.read_text("utf-8"))
        return found


def _error(scene: str, said: dict[str, Any]) -> float | None:
    if "jacobian" in said:
        exact = jacobian(scene, said["states"], said["state"], said["inputs"])
        return float(np.abs(np.array(said["jacobian"]) - exact).max() / np.abs(exact).max())
    if "end" not in said:
        return None
    stop = load_scene(scene).stop_time
    if abs(said["time"] - stop) > 1e-9:
        raise RuntimeError(f"the host ended at {said['time']} s instead of {stop} s.")
    end = start_and_end(scene)[1]
    return max(abs(said["end"][name] - end[name]) for name in OUTPUTS)
