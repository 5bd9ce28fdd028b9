"""Small motions of a hanging chain: rods, point masses, the limit of many links, a load at the end.

All as lambda = omega sqrt(L / g).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.integrate import quad
from scipy.special import jv, yv

from cablefmu.cable import Floats
from tests.kernel.library import Kernel
from tests.validation.cables import GRAVITY, hanging_chain
from tests.validation.checks import Check, Section, read_table
from tests.validation.motion import crossings, frequencies

__all__ = ["Chain", "leading_error", "sections"]

PRINTED = 1e-12
"""The last printed digit of the tables of rods and point masses"""
EXACT = 1e-10
"""Relative: the eigenvalue problem leaves some 1e-16 times the ratio of the largest squared pulsation to the one in
question, 1e5 at 120 links; with as much again for the differences."""


class Chain:
    """Frequencies of hanging chains in one kernel, each worked out once."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library
        self.lambdas = cache(self._lambdas)

    def _lambdas(self, n: int, ratio: float = 0.0, dumbbells: bool = False) -> Floats:
        cable = hanging_chain(n, ratio=ratio, dumbbells=dumbbells)
        pulsations, _ = frequencies(Kernel(self._library, cable))
        return np.asarray(pulsations * np.sqrt(cable.links.length.sum() / GRAVITY))

    def timed(self, n: int) -> float:
        """The first lambda, timed: released in its shape, the end's crossings of the middle over five periods."""
        cable = hanging_chain(n)
        kernel = Kernel(self._library, cable)
        pulsations, shapes = frequencies(kernel)
        cable.position[1:] = AMPLITUDE * shapes[:, 0] / np.abs(shapes[:, 0]).max()

        def end(q: Floats, v: Floats) -> tuple[float, float]:
            outputs = kernel.outputs(q, v, {})
            return outputs["x_c"], outputs["vx_c"]

        period = 2 * np.pi / pulsations[0]
        times = crossings(kernel, end, period / 16, 11, tolerance=1e-10)
        return float(10 * np.pi / (times[-1] - times[0]) * np.sqrt(cable.links.length.sum() / GRAVITY))


AMPLITUDE = 1e-3
"""Largest angle of the timed motion [rad]: finite swings slow it by AMPLITUDE^2 / 16 = 6e-8 if it were one link."""


def leading_error(lam: float, ratio: float) -> float:
    """c of lambda_n = lambda (1 + c / n^2 + ...) for rods, from the continuous chain's shape alone.

    Joints joined by straight rods are linear finite elements: the rods' kinetic energy is that of the
    piecewise linear shape, and as the pull T is linear along a link, so is the potential energy 1/2 int T y'^2.
    Rayleigh's quotient of interpolated shapes is too large by l^2/12 int T y''^2 / (int y^2 + ratio y_end^2) (Strang
    and Fix 1973, ch. 6); half of its share of lambda^2 is the share of lambda. With L = g = 1 and z the distance
    from the free end plus `ratio`, T = z and (z y')' + lambda^2 y = 0, so that y = C_0(2 lambda sqrt z),
    y'' = lambda^2 C_2(2 lambda sqrt z) / z; C is Bessel's J, and with a load the mix with Y that is 0 at the top.
    """
    top = 2.0 * lam * np.sqrt(1.0 + ratio)
    j, y = (1.0, 0.0) if ratio == 0.0 else (yv(0, top), -jv(0, top))

    def shape(order: int, z: float) -> float:
        x = 2.0 * lam * np.sqrt(z)
        return float(j * jv(order, x) + (y * yv(order, x) if y else 0.0))

    def integral(function: Callable[[float], float]) -> float:
        return float(quad(function, ratio, 1.0 + ratio, epsrel=1e-10, limit=200)[0])

    bending = lam**4 * integral(lambda z: shape(2, z) ** 2 / z)
    inertia = integral(lambda z: shape(0, z) ** 2) + ratio * shape(0, ratio) ** 2
    return bending / inertia / (24.0 * lam**2)


def sections(library: ctypes.CDLL) -> list[Section]:
    chain = Chain(library)
    return [_rods(chain), _points(chain), _bessel(chain), _loaded(chain), _timed(chain)]


def _exact(chain: Chain, column: str, dumbbells: bool) -> tuple[Check, ...]:
    checks = []
    for row in read_table("hanging_chain_frequencies"):
        n, mode = int(row["N"]), int(row["mode"])
        lam = chain.lambdas(n, 0.5 / n, True) if dumbbells else chain.lambdas(n)
        name = f"{n} link{'s' if n > 1 else ''}, mode {mode}"
        tolerance = EXACT * row[column] + PRINTED
        shown = mode in (1, min(n, 10))
        checks.append(Check(name, "", row[column], lam[mode - 1], tolerance, on_page=shown))
    return tuple(checks)


def _rods(chain: Chain) -> Section:
    return Section(
        "Hanging chain of rods",
        "`tests/data/hanging_chain_frequencies.csv`, rigid_rod_chain: n equal slender rods hung from a "
        "point, from the generalised eigenvalue problem. One rod: sqrt(3/2), any textbook.",
        "The same model, so nothing but rounding: the eigenvalue problem loses the ratio of the largest "
        "squared pulsation to the one in question, 1e5 at 120 links, so 1e-11; differences over 1e-8 rad "
        "leave less. The tolerance is 1e-10 of the value and the table's last digit. Fixed top and free end "
        "are exact to 1e-11.",
        _exact(chain, "rigid_rod_chain", False),
    )


def _points(chain: Chain) -> Section:
    return Section(
        "Hanging chain of point masses",
        "`tests/data/hanging_chain_frequencies.csv`, lumped_laguerre: n equal point masses on massless "
        "rods, lambda^2 = n times the zeros of Laguerre's polynomial L_n (D. Bernoulli 1732).",
        "The source has points where we have links. A link with I_R = m l²/4 has the kinetic energy of m/2 "
        "at each of its ends, and so n such links with a load of m/2 are n point masses, with the same "
        "pulls: the difference is zero, and the tolerance rounding as above.",
        _exact(chain, "lumped_laguerre", True),
    )


def _bessel(chain: Chain) -> Section:
    checks = []
    for row in read_table("hanging_chain_frequencies"):
        n, mode = int(row["N"]), int(row["mode"])
        if n >= 10 and mode <= 5:
            checks.append(_converging(chain, n, mode, row["continuous_bessel"], 0.0, shown=n == 40))
    return Section(
        "Many rods: the flexible chain",
        "`tests/data/hanging_chain_frequencies.csv`, continuous_bessel: lambda = j_0,k / 2, half the zeros "
        "of Bessel's J_0 (Abramowitz and Stegun, Table 9.5).",
        _CONVERGING,
        tuple(checks),
    )


def _loaded(chain: Chain) -> Section:
    rows = read_table("hanging_chain_tipmass_frequencies")
    return Section(
        "Flexible chain with a load",
        "`tests/data/hanging_chain_tipmass_frequencies.csv`: a flexible chain with a point mass at its end, "
        "of 0 to 10 times its own (compare Deschaine and Suits, Eur. J. Phys. 29 (2008) 1211); here 40 "
        "rods.",
        _CONVERGING,
        tuple(
            _converging(
                chain,
                40,
                int(row["mode"]),
                row["lambda"],
                row["tip_over_chain_mass"],
                shown=row["mode"] in (1, 3),
            )
            for row in rows
        ),
    )


_CONVERGING = (
    "A chain of rods is a linear finite-element model of the flexible one, always too fast, to leading "
    "order by the share c/n² with c = int T y''² / (24 lambda² (int y² + r y_end²)) of the continuous "
    "shape. The next term is, for a uniform string, x²/80 of the first, x being the phase across a link. "
    "The tolerance takes the x of the lowest link, where the pull is least, and five times as much, and the "
    "last digit of the table; the five is our choice, as the pull of a chain without load vanishes at its "
    "end, and its remainder falls more slowly than a string's."
)


def _converging(chain: Chain, n: int, mode: int, lam: float, ratio: float, *, shown: bool) -> Check:
    derived = lam * leading_error(lam, ratio) / n**2
    phase_squared = (lam / n) ** 2 / (ratio + 0.5 / n)
    name = (f"load of {ratio:g}, " if ratio else "") + f"{n} links, mode {mode}"
    found = chain.lambdas(n, ratio)[mode - 1]
    return Check(name, "", lam, found, derived * phase_squared / 16.0 + 1e-9, derived, on_page=shown)


def _timed(chain: Chain) -> Section:
    lam, n = 1.202504674248, 20
    check = Check(f"{n} links, mode 1, timed over five periods", "", lam, chain.timed(n), 1e-6)
    return Section(
        "The same, by the clock",
        "As the hanging chain of rods.",
        "Released in its shape with 1e-3 rad and integrated at a tolerance of 1e-10. Finite swings shift "
        "frequencies by a number of order one times the angle squared.",
        (check,),
    )
