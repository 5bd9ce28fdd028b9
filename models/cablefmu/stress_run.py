"""One run of a stress case in a process of its own, where it may hang or crash without harm.

Several runs share a process as long as they behave: starting one costs a second.
"""

from __future__ import annotations

import math
import multiprocessing
import time as clock
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection
from pathlib import Path
from pickle import UnpicklingError
from signal import Signals
from typing import Any

import numpy as np
import xarray as xr

from .along import node_positions
from .cable import Floats, Initial
from .errors import CableError, OptionError, RunError, UserError
from .fmu.archive import build_fmu
from .fmu.platforms import for_this_machine
from .scene import Scene
from .simulate import simulate
from .stress_accelerations import acceleration_share
from .stress_grid import Case

__all__ = ["ACCELERATIONS", "Answer", "Request", "Worker"]

DENSE = ("DOP853", "Radau")
ACCELERATIONS = "accelerations"
_LEAVING = 5.0  # seconds that a process may take to end when asked
_STARTING = 120.0  # seconds that it may take to load the package, on a machine that is busy


@dataclass(frozen=True)
class Request:
    """What to run: a case, as it stands but for what is given here."""

    case: Case
    fmu: Path
    """Its FMU; made if it is not there yet."""
    solver: str | None = None
    """"explicit" or "implicit"; "DOP853" or "Radau": the dense reference under scipy; `ACCELERATIONS`: no motion, but
    those compared with the dense equation."""
    step: float | None = None
    """Communication step and output interval [s]."""
    tolerance: float | None = None
    nudge: float = 0.0
    """Random change of the start angles, its standard deviation [rad]."""


@dataclass(frozen=True)
class Answer:
    """What came of it."""

    outcome: str
    """"ended", "error" (a message of ours), "hang" or "crash"."""
    message: str = ""
    times: Floats = field(default_factory=lambda: np.empty(0))
    """[s]"""
    points: Floats = field(default_factory=lambda: np.empty(0))
    """Joints P_0 ... P_n, shape (times, n + 1, 2) [m]; up to an error, if there was one."""
    seconds: float = 0.0
    """What the run took, without preparations."""
    figures: Mapping[str, float] = field(default_factory=dict)
    """Steps, rejected, rhs, ... of the solver; "implicit", the share of output intervals that ended so; "force", the
    largest in the cable or on it [N]; "accelerations", their error over what is allowed."""
    facts: Mapping[str, float] = field(default_factory=dict)
    """Of the scene: n, length [m], stop_time [s], step [s], tolerance."""


class Worker:
    """A process that runs what it is asked to, one thing at a time."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Connection | None = None

    def ask(self, request: Request, limit: float) -> Answer:
        """The answer, or a hang after `limit` seconds."""
        try:
            if self._pipe is None:
                self._begin()
            assert self._pipe is not None
            self._pipe.send(request)
            if self._pipe.poll(limit):
                answer: Answer = self._pipe.recv()
                return answer
        except TimeoutError:
            self._kill()
            return Answer("hang", f"the worker was not ready after {_STARTING:g} s")
        except (EOFError, OSError, UnpicklingError):  # it died, perhaps in the middle of an answer
            return Answer("crash", f"the worker died: {_cause(self._kill())}")
        self._kill()
        return Answer("hang", f"no end after {limit:g} s", seconds=limit)

    def close(self) -> None:
        """End the process."""
        if self._pipe is not None:
            self._kill()

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=_serve, args=(other,), daemon=True)
        self._process.start()
        other.close()
        if not self._pipe.poll(_STARTING):
            raise TimeoutError
        self._pipe.recv()  # imports are done: limits count from here

    def _kill(self) -> int | None:
        assert self._pipe is not None
        self._process.kill()
        self._process.join(_LEAVING)
        self._pipe.close()
        self._pipe = None
        status: int | None = self._process.exitcode
        return status


def _cause(status: int | None) -> str:
    """An exit status in words."""
    if status is None or status >= 0:
        return f"it ended with status {status}"
    name = Signals(-status).name
    return f"killed by {name}" + (", by the system for want of memory perhaps" if name == "SIGKILL" else "")


def _serve(pipe: Connection) -> None:
    """In the process: answer requests until the pipe closes."""
    pipe.send("ready")
    while True:
        try:
            request = pipe.recv()
        except EOFError:
            return
        pipe.send(answer_to(request))


def answer_to(request: Request) -> Answer:
    """Run it here."""
    facts: dict[str, float] = {}
    try:
        scene = request.case.scene()
        facts = {
            "n": scene.cable.n, "length": float(np.sum(scene.cable.links.length)), "stop_time": scene.stop_time,
            "step": scene.step, "tolerance": scene.tolerance,
        }  # fmt: skip
        run = _accelerations if request.solver == ACCELERATIONS else _dense if request.solver in DENSE else _own
        return replace(run(request, scene), facts=facts)
    except CableError as error:
        partial = getattr(error, "partial", None)
        motion = _motion(partial) if isinstance(partial, xr.Dataset) else {}
        return Answer("error", _words(error), facts=facts, **motion)
    except Exception:
        return Answer("crash", traceback.format_exc(), facts=facts)


def _words(error: CableError) -> str:
    """What it says; of a run also when, if the message leaves that out."""
    text = " ".join(str(error).split())
    if isinstance(error, UserError) or "at t =" in text:
        return text
    time = error.time if isinstance(error, RunError) and error.time is not None else 0.0
    return f"at t = {time:g} s: {text}"


def _own(request: Request, scene: Scene) -> Answer:
    """The scene's FMU in FMPy."""
    parameters: dict[str, float | str] = {} if request.solver is None else {"solver": request.solver}
    if request.nudge:
        noise = np.random.default_rng(1).standard_normal(scene.cable.n)
        angles = scene.cable.position[1:] + request.nudge * noise
        parameters |= {f"theta[{k}]": float(angle) for k, angle in enumerate(angles, start=1)}
    if not request.fmu.exists():
        build_fmu(scene, request.fmu, fmi=request.case.fmi, platforms=for_this_machine())
    result = simulate(
        request.fmu, step=request.step, tolerance=request.tolerance, parameters=parameters, record=["theta"]
    )  # fmt: skip
    answer = Answer("ended", **_motion(result))
    pulls = (float(np.max(np.abs(result[name].values))) for name in ("tension_top", "tension_end", "tension_max"))
    return replace(answer, figures={**answer.figures, "force": max(*pulls, _largest_force(scene))})


def _largest_force(scene: Scene) -> float:
    """Of the inputs [N]; sampled, at a count that no sine of the grid is in step with."""
    times = np.linspace(0.0, scene.stop_time, 1009)
    return max((abs(signal(float(t))) for signal in scene.signals.values() for t in times), default=0.0)


def _accelerations(request: Request, scene: Scene) -> Answer:
    return Answer("ended", figures={"accelerations": acceleration_share(scene, request.fmu)})


def _motion(result: xr.Dataset) -> dict[str, Any]:
    figures = {name.removeprefix("solver_"): float(v) for name, v in result.attrs.items() if name.startswith("solver_")}
    if "solver.stiff" in result and result.sizes["time"] > 1:
        figures["implicit"] = float(np.mean(result["solver.stiff"].values[1:]))
    return {
        "times": result["time"].values,
        "points": np.stack(node_positions(result), axis=-1),
        "seconds": float(result.attrs.get("run_time", 0.0)),
        "figures": figures,
    }


def _dense(request: Request, scene: Scene) -> Answer:
    """The dissertation's matrices under scipy."""
    from .reference import integrate  # scipy's integrators take long to load, and most commands need none

    if scene.cable.initial is not Initial.SHAPE:
        raise OptionError("the dense reference has no equilibrium to start from")
    step, tolerance = request.step or scene.step, request.tolerance or scene.tolerance
    count = math.ceil(scene.stop_time / step * (1.0 - 1e-12))
    times = [k * step for k in range(count)] + [scene.stop_time]
    began = clock.perf_counter()
    with np.errstate(all="ignore"):  # a trial step may go too far; it is refused, then shortened
        motion = integrate(
            scene.cable,
            lambda t: {name: signal(t) for name, signal in scene.signals.items()},
            times,
            breaks=[t for signal in scene.signals.values() for t in signal.breaks(0.0, scene.stop_time)],
            method=request.solver, rtol=tolerance, atol=tolerance,
        )  # fmt: skip
    seconds = clock.perf_counter() - began
    theta = motion.q[:, 1:]
    along = np.stack([np.sin(theta), np.cos(theta)], axis=-1) * scene.cable.links.length[:, None]
    points = np.concatenate([np.zeros((len(times), 1, 2)), np.cumsum(along, axis=1)], axis=1)
    points[:, :, 1] += motion.q[:, :1]
    return Answer("ended", times=motion.times, points=points, seconds=seconds)
