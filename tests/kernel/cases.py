"""A random cable of a kind in a random state under random inputs, in the kernel and in the reference."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, replace

import numpy as np

from cablefmu.cable import Cable, Drag, Floats, Terminal
from cablefmu.reference import Reference
from cablefmu.shapes import end_point
from tests.kernel.library import Kernel
from tests.random_cables import KINDS, PORTS, random_cable, random_inputs, random_state

__all__ = ["Case", "aligned_case", "case", "heavy_case", "port_case"]


@dataclass(frozen=True)
class Case:
    """What to evaluate, twice."""

    cable: Cable
    q: Floats
    v: Floats
    inputs: dict[str, float]
    kernel: Kernel
    reference: Reference


def case(library: ctypes.CDLL, n: int, kind: int, *, draw: int = 0, **parameters: float) -> Case:
    """The `draw`-th case of KINDS[kind] with `n` links, `parameters` in place of the random ones."""
    terminal, water, drag = KINDS[kind]
    rng = np.random.default_rng([n, kind, draw])
    cable = random_cable(rng, n, terminal, water, drag=drag)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    cable = replace(cable, parameters=cable.parameters | parameters)
    return Case(cable, q, v, inputs, Kernel(library, cable), Reference(cable))


def port_case(library: ctypes.CDLL, n: int, kind: int, *, draw: int = 0) -> Case:
    """The `draw`-th case of PORTS[kind] with `n` links."""
    top, terminal, water, drag = PORTS[kind]
    rng = np.random.default_rng([n, kind, draw])
    cable = random_cable(rng, n, terminal, water, top=top, drag=drag)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    return Case(cable, q, v, inputs, Kernel(library, cable), Reference(cable))


def heavy_case(library: ctypes.CDLL, mass: float, draw: int) -> Case:
    """Twelve submerged links on a neutrally buoyant anchor of `mass` [kg]."""
    return case(library, 12, _submerged(Terminal.ANCHOR_MASS), draw=draw, m_c=mass)


def aligned_case(library: ctypes.CDLL, n: int, end: float | None, bend: float, *, draw: int = 0) -> Case:
    """Submerged links within `bend` [rad] of a line, behind a neutrally buoyant mass [kg] or (None) on a pin at P_n."""
    if end is None:
        c = case(library, n, _submerged(Terminal.PIN), draw=draw)
    else:
        c = case(library, n, _submerged(Terminal.ANCHOR_MASS), draw=draw, m_c=end)
    q = np.concatenate([c.q[:1], 0.7 + bend * np.random.default_rng(draw).uniform(-1.0, 1.0, n)])
    x, y = end_point(c.cable.links.length, q[1:])
    cable = replace(c.cable, rest_position=(x, y + float(q[0]))) if end is None else c.cable
    return replace(c, cable=cable, q=q, kernel=Kernel(library, cable), reference=Reference(cable))


def _submerged(terminal: Terminal) -> int:
    return KINDS.index((terminal, True, Drag.COEFFICIENT))
