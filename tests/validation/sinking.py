"""A straight cable in drag balance: it sinks crosswise, and it is driven down at the critical angle."""

from __future__ import annotations

import ctypes

import numpy as np

from cablefmu.cable import Floats
from tests.kernel.library import Kernel
from tests.validation.cables import FIXED, GRAVITY, sinking_cable
from tests.validation.checks import Check, Section
from tests.validation.motion import linearise

__all__ = ["depths", "sections", "terminal_speed"]

STEEL, WATER, DIAMETER = 7850.0, 1000.0, 0.02
"""[kg/m^3], [kg/m^3], [m]"""


SOLVER = 1e-9
"""[m, m/s]: ten times the solver's tolerance of 1e-10, for what its steps add up to"""


def terminal_speed() -> float:
    """sqrt(2 w / (rho Cd D)) of the cable crosswise, Cd = 1, w its submerged weight per metre [m/s]."""
    weight = (STEEL - WATER) * np.pi * DIAMETER**2 / 4.0 * GRAVITY
    return float(np.sqrt(2.0 * weight / (WATER * 1.0 * DIAMETER)))


def depths(times: Floats) -> tuple[Floats, Floats]:
    """Depth [m] and speed [m/s], at `times` [s], of a body that falls from rest against c v^2.

    v = V tanh(t/s), where s is V over the first acceleration.
    """
    speed = terminal_speed()
    settling = speed / (GRAVITY * (1.0 - WATER / STEEL))
    return speed * settling * np.log(np.cosh(times / settling)), speed * np.tanh(times / settling)


def sections(library: ctypes.CDLL) -> list[Section]:
    return [_sinking(library), _critical(library)]


def _sinking(library: ctypes.CDLL) -> Section:
    times = np.array([0.0, 0.05, 0.1, 0.2, 0.5, 3.0])
    runs = Kernel(library, sinking_cable(12)).run(times, tolerance=1e-10)
    depth, speed = depths(times[1:])
    checks = []
    for k, run in enumerate(runs):
        checks.append(Check(f"speed after {run.time:g} s", "m/s", speed[k], run.v[0], SOLVER))
        checks.append(Check(f"depth after {run.time:g} s", "m", depth[k], run.q[0], SOLVER))
    checks.append(Check("terminal speed (after 3 s)", "m/s", terminal_speed(), runs[-1].v[0], SOLVER))
    return Section(
        "A level cable sinks",
        "v = V tanh(t/s), V = sqrt(2w/(rho C_d D)), s = V/(g (1 - rho_w/rho)): a body falling against the "
        "square of its speed, any textbook. D = 2 cm, steel, C_d = 1.",
        "The same model: 12 links released level, free at both ends (1e-12 kg there), drag normal to the "
        "links, no added mass. The tolerance is ten times the solver's.",
        tuple(checks),
    )


def _critical(library: ctypes.CDLL) -> Section:
    checks: list[Check] = []
    for ratio in (1.2, 2.0, 4.0):
        for n in (1, 12):
            checks += _driven(library, ratio, n)
    return Section(
        "A cable driven down at the critical angle",
        "w sin(th) = 1/2 rho C_d D U² sin²(th), so sin(th) = (V/U)²: weight and drag across a straight "
        "towed cable in balance (the critical angle of towed cables, here with the tow vertical, as the "
        "model's top only heaves and its water is at rest). The pull is w L cos(th). One link off the "
        "angle: m l²/3 th'' = l²/2 (-w sin(th) + c U² sin²(th)), of slope l²/2 w cos(th), so the balance is "
        "unstable.",
        "The same model, and rounding. The floater of 1e15 kg is not driven, it just goes on; it yields to "
        "5 kN, which takes up to 3e-9 N off the pull: the 592 kg of the cable times 5e-12 m/s². The slope "
        "is a difference over 1e-5 rad.",
        tuple(checks),
    )


def _driven(library: ctypes.CDLL, ratio: float, n: int) -> list[Check]:
    """A cable whose top goes down at `ratio` times the terminal speed."""
    weight = (STEEL - WATER) * np.pi * DIAMETER**2 / 4.0 * GRAVITY
    angle = float(np.arcsin(1.0 / ratio**2))
    cable = sinking_cable(n, angle=angle, M_1=FIXED)
    kernel, length = Kernel(library, cable), cable.links.length.sum()
    q, v = cable.position, np.concatenate([[ratio * terminal_speed()], np.zeros(n)])
    turning = np.abs(kernel.acceleration(q, v, {})[1:]).max()
    tension = kernel.outputs(q, v, {})["tension_top"]
    name = f"U = {ratio:g} V, {n} link{'s' if n > 1 else ''}: "
    checks = [
        Check(name + "largest th''", "rad/s²", 0.0, float(turning), 1e-12),
        Check(name + "`tension_top`", "N", weight * length * np.cos(angle), tension, 1e-8),
    ]
    if n == 1:
        slope = 1.5 * weight * np.cos(angle) / cable.links.mass[0]
        found = linearise(kernel, q, v, step=1e-5)[0, 0]
        checks.append(Check(name + "dth''/dth", "1/s²", slope, found, 1e-8 * slope))
    return checks
