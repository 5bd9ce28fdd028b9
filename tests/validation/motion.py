"""Frequencies of the kernel's small motions, times of its zero crossings, and its rest states."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from cablefmu.cable import Floats
from tests.kernel.library import Kernel

__all__ = ["crossings", "frequencies", "linearise", "rest"]

STEP = 1e-8
"""Difference step [rad]. At rest every term is zero and grows with the step, so rounding is relative and a short step
costs no digits; what it leaves out is STEP^2 times the stiffening of a chain whose links are bent one by one, a
factor up to 1e5 at 120 links: below 1e-11."""


def linearise(
    kernel: Kernel,
    q: Floats,
    v: Floats | None = None,
    inputs: Mapping[str, float] | None = None,
    *,
    step: float = STEP,
) -> Floats:
    """d th'' / d th about `q` (at rest unless `v` is given), shape (n, n) [1/s^2], by central differences."""
    rates, shift = np.zeros_like(q) if v is None else v, step * np.eye(len(q))[1:]
    ahead, behind = (
        np.array([kernel.acceleration(q + sign * by, rates, inputs or {})[1:] for by in shift]) for sign in (1.0, -1.0)
    )
    return np.asarray((ahead - behind).T / (2.0 * step))


def frequencies(kernel: Kernel) -> tuple[Floats, Floats]:
    """Pulsations [rad/s] of small motions about hanging straight, ascending, and their shapes in columns."""
    squares, shapes = np.linalg.eig(-linearise(kernel, np.zeros(kernel.cable.n + 1)))
    order = np.argsort(squares.real)
    assert np.abs(squares.imag).max() <= 1e-9 * np.abs(squares).max()
    return np.sqrt(squares.real[order]), shapes.real[:, order]


def crossings(
    kernel: Kernel,
    observe: Callable[[Floats, Floats], tuple[float, float]],
    step: float,
    count: int,
    *,
    tolerance: float,
) -> Floats:
    """The first `count` times [s] at which an observed value is zero.

    `observe(q, v)` gives the value and its rate. Signs are looked at every `step` [s]; from the sample before a
    change the solver is sent to the crossing by Newton.
    """

    def sample(time: float, q: Floats, v: Floats, end: float) -> tuple[Floats, Floats]:
        kernel.start(time, q, v, tolerance=tolerance)
        run = kernel.advance(end, {})
        assert run.status == "ok"
        return run.q, run.v

    found: list[float] = []
    time, q, v, k = 0.0, kernel.cable.position, kernel.cable.velocity, 0
    while len(found) < count:
        k += 1
        later = sample(time, q, v, k * step)
        before, after = observe(q, v)[0], observe(*later)[0]
        if before * after < 0.0:
            crossing = time + step * before / (before - after)
            for _ in range(4):
                value, rate = observe(*sample(time, q, v, crossing))
                crossing -= value / rate
            found.append(crossing)
        time, (q, v) = k * step, later
    return np.array(found)


def rest(kernel: Kernel, guess: Floats, inputs: Mapping[str, float]) -> Floats:
    """q with y_m = 0 at which no link accelerates, by Newton on the kernel's accelerations from `guess`."""
    q, still = guess.copy(), np.zeros_like(guess)
    for _ in range(30):
        residual = kernel.acceleration(q, still, inputs)[1:]
        step = np.linalg.solve(linearise(kernel, q, inputs=inputs, step=1e-5), residual)
        q[1:] -= step
        if np.abs(step).max() < 1e-10:
            return q
    raise AssertionError("no rest state found")
