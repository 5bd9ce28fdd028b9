"""The Rosenbrock methods on y' = lambda y: y(t + h) = R(z) y(t), z = lambda h (Hairer & Wanner II, section IV.3)."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest

from cablefmu.cable import Floats
from tests.kernel.rosenbrock import ROUNDING, Method

LINEAR_ORDER = {"Rodas4": 4, "Rodas4P2": 4, "Rodas5P": 6}
CONSTANT = {"Rodas4": -7.2636e-4, "Rodas4P2": -13.0 / 15360.0, "Rodas5P": -1.01535e-5}


def both(method: Method) -> list[tuple[int, Floats]]:
    """Order on linear equations and weights, of the solution and of the embedded one."""
    return [(LINEAR_ORDER[method.name], method.b), (method.error_order, method.b_embedded)]


def stability(method: Method, b: Floats, z: complex) -> complex:
    """R(z)"""
    stages = np.linalg.solve(np.eye(method.stages) - z * method.betas, np.ones(method.stages))
    return complex(1.0 + z * (b @ stages))


def moments(method: Method, b: Floats, count: int) -> Floats:
    """r_0 ... of R = sum r_k z^k: 1, then b beta^(k - 1) 1."""
    found, power = [1.0], np.ones(method.stages)
    for _ in range(count - 1):
        found.append(float(b @ power))
        power = method.betas @ power
    return np.array(found)


def squared_on_the_imaginary_axis(p: Floats) -> Floats:
    """|p(i y)|^2 of a polynomial p, as coefficients of powers of y^2."""
    rotated = p.astype(complex) * 1j ** np.arange(len(p))
    return np.asarray(np.convolve(rotated, rotated.conj()).real[::2], dtype=float)


def test_solution_and_embedded_solution_are_stiffly_accurate(method: Method) -> None:
    """The last two stages are the two solutions, at the end of the step."""
    assert (method.m - method.e == method.a[-1]).all() and (method.e == np.eye(method.stages)[-1]).all()
    assert (method.alpha[-2:] == 1.0).all() and (method.d[-2:] == 0.0).all()
    assert method.b == pytest.approx(method.betas[-1], rel=0, abs=ROUNDING)
    assert method.b_embedded == pytest.approx(method.betas[-2], rel=0, abs=ROUNDING)


def test_both_are_a_stable(method: Method) -> None:
    """R = P / Q, Q = (1 - gamma z)^stages: poles in the right half plane, and |Q|^2 > |P|^2 on the imaginary axis."""
    assert method.gamma > 0
    assert np.triu(method.betas) == pytest.approx(method.gamma * np.eye(method.stages), rel=0, abs=ROUNDING)
    for order, b in both(method):
        q = np.array([1.0])
        for _ in range(method.stages):
            q = np.convolve(q, [1.0, -method.gamma])
        p = np.convolve(q, moments(method, b, method.stages + 1))[: method.stages + 1]
        excess = squared_on_the_imaginary_axis(q) - squared_on_the_imaginary_axis(p)
        zeros_at_the_origin = order // 2 + 1  # R = exp + O(z^(order + 1)), |exp| = 1
        assert abs(excess[:zeros_at_the_origin]).max() < ROUNDING
        rest = excess[zeros_at_the_origin:]
        crossings = [root for root in np.roots(rest[::-1]) if root.real > 0 and abs(root.imag) < 1e-6 * abs(root)]
        assert rest[0] > 0 and rest[-1] > 0 and crossings == []


def test_both_are_l_stable(method: Method) -> None:
    """R vanishes at infinity like 1 / z, and is nowhere on the imaginary axis above one."""
    frequencies = np.concatenate([np.linspace(0.0, 50.0, 1001), np.geomspace(50.0, 1e6, 1001)])
    for _, b in both(method):
        assert abs(1.0 - b @ np.linalg.solve(method.betas, np.ones(method.stages))) < ROUNDING
        assert max(abs(stability(method, b, 1j * y)) for y in frequencies) <= 1.0 + ROUNDING
        # z R(z) tends to -b beta^-2 1, at most 13 for these methods
        assert abs(stability(method, b, 1e6j)) < 2e-5


def test_error_constant_on_linear_equations(method: Method) -> None:
    """R(z) = exp(z) + constant z^(order + 1) + ..."""
    order, constant = LINEAR_ORDER[method.name], CONSTANT[method.name]
    off = moments(method, method.b, order + 2) - [1.0 / factorial(k) for k in range(order + 2)]
    assert abs(off[:-1]).max() < ROUNDING
    assert off[-1] == pytest.approx(constant, rel=1e-4)
