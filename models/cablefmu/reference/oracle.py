"""Trajectories to compare with: the dense reference under scipy's integrators, at tight tolerances."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from cablefmu.cable import Cable, Floats
from cablefmu.errors import OptionError, RunError
from cablefmu.reference.model import Reference

__all__ = ["Inputs", "Trajectory", "integrate"]

Inputs = Callable[[float], Mapping[str, float]]
"""The inputs by name [N; m, m/s, m/s^2] at a time [s]; at a jump, the value after it. A given motion's velocity and
acceleration are inputs like its position: they must be its derivatives."""


@dataclass(frozen=True)
class Trajectory:
    """A motion at the times that were asked for."""

    times: Floats
    """[s], shape (m,)"""
    q: Floats
    """As `Cable.position` [m, rad], shape (m, coordinates)"""
    v: Floats
    """dq/dt [m/s, rad/s], likewise"""
    outputs: dict[str, Floats]
    """The FMU's outputs by name, each of shape (m,)"""


def integrate(
    model: Reference | Cable,
    inputs: Inputs,
    times: Iterable[float],
    *,
    breaks: Iterable[float] = (),
    method: Any = "DOP853",
    rtol: float = 1e-10,
    atol: float = 1e-12,
) -> Trajectory:
    """The motion from the cable's start state at `times[0]`.

    Parameters
    ----------
    model
        The reference model, or a cable to make one of with its default rules.
    inputs
        Inputs as a function of time, continuous from the right.
    times
        Increasing times [s]; the first is the start. The integrator steps onto each of them, so that
        no interpolation adds to the error.
    breaks
        Times at which an input, or a derivative that matters, jumps: steps end on them too, and what
        comes before sees only the values before.
    method, rtol, atol
        As for `scipy.integrate.solve_ivp`; "Radau" or "BDF" for stiff cables.

    Raises
    ------
    OptionError
        Times that do not increase or are not finite.
    RunError
        The integrator gave up; `partial` holds the trajectory up to then.
    """
    reference = model if isinstance(model, Reference) else Reference(model)
    wanted = np.array(list(times), dtype=float)
    if wanted.size == 0 or not np.all(np.isfinite(wanted)) or np.any(np.diff(wanted) <= 0):
        raise OptionError("times must be finite and increasing, the first of them being the start.")
    inside = [t for t in breaks if wanted[0] < t < wanted[-1]]
    marks = np.union1d(wanted, np.array(inside, dtype=float))

    state = np.concatenate([reference.cable.position, reference.cable.velocity])
    states = {marks[0]: state}
    step: float | None = None
    for start, stop in pairwise(marks):
        piece = solve_ivp(
            _right_side(reference, inputs, stop),
            (start, stop),
            state,
            method=method,
            rtol=rtol,
            atol=atol,
            first_step=None if step is None else min(step, stop - start),
        )
        if not piece.success or not np.all(np.isfinite(piece.y[:, -1])):
            reached = wanted[[t in states for t in wanted]]
            message = f"The reference integration ended at {piece.t[-1]:.6g} s: {piece.message}"
            partial = _trajectory(reference, inputs, reached, states)
            raise RunError(message, time=float(piece.t[-1]), partial=partial)
        state, step = piece.y[:, -1], float(np.diff(piece.t).max())
        states[stop] = state
    return _trajectory(reference, inputs, wanted, states)


def _right_side(reference: Reference, inputs: Inputs, stop: float) -> Callable[[float, Floats], Floats]:
    """(q, v)' before `stop`: a step that ends there must not see an input that jumps there."""
    before, size = float(np.nextafter(stop, -np.inf)), reference.chain.coordinates

    def right_side(t: float, state: Floats) -> Floats:
        if not np.all(np.isfinite(state)):
            return np.full_like(state, np.nan)  # a trial step that went too far: refused, then shortened
        q, v = state[:size], state[size:]
        return np.concatenate([v, reference.acceleration(q, v, inputs(min(t, before)))])

    return right_side


def _trajectory(reference: Reference, inputs: Inputs, times: Floats, states: Mapping[float, Floats]) -> Trajectory:
    size = reference.chain.coordinates
    table = np.array([states[t] for t in times])
    q, v = table[:, :size], table[:, size:]
    rows = [reference.outputs(q[k], v[k], inputs(float(t))) for k, t in enumerate(times)]
    return Trajectory(times, q, v, {name: np.array([row[name] for row in rows]) for name in rows[0]})
