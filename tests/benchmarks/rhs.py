"""Nanoseconds per link of one right-hand side."""

from __future__ import annotations

import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cablefmu.cable import Cable, Drag, Links, Terminal
from cablefmu.reference import Reference
from cablefmu.scene import Scene, load_scene
from tests.benchmarks.chain import Chain, chain
from tests.kernel.library import Kernel, compile_kernel, inputs_of, load

__all__ = ["bare_cable", "per_link", "single"]

SIZES = (12, 120, 1_000, 10_000)
BUDGET = 2_000_000  # links evaluated per round


def bare_cable(c: Chain) -> Cable:
    """The peers' chain as a cable: air, no springs and dampers."""
    ones, zeros = np.ones(c.n), np.zeros(c.n)
    links = Links(c.length * ones, c.mass * ones, c.inertia * ones, zeros, zeros, zeros, zeros, zeros)
    parameters = {
        "g": c.gravity,
        "M_1": c.floater,
        "k_m1": 0.0,
        "c_m1": 0.0,
        "static_load": -c.floater * c.gravity,
        "m_c": c.load,
    }
    return Cable(
        "bare", links, Terminal.LOAD, Drag.NONE, parameters, ("u_m1",), np.array([0.0, *c.theta]), np.zeros(c.n + 1)
    )


def water_cable(n: int) -> Cable:
    """free-60-water with `n` links: drag, buoyancy, joint springs and dampers."""
    text = load_scene("free-60-water").text.replace("links = 60", f"links = {n}")
    return Scene.from_text(text, name=f"free-{n}-water").cable


def seconds(kernel: Kernel, c: Chain, repeats: int) -> tuple[float, float]:
    """Of one evaluation, and of its sines and its elimination alone; the best of seven rounds, taken in turns."""
    x, u, best = np.array([0.0, *c.theta, 0.0, *c.omega]), inputs_of({}), [float("inf")] * 2
    for _ in range(7):
        for k, call in enumerate((kernel.repeat, kernel.repeat_core)):
            begun = time.perf_counter()
            call(x, u, repeats)
            best[k] = min(best[k], (time.perf_counter() - begun) / repeats)
    return best[0], best[1]


def _library(folder: str):  # type: ignore[no-untyped-def]
    return load(compile_kernel(Path(folder)))


def per_link() -> list[dict[str, float | str]]:
    """Rows: links, variant, nanoseconds per link of the submerged cable, and those of sines and elimination alone."""
    rows: list[dict[str, float | str]] = []
    with tempfile.TemporaryDirectory() as folder:
        library = _library(folder)
        for n in SIZES:
            kernel, c = Kernel(library, water_cable(n)), chain(n)
            for wide in (True, False):
                if kernel.use_avx2(wide) is wide:
                    cost, core = (1e9 / n * value for value in seconds(kernel, c, BUDGET // n))
                    variant = "AVX2" if wide else "portable"
                    rows.append({"links": n, "variant": variant, "ns_per_link": cost, "core_ns_per_link": core})
    return rows


def single(n: int, span: float) -> dict[str, Any]:
    """The peers' chain in the kernel, as peers.py reports it, and seconds of the dense reference."""
    c = chain(n)
    cable = bare_cable(c)
    with tempfile.TemporaryDirectory() as folder:
        kernel = Kernel(_library(folder), cable)
        q, v = np.array([0.0, *c.theta]), np.array([0.0, *c.omega])
        found = kernel.acceleration(q, v, {}).tolist()
        cost, _ = seconds(kernel, c, BUDGET // n)
        motions = [
            motion(kernel, replace(cable, velocity=v), span, tolerance) for tolerance in (1e-4, 1e-6, 1e-8, 1e-12)
        ]
    reference = Reference(replace(cable))
    begun = time.perf_counter()
    for _ in range(50):
        reference.acceleration(q, v, {})
    dense = (time.perf_counter() - begun) / 50
    return {"seconds": cost, "accelerations": found, "motions": motions, "dense_seconds": dense}


def motion(kernel: Kernel, cable: Cable, span: float, tolerance: float) -> dict[str, Any]:
    """CPU seconds (best of five) of one motion, and where the load ends [m]."""
    best, end = float("inf"), np.empty(0)
    for _ in range(5):
        kernel.start(0.0, cable.position, cable.velocity, tolerance=tolerance)
        begun = time.process_time()
        end = kernel.advance(span, {}).q
        best = min(best, time.process_time() - begun)
    length, theta = cable.links.length, end[1:]
    place = [float(np.sum(length * np.sin(theta))), float(end[0] + np.sum(length * np.cos(theta)))]
    return {"setting": f"explicit, {tolerance:g}", "seconds": best, "end": place}
