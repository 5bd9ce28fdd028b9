"""What hosts must find: where the dense oracle ends a scene, and its Jacobian there by complex step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from cablefmu.cable import Floats
from cablefmu.reference import integrate
from cablefmu.reference.model import Reference
from cablefmu.scene import load_scene

__all__ = ["OUTPUTS", "jacobian", "start_and_end"]

OUTPUTS = ("x_c", "y_c", "y_m1")
"""[m] Terminal and floater."""

_STEP = 1e-30
"""Of the complex step: no difference is taken, so none is lost."""


@cache
def start_and_end(scene: str) -> tuple[dict[str, float], dict[str, float]]:
    """`OUTPUTS` at time 0 and at the stop time [m]."""
    loaded = load_scene(scene)
    motion = integrate(
        loaded.cable,
        lambda t: {name: signal(t) for name, signal in loaded.signals.items()},
        (0.0, loaded.stop_time),
        breaks=[t for signal in loaded.signals.values() for t in signal.breaks(0.0, loaded.stop_time)],
        rtol=1e-9,
        atol=1e-10,
    )
    start, end = ({name: float(motion.outputs[name][k]) for name in OUTPUTS} for k in (0, 1))
    return start, end


def jacobian(scene: str, states: Sequence[str], values: Sequence[float], inputs: Mapping[str, float]) -> Floats:
    """d(der(states))/d(states), shape (2 n + 2, 2 n + 2), rows and columns in the order of `states`."""
    cable = load_scene(scene).cable
    links = range(1, cable.n + 1)
    ours = ["y_m1", *(f"theta[{i}]" for i in links), "v_m1", *(f"omega[{i}]" for i in links)]
    place = [states.index(name) for name in ours]
    reference, size = Reference(cable), cable.n + 1
    x = np.array(values)[place]
    matrix = np.zeros((2 * size, 2 * size))
    matrix[:size, size:] = np.eye(size)
    for k in range(2 * size):
        moved = x.astype(complex)
        moved[k] += 1j * _STEP
        matrix[size:, k] = reference.acceleration(moved[:size], moved[size:], inputs).imag / _STEP
    found = np.empty_like(matrix)
    found[np.ix_(place, place)] = matrix
    return found
