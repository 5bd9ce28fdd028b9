"""A truncated vertical cylinder that heaves or surges in water of finite depth, by matched eigenfunctions.

After Yeung, Added mass and damping of a vertical cylinder in finite-depth waves, Applied Ocean Research 3 (1981): the
potential is a series below the cylinder and another one around it; both, and their fluxes, agree where they meet. No
panels, no Green's function: nothing in common with a boundary element method. SI, time e^(-j omega t).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import hankel1, ive, kve

from cablefmu.cable import Floats

BELOW, AROUND = 400, 800
"""Terms of the two series; twice as many change results by less than 1e-3, because of the edge."""


def wavenumbers(omega: float, depth: float, gravity: float) -> Floats:
    """Roots of omega^2 = g m tanh(m h), then of omega^2 = -g m tan(m h) [rad/m]."""
    nu = omega**2 / gravity
    travelling = brentq(lambda m: m * np.tanh(m * depth) - nu, 1e-9, 10.0 + 2.0 * nu)
    standing = [
        brentq(
            lambda m: m * np.sin(m * depth) + nu * np.cos(m * depth),
            (k - 0.5) * np.pi / depth + 1e-12, k * np.pi / depth,
        )
        for k in range(1, AROUND)
    ]  # fmt: skip
    return np.array([travelling, *standing])


def added_mass_and_damping(
    mode: str, omega: float, *, radius: float, draft: float, depth: float, density: float = 1000.0,
    gravity: float = 9.81,
) -> tuple[float, float]:  # fmt: skip
    """Added mass [kg] and radiation damping [N s/m] of "heave" or "surge"."""
    a, gap, m = radius, depth - draft, wavenumbers(omega, depth, gravity)
    n = np.arange(BELOW)
    inner = np.pi * n / gap
    size, below, side = _depth_functions(m, inner, depth, gap)
    below, side = below / size[:, None], side / size
    if mode == "heave":
        slope = np.append(-m[0] * hankel1(1, m[0] * a) / hankel1(0, m[0] * a), -m[1:] * _k(1, 0, m[1:] * a))
        flow = inner * _i(1, 0, inner * a)
        # By the particular solution ((z + h)^2 - r^2/2)/(2 gap), which is what moves with the bottom.
        given = np.append(gap / 3.0 - a**2 / (2.0 * gap), 2.0 * gap * (-1.0) ** n[1:] / (np.pi * n[1:]) ** 2)
        driven = -a / (2.0 * gap) * below[:, 0]
    else:
        travelling = hankel1(0, m[0] * a) / hankel1(1, m[0] * a) - 1.0 / (m[0] * a)
        slope = np.append(m[0] * travelling, -m[1:] * (_k(0, 1, m[1:] * a) + 1.0 / (m[1:] * a)))
        flow = np.append(1.0 / a, inner[1:] / _i(1, 0, inner[1:] * a) - 1.0 / a)
        given, driven = np.zeros(BELOW), side
    # beta_k slope_k h = driven_k + sum_n alpha_n flow_n below_kn (half of it for n = 0), and
    # alpha_n = (2/gap) sum_k beta_k below_kn - given_n.
    half = np.where(n == 0, 0.5, 1.0)
    exchange = (below * (half * flow)) @ below.T * (2.0 / gap)
    beta = np.linalg.solve(np.diag(slope * depth) - exchange, driven - below @ (half * flow * given))
    alpha = 2.0 / gap * (beta @ below) - given
    if mode == "heave":
        plate = gap * a**2 / 4.0 - a**4 / (16.0 * gap) + alpha[0] * a**2 / 4.0
        rings = np.sum(alpha[1:] * (-1.0) ** n[1:] * a * _i(1, 0, inner[1:] * a) / inner[1:])
        total = 2.0 * np.pi * (plate + rings)
    else:
        total = -np.pi * a * (beta @ side)
    return float(density * total.real), float(density * omega * total.imag)


def _i(above: int, below: int, x: Floats) -> Floats:
    """Ratio of modified Bessel functions of the first kind."""
    return np.asarray(ive(above, x) / ive(below, x))


def _k(above: int, below: int, x: Floats) -> Floats:
    """Ratio of modified Bessel functions of the second kind."""
    return np.asarray(kve(above, x) / kve(below, x))


def _depth_functions(m: Floats, inner: Floats, depth: float, gap: float) -> tuple[Floats, Floats, Floats]:
    """Of cosh(m0 (z + h))/cosh(m0 h) and cos(m_k (z + h)): root of mean square over the depth, integrals with
    cos(inner (z + h)) over the gap below the cylinder, shape (k, n), and integrals along its side."""
    turned = np.append(1j * m[0], m[1:])[:, None]  # cos(j m y) = cosh(m y)
    scale = np.append(1.0 / np.cosh(m[0] * depth), np.ones(len(m) - 1))
    size = np.sqrt((scale**2 * (0.5 + np.sin(2.0 * turned[:, 0] * depth) / (4.0 * turned[:, 0] * depth))).real)
    total, apart = turned + inner, turned - inner
    apart = np.where(np.abs(apart) < 1e-9, 1e-9, apart)
    below = 0.5 * (np.sin(total * gap) / total + np.sin(apart * gap) / apart)
    side = (np.sin(turned[:, 0] * depth) - np.sin(turned[:, 0] * gap)) / turned[:, 0]
    return size, (scale[:, None] * below).real, (scale * side).real
