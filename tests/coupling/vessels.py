"""A vessel, a mass of 1 kg on a spring, and a load that is moved with it: motion goes one way, force the other.

The load's force depends at once on the vessel's acceleration, and that on the force: an algebraic loop, whose gain is
the ratio of their masses. Together they are one oscillator.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from cablefmu.cable import Floats
from cablefmu.coupling.description import Coupling

STIFFNESS, DAMPING, LOAD_STIFFNESS = 40.0, 1.0, 20.0
START = 0.5

_TEXT = """
[coupling]
stop_time = 2
step = {step}
algorithm = "{algorithm}"
extrapolation = {extrapolation}
{more}
[[model]]
name = "vessel"
fmu = "{mass}"
parameters = {{ m = 1, k = 40, c = 1, x_0 = 0.5 }}
[[model]]
name = "load"
fmu = "{follower}"
parameters = {{ m = {ratio}, k = 20 }}
[[connection]]
from = "vessel.x"
to = "load.x"
[[connection]]
from = "vessel.v"
to = "load.v"
[[connection]]
from = "vessel.a"
to = "load.a"
[[connection]]
from = "load.F"
to = "vessel.F"
delayed = {delayed}
"""


def vessel(
    slave: Callable[[str], Path], *, ratio: float, algorithm: str, extrapolation: int, step: float, more: str = "",
    delayed: bool = False,
) -> Coupling:  # fmt: skip
    """The coupling with a load of `ratio` kg."""
    text = _TEXT.format(
        mass=slave("mass"), follower=slave("follower"), ratio=ratio, algorithm=algorithm, extrapolation=extrapolation,
        step=step, more=more, delayed=str(delayed).lower(),
    )  # fmt: skip
    return Coupling.from_text(text, name="vessel")


def exact_vessel(times: Floats, ratio: float) -> Floats:
    """Displacement of both [m]: a damped oscillator let go."""
    mass = 1.0 + ratio
    decay = 0.5 * DAMPING / mass
    rate = np.sqrt((STIFFNESS + LOAD_STIFFNESS) / mass - decay**2)
    return np.asarray(START * np.exp(-decay * times) * (np.cos(rate * times) + decay / rate * np.sin(rate * times)))
