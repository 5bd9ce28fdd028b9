"""The self-check of `cablefmu doctor`: a small scene through every interface, and a coupling with a Python partner.

What is computed is compared with what shares no code with it: the dissertation's dense matrices under scipy. It
runs in a process of its own, as a damaged library may take its process along.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from multiprocessing.connection import Connection

import numpy as np

from .doctor import Finding
from .errors import CableError

__all__ = ["COUPLING", "SCENE", "Check", "run_apart", "self_check"]

SCENE = "free-12-water"
STOP = 2.0
"""[s] In which the terminal moves by metres."""
AGREEMENT = 1e-5
"""[m] as for all scenes that ship, over their whole runs; measured 8e-9 (Co-Simulation), 3e-7 (CVode)."""
COUPLING = "moored-vessel"
COUPLED = 5e-3
"""[m] Of Gauss-Seidel steps of 0.1 s with linear inputs; measured 3e-4 over 2 s, 8e-4 over 16 s (docs/coupling.md)."""
LIMIT = 120.0
"""[s] after which a check is given up: on a quiet machine all of them take a few."""

Check = tuple[str, float, Callable[[], float]]
"""What it is called, the error that is allowed [m], and what measures the error."""


def self_check() -> Iterator[Finding]:
    """Build, run and compare; a check that fails does not hide the next."""
    interfaces = [(fmi, *words) for fmi in (2, 3) for words in (("cs", "Co-Simulation"), ("me", "Model Exchange"))]
    checks: list[Check] = [
        (f"FMI {fmi}, {words}", AGREEMENT, partial(scene_error, fmi, interface)) for fmi, interface, words in interfaces
    ]
    yield from run_apart([*checks, ("coupled with a Python partner", COUPLED, coupling_error)])


def scene_error(fmi: int, interface: str) -> float:
    """How far the terminal of the scene's FMU ends from the dense model's [m]."""
    from .reference import integrate
    from .scene import load_scene
    from .simulate import simulate

    scene = load_scene(SCENE)
    run = simulate(scene, fmi=fmi, interface=interface, stop_time=STOP, tolerance=1e-8)
    held = {name: signal(0.0) for name, signal in scene.signals.items()}
    dense = integrate(scene.cable, lambda _: held, (0.0, STOP), rtol=1e-9, atol=1e-10)
    return float(np.hypot(*(run[name].values[-1] - dense.outputs[name][-1] for name in ("x_c", "y_c"))))


def coupling_error() -> float:
    """How far vessel and terminal are at most from both in one system [m]."""
    from .coupling.description import load_coupling
    from .coupling.run import run_system
    from .coupling.system import opened, varied
    from .coupling_report_truth import find_truth

    with opened(load_coupling(COUPLING)) as system:
        short = varied(system, stop_time=STOP)
        run = run_system(short)
        exact = find_truth(short).at(run["time"].values)
        return max(float(np.abs(run[name].values - values).max()) for name, values in exact.items())


def run_apart(checks: Sequence[Check], limit: float = LIMIT) -> Iterator[Finding]:
    """Run them one after the other in another process; in a new one after a check that took its process along."""
    context = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang
    left = list(checks)
    while left:
        reader, writer = context.Pipe(duplex=False)
        process = context.Process(target=_serve, args=(writer, [check for _, _, check in left]), daemon=True)
        process.start()
        writer.close()
        is_alive = True
        while left and is_alive:
            what, allowed, _ = left.pop(0)
            answer = _answer(reader, limit)
            is_alive = answer is not None
            yield _judged(what, allowed, answer, limit)
        process.kill()
        process.join()
        reader.close()


def _serve(pipe: Connection, checks: Sequence[Callable[[], float]]) -> None:
    """In the process: the error of each check, or why there is none."""
    for check in checks:
        try:
            pipe.send(check())
        except CableError as reason:
            pipe.send(str(reason))
        except Exception as reason:  # whatever a machine has in store is told, and the next check goes on
            pipe.send(f"{type(reason).__name__}: {reason}")


def _answer(pipe: Connection, limit: float) -> float | str | None:
    """None if there is none in time, or the process died."""
    try:
        return pipe.recv() if pipe.poll(limit) else None
    except EOFError:
        return None


def _judged(what: str, allowed: float, answer: float | str | None, limit: float) -> Finding:
    if answer is None:
        return Finding("self-check", what, "died", f"{what}: its process died, or had no end in {limit:g} s")
    if isinstance(answer, str):
        return Finding("self-check", what, "failed", f"{what}: {answer}")
    said = f"{answer:.1g} m from the dense model ({allowed:g} allowed)"
    return Finding("self-check", what, said, None if answer <= allowed else f"{what}: {said}")
