"""A random cable of a kind in a random state under random inputs, in the kernel and in the reference."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, replace

import numpy as np

from cablefmu.cable import Cable, Floats
from cablefmu.reference import Reference
from tests.kernel.library import Kernel
from tests.random_cables import KINDS, random_cable, random_inputs, random_state

__all__ = ["Case", "case", "heavy_case"]


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


def heavy_case(library: ctypes.CDLL, mass: float, draw: int) -> Case:
    """Twelve submerged links on a neutrally buoyant anchor of `mass` [kg]."""
    kind = next(k for k, (terminal, water, _) in enumerate(KINDS) if terminal == "anchor-mass" and water)
    return case(library, 12, kind, draw=draw, m_c=mass)
