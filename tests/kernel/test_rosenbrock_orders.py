"""The Rosenbrock methods at work: orders measured on small equations with known solutions, a stepper in numpy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from cablefmu.cable import Floats
from tests.kernel.rosenbrock import DENSE_ORDER, Method


@dataclass(frozen=True)
class Equation:
    """M y' = f(t, y) with its derivatives and its exact solution."""

    f: Callable[[float, Floats], Floats]
    jacobian: Callable[[float, Floats], Floats]
    f_t: Callable[[float, Floats], Floats]
    exact: Callable[[float], Floats]
    mass: Floats


def step(method: Method, equation: Equation, t: float, y: Floats, h: float, *, known: float = 1.0) -> Floats:
    """u, shape (stages, dimension); `known`: that part of J and f_t alone."""
    system = equation.mass / (method.gamma * h) - known * equation.jacobian(t, y)
    slope = known * equation.f_t(t, y)
    u = np.zeros((method.stages, len(y)))
    for i in range(method.stages):
        f = equation.f(t + method.alpha[i] * h, y + method.a[i] @ u)
        u[i] = np.linalg.solve(system, f + equation.mass @ (method.c[i] @ u) / h + method.d[i] * h * slope)
    return u


def global_error(method: Method, equation: Equation, steps: int, *, known: float = 1.0) -> float:
    """The largest after any of `steps` steps to t = 1."""
    y, errors = equation.exact(0.0), []
    for k in range(steps):
        y = y + method.m @ step(method, equation, k / steps, y, 1.0 / steps, known=known)
        errors.append(abs(y - equation.exact((k + 1) / steps)).max())
    return float(max(errors))


def error_in_the_middle(method: Method, equation: Equation, h: float) -> float:
    """Of the dense output of a single step."""
    y = equation.exact(0.0)
    between = y + method.m_dense(0.5) @ step(method, equation, 0.0, y, h)
    return float(abs(between - equation.exact(0.5 * h)).max())


def slope(coarse: float, fine: float) -> float:
    """The order that halving the step shows."""
    return float(np.log2(coarse / fine))


def prothero_robinson(stiffness: float) -> Equation:
    """y' = -L (y - cos t) - sin t, y = cos t"""
    return Equation(
        f=lambda t, y: -stiffness * (y - np.cos(t)) - np.sin(t),
        jacobian=lambda t, y: np.array([[-stiffness]]),
        f_t=lambda t, y: np.array([-stiffness * np.sin(t) - np.cos(t)]),
        exact=lambda t: np.array([np.cos(t)]),
        mass=np.eye(1),
    )


CURVED = Equation(
    f=lambda t, y: y**2 * np.cos(t),
    jacobian=lambda t, y: np.array([2.0 * y * np.cos(t)]),
    f_t=lambda t, y: -(y**2) * np.sin(t),
    exact=lambda t: np.array([1.0 / (2.0 - np.sin(t))]),
    mass=np.eye(1),
)
"""y' = y^2 cos t"""

CURVED_WITH_A_CONSTRAINT = Equation(
    f=lambda t, y: np.array([y[1] * np.cos(t), y[1] ** 2 - y[0] ** 4]),
    jacobian=lambda t, y: np.array([[0.0, np.cos(t)], [-4.0 * y[0] ** 3, 2.0 * y[1]]]),
    f_t=lambda t, y: np.array([-y[1] * np.sin(t), 0.0]),
    exact=lambda t: np.array([1.0 / (2.0 - np.sin(t)), 1.0 / (2.0 - np.sin(t)) ** 2]),
    mass=np.diag([1.0, 0.0]),
)
"""y' = z cos t, 0 = z^2 - y^4: differential-algebraic of index 1"""

SPIRAL = Equation(
    f=lambda t, y: np.array([[-0.5, 2.0], [-2.0, -0.5]]) @ y,
    jacobian=lambda t, y: np.array([[-0.5, 2.0], [-2.0, -0.5]]),
    f_t=lambda t, y: np.zeros(2),
    exact=lambda t: np.exp(-0.5 * t) * np.array([np.cos(2.0 * t), -np.sin(2.0 * t)]),
    mass=np.eye(2),
)
"""y' = A y"""


def test_order_on_a_smooth_equation(method: Method) -> None:
    coarse, fine = global_error(method, CURVED, 16), global_error(method, CURVED, 32)
    assert slope(coarse, fine) == pytest.approx(method.order, abs=0.1)


def test_order_on_a_differential_algebraic_equation(method: Method) -> None:
    """Two error terms of opposite sign are still at work at these steps: 0.4."""
    coarse, fine = (global_error(method, CURVED_WITH_A_CONSTRAINT, steps) for steps in (64, 128))
    assert slope(coarse, fine) == pytest.approx(method.order, abs=0.4)


def test_order_with_half_the_jacobian(method: Method) -> None:
    coarse, fine = (global_error(method, CURVED, steps, known=0.5) for steps in (64, 128))
    assert slope(coarse, fine) == pytest.approx(1 if method.name == "Rodas4" else 2, abs=0.1)


def test_order_in_the_stiff_limit(method: Method) -> None:
    """L = 1e6: the error is h^p / L times a constant."""
    coarse, fine = (global_error(method, prothero_robinson(1e6), steps) for steps in (8, 16))
    assert slope(coarse, fine) == pytest.approx(1 if method.name == "Rodas4" else 3, abs=0.1)


def test_order_whatever_the_stiffness(method: Method) -> None:
    """The worst of all L from 0.1 to 1e6, three a decade: what a controller meets that does not know L."""
    equations = [prothero_robinson(10.0**k) for k in np.linspace(-1.0, 6.0, 22)]
    coarse, fine = (max(global_error(method, equation, steps) for equation in equations) for steps in (16, 32))
    assert slope(coarse, fine) == pytest.approx(2 if method.name == "Rodas4" else 4, abs=0.2)


def test_order_in_the_middle_of_a_step(method: Method) -> None:
    """Local error of the dense output, larger of two equations: one power of h more than its order."""
    coarse, fine = (max(error_in_the_middle(method, equation, h) for equation in (SPIRAL, CURVED)) for h in (0.1, 0.05))
    assert slope(coarse, fine) == pytest.approx(DENSE_ORDER[method.name] + 1, abs=0.2)


def test_order_in_the_middle_of_a_stiff_step(method: Method) -> None:
    """L = 1e6: cubic in all three, down to errors of h / L, which Rodas4 makes at the end as well."""
    coarse, fine = (error_in_the_middle(method, prothero_robinson(1e6), h) for h in (0.2, 0.1))
    assert slope(coarse, fine) == pytest.approx(4, abs=0.2)
