"""Twenty scenes that no file holds: for what must work on a scene that nobody looked at before."""

from __future__ import annotations

import numpy as np

from cablefmu.cable import Terminal
from cablefmu.scene import Scene
from tests.kernel.library import Wave
from tests.kernel.motions import make_scene
from tests.random_cables import TERMINALS

__all__ = ["COUNT", "random_scene"]

COUNT = 20


def random_scene(number: int) -> tuple[Scene, dict[str, Wave]]:
    """Number 0 ... 19: every terminal in turn, 10 to 240 links, ropes to pipes, driven by 0.1 to 30 kN.

    Bending stiffness, which sets how fast the joints can vibrate, goes over seven orders of magnitude.
    """
    rng = np.random.default_rng([7, number])

    def spread(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    terminal = TERMINALS[number % len(TERMINALS)]
    scene = make_scene(
        terminal,
        int(spread(10.0, 241.0)),
        length=spread(50.0, 500.0),
        diameter=spread(0.005, 0.05),
        bending=spread(1.0, 1e7),
        damping=spread(0.1, 100.0),
        angle=rng.uniform(-0.8, 0.8) if terminal is Terminal.LOAD else None,
        end=(rng.uniform(0.2, 0.55), rng.uniform(0.5, 0.75)),
        water=bool(rng.random() < 0.7),
    )
    return scene, {"u_m1": (0.0, spread(100.0, 3e4), rng.uniform(0.5, 4.0))}
