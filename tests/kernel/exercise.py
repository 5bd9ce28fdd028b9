"""The kernel put through its paces in a process of its own, where it may crash.

`python -m tests.kernel.exercise LIBRARY` prints "done" at the end. The library may be one that traps on
undefined behaviour.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from cablefmu.cable import SolverChoice
from tests.kernel.cases import case
from tests.kernel.library import inputs_of, load
from tests.random_cables import KINDS


def exercise(path: Path) -> None:
    """All that the kernel does with random cables of every kind, by every solver; sines beyond their range."""
    library = load(path)
    for n in (1, 2, 3, 12, 60):
        for kind in range(len(KINDS)):
            c = case(library, n, kind)
            c.kernel.outputs(c.q, c.v, c.inputs)
            c.kernel.outputs_without_tensions(c.q, c.v)
            x, u = np.concatenate([c.q, c.v]), inputs_of(c.inputs)
            c.kernel.directional(x, u, np.ones_like(x), np.ones_like(u))
            for weights in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, 30.0, 900.0)):
                c.kernel.linear(x, u, np.array(weights), np.ones(n + 1), np.ones(2))
            for solver in SolverChoice:
                c.kernel.start(0.0, c.q, c.v, tolerance=1e-4, solver=solver)
                c.kernel.advance(0.1, {name: (force, force, 3.0) for name, force in c.inputs.items()})
                c.kernel.advance(0.15, {})
                c.kernel.advance(0.2, {})
    c = case(library, 3, 0)
    for wild in (1e30, np.inf, np.nan):
        for solver in SolverChoice:
            c.kernel.start(0.0, c.q, np.full(4, wild), tolerance=1e-4, solver=solver)
            c.kernel.advance(0.1, {})
    x = np.concatenate([np.linspace(-2e6, 2e6, 100_001), [1e300, np.inf, np.nan]])
    library.sincos_array_portable(len(x), x, np.empty_like(x), np.empty_like(x))
    wild_numbers = np.array([0.0, 5e-324, 1e-300, 1.0, 1e300, np.inf, np.nan])
    for length, weight, place in np.stack(np.meshgrid(*[wild_numbers] * 3), axis=-1).reshape(-1, 3):
        end = np.array([place, 0.5 * place])
        library.catenary(3, np.full(3, length), np.full(3, weight), end, np.empty(3), np.empty(2))
    for value in (5e-324, 1e-300, 1.0, 1e300, np.inf, np.nan):
        library.fifth_root(value)


if __name__ == "__main__":
    exercise(Path(sys.argv[1]))
    print("done")
