"""Vessels by themselves, under FMPy: closed forms, orders, curves that agree with their slopes."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from cablefmu.cable import Floats
from tests.fmu_helpers import Host
from tests.partners.vessels import BODY, SINES, Build, builder, refused, run, write_csv

ROUNDING = 1e-11
"""Of the largest value: some hundred steps, each a sum of products with an exponential that is good to 1e-15."""


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """build(name=..., **table): folder of that vessel's FMU."""
    return builder(tmp_path_factory.mktemp("vessels"))


# --- the body ---


def closed_form(m: float, c: float, k: float, force: float, q: float, v: float, times: Floats) -> Floats:
    """Displacement, velocity and acceleration of m q'' + c q' + k q = force, by the roots of m r^2 + c r + k.

    In 50 digits, which leave enough where two roots are all but one; k must not be 0.
    """
    with mpmath.workdps(50):
        m, c, k, force, q, v = map(mpmath.mpf, (m, c, k, force, q, v))
        half, split = -c / (2 * m), mpmath.sqrt((c / (2 * m)) ** 2 - k / m + mpmath.mpf("1e-40"))
        first, second, rest = half + split, half - split, force / k
        b = (v - first * (q - rest)) / (second - first)
        parts = [(q - rest - b, first), (b, second)]
        rows = []
        for t in map(mpmath.mpf, times.tolist()):
            waves = [(size * mpmath.exp(root * t), root) for size, root in parts]
            values = [sum(wave * root**order for wave, root in waves) for order in range(3)]
            rows.append([float(mpmath.re(rest + values[0])), *(float(mpmath.re(value)) for value in values[1:])])
    return np.array(rows)


@pytest.mark.parametrize("step", [0.02, 0.5, 7.0])
@pytest.mark.parametrize("damping", [0.0, 0.07, 1.0, 30.0])
def test_body_is_the_damped_oscillator_of_the_closed_form(build: Build, damping: float, step: float) -> None:
    """Undamped to 30 times overdamped, steps of 0.005 to 1.7 periods: all exact."""
    m, k, force = 4.0e5, 9.0e5, 3.0e4
    c = damping * 2.0 * np.sqrt(m * k)
    table = {"kind": "body", "m_x": 1.0, "m_y": m, "c_y": c, "k_y": k, "y_0": 0.7, "vy_0": -1.1, "external_y": 5e3}
    times = np.arange(101) * step
    with Host(build(**table)) as host:
        host.initialize(F_y=force, F_x=0.0)
        seen = run(host, times)[:, 1::2]
    expected = closed_form(m, c, k, force + 5e3, 0.7, -1.1, times)
    assert np.max(np.abs(seen - expected) / np.max(np.abs(expected), axis=0)) < ROUNDING


def test_a_body_without_spring_and_damper_is_thrown(build: Build) -> None:
    times = np.arange(51) * 0.2
    with Host(build(kind="body", m_x=2.0, m_y=5.0, x_0=3.0, vx_0=4.0)) as host:
        host.initialize(F_x=6.0, F_y=-10.0)
        seen = run(host, times)
    x, y = 3.0 + 4.0 * times + 1.5 * times**2, -(times**2)
    np.testing.assert_allclose(seen[:, 0], x, rtol=1e-13)
    np.testing.assert_allclose(seen[:, 1], y, rtol=1e-13, atol=1e-13)
    assert np.all(seen[:, 4:] == [3.0, -2.0])


def test_static_load_keeps_the_body_at_rest_under_the_cable_that_it_was_meant_for(build: Build) -> None:
    with Host(build(**BODY, static_load_x=-700.0, static_load_y=4.0e4)) as host:
        host.initialize(F_x=-700.0, F_y=4.0e4)
        assert np.all(run(host, np.arange(11) * 0.3) == 0.0)
        host.set(F_y=4.0e4 + 3.0)  # pulled down more: y grows
        assert host.get("ay") == [3.0 / 3.0e5]


def energy(rows: Floats) -> Floats:
    x, y, vx, vy = rows.T[:4]
    return np.asarray(0.5 * (2.0e5 * vx**2 + 3.0e5 * vy**2 + 1.0e4 * x**2 + 8.0e5 * y**2))


def test_energy_stays_without_dampers_and_falls_with_them(build: Build) -> None:
    start = {"x_0": 1.0, "vx_0": 0.2, "y_0": -0.5, "vy_0": 1.0}
    times = np.arange(5001) * 0.1
    with Host(build(**(BODY | start | {"c_x": 0.0, "c_y": 0.0}))) as host:
        kept = energy(run(host.initialize(), times))
    assert np.max(np.abs(kept / kept[0] - 1.0)) < 1e-11  # 5,000 steps; measured 2e-13
    with Host(build(**(BODY | start))) as host:
        lost = energy(run(host.initialize(), times[:501]))
    assert np.all(np.diff(lost) < 0.0)


@pytest.mark.parametrize("part", ["x", "y"])
def test_forces_given_with_their_derivatives_are_parabolas_exactly(build: Build, part: str) -> None:
    """Against scipy's DOP853, which knows no exponential; the axes do not touch each other."""
    m, c, k = (BODY[f"{name}_{part}"] for name in "mck")
    coefficients = np.array([2.0e4, -3.0e3, 400.0])  # F = 2e4 - 3e3 t + 400 t^2

    def given(t: float) -> dict[str, float]:
        f = np.polynomial.Polynomial(coefficients)
        return {f"F_{part}": f(t), f"der(F_{part})": f.deriv()(t), f"der(F_{part},2)": f.deriv(2)(t)}

    times = np.array([0.0, 0.1, 0.7, 2.0, 2.05, 5.0, 9.0])
    with Host(build(**BODY, extrapolation="given")) as host:
        both = run(host.initialize(), times, given)
    seen, other = (both[:, ["x", "y"].index(axis) :: 2] for axis in (part, "xy".replace(part, "")))
    solved = solve_ivp(
        lambda t, z: [z[1], (given(t)[f"F_{part}"] - k * z[0] - c * z[1]) / m], (0.0, 9.0), [0.0, 0.0],
        method="DOP853", t_eval=times, rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    assert np.all(other == 0.0)
    np.testing.assert_allclose(seen[:, :2], solved.y.T, rtol=1e-9, atol=1e-11)  # what DOP853 leaves


def smooth(t: float) -> float:
    """A force that begins gently: its first three derivatives are 0 at t = 0 [N]."""
    return 2.0e5 * (1.0 - np.cos(0.9 * t)) ** 2


@cache
def smooth_rates() -> list[Any]:
    """Its first and second time derivative, by sympy."""
    t = sympy.Symbol("t")
    return [sympy.lambdify(t, sympy.diff(2.0e5 * (1 - sympy.cos(0.9 * t)) ** 2, t, order)) for order in (1, 2)]


@pytest.mark.parametrize(("extrapolation", "order"), [(0, 1), (1, 2), (2, 3), ("given", 3)])
def test_order_of_extrapolation(build: Build, extrapolation: int | str, order: int) -> None:
    """The vessel sees the force at communication points alone: errors fall with the order of what it makes of it."""

    def forces(t: float) -> dict[str, float]:
        if extrapolation != "given":
            return {"F_y": smooth(t)}
        first, second = (float(rate(t)) for rate in smooth_rates())
        return {"F_y": smooth(t), "der(F_y)": first, "der(F_y,2)": second}

    m, c, k = (BODY[f"{name}_y"] for name in "mck")
    solved = solve_ivp(
        lambda t, z: [z[1], (smooth(t) - k * z[0] - c * z[1]) / m], (0.0, 8.0), [0.0, 0.0], method="DOP853",
        t_eval=np.arange(81) * 0.1, rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    folder, errors = build(**BODY, extrapolation=extrapolation), []
    for parts in (2, 4, 8):
        with Host(folder) as host:
            seen = run(host.initialize(), np.arange(80 * parts + 1) * (0.1 / parts), forces)[::parts, 1]
        errors.append(np.max(np.abs(seen - solved.y[0])))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([order, order], abs=0.1), errors


def test_extrapolation_is_the_polynomial_through_the_last_forces_whatever_the_steps(build: Build) -> None:
    """Of order 2: from the third step on a parabola is followed exactly, with steps that are all different."""
    times = np.array([0.0, 0.1, 0.25, 0.3, 0.7, 0.9])
    bodies = []
    for extrapolation in (2, "given"):
        with Host(build(kind="body", m_x=1.0, m_y=1.0, extrapolation=extrapolation)) as host:
            host.initialize()

            def forces(t: float, given: bool = extrapolation == "given") -> dict[str, float]:
                rates = {"der(F_x)": 2.0 - 14.0 * t, "der(F_x,2)": -14.0} if given else {}
                return {"F_x": 5.0 + 2.0 * t - 7.0 * t**2, **rates}

            bodies.append(run(host, times, forces)[:, 2])
    np.testing.assert_allclose(np.diff(bodies[0])[2:], np.diff(bodies[1])[2:], rtol=1e-12)
    assert np.all(np.abs(np.diff(bodies[0])[:2] / np.diff(bodies[1])[:2] - 1.0) > 1e-3)  # held, linear: the start


# --- motion that is given ---


@cache
def sines_by_sympy() -> list[Any]:
    """Functions of time, in the order of the outputs, while the ramp grows: the derivatives are sympy's."""
    t = sympy.Symbol("t")
    s = t / 5
    ramp = 6 * s**5 - 15 * s**4 + 10 * s**3
    x = 1.5 * sympy.sin(2 * sympy.pi * t / 8 + sympy.pi / 6)
    y = 0.8 * sympy.sin(0.42 * sympy.pi * t) - 0.3 * sympy.sin(sympy.pi * t + 1)
    return [
        (sympy.lambdify(t, sympy.diff(ramp * q, t, order)), sympy.lambdify(t, sympy.diff(q, t, order)))
        for order in range(3)
        for q in (x, y)
    ]


def test_sines_and_their_derivatives_are_those_of_the_formula(build: Build) -> None:
    times = np.arange(101) * 0.1
    with Host(build(**SINES)) as host:
        seen = run(host.initialize(), times)
    expected = np.transpose([np.where(times < 5.0, early(times), late(times)) for early, late in sines_by_sympy()])
    assert np.max(np.abs(seen - expected)) < 1e-12  # arguments below 40, sizes below 20
    assert np.all(seen[0] == 0.0)


def test_without_ramp_sines_begin_at_once_and_parameters_can_be_set(build: Build) -> None:
    with Host(build(**SINES)) as host:
        host.initialize(**{"ramp": 0.0, "sine_x[1].amplitude": 2.0, "sine_x[1].phase": 0.5 * np.pi})
        rate = 2.0 * np.pi / 8.0
        np.testing.assert_allclose(host.get("x", "vx", "ax"), [2.0, 0.0, -2.0 * rate**2], atol=1e-15)


def test_samples_of_cubics_are_followed_exactly(build: Build, tmp_path: Path) -> None:
    """A cubic is its own spline: displacement, velocity and acceleration of the formula, between uneven samples."""
    times = np.array([0.0, 0.4, 1.0, 1.1, 2.3, 3.0, 4.2, 5.0])
    curves = [np.polynomial.Polynomial(c) for c in ([0.5, -1.0, 0.3, 0.1], [-2.0, 0.7, 0.2, -0.15])]
    file = write_csv(tmp_path / "cubic.csv", times, *(curve(times) for curve in curves))
    at = np.arange(51) * 0.1
    with Host(build(kind="csv", file=file)) as host:
        seen = run(host.initialize(), at)
    expected = np.transpose([curve.deriv(order)(at) if order else curve(at) for order in range(3) for curve in curves])
    np.testing.assert_allclose(seen, expected, rtol=1e-12, atol=1e-12)


def test_velocity_and_acceleration_of_samples_are_slopes_of_the_same_curve(build: Build, tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    times = np.arange(21) * 0.5
    file = write_csv(tmp_path / "noise.csv", times, *rng.normal(size=(2, 21)))
    h = 1e-3
    with Host(build(kind="csv", file=file)) as host:
        seen = run(host.initialize(), np.arange(10_001) * h)
    # Central differences of a piece of cubic: of x off by x''' h^2/6, of v exact up to the joints of pieces, where
    # the jump of x''' counts with h/2. The third derivatives here are below 200.
    slopes = (seen[2:, :4] - seen[:-2, :4]) / (2.0 * h)
    off = np.abs(slopes - seen[1:-1, 2:])
    assert np.max(off[:, :2]) < 200.0 * h**2 and np.max(off[:, 2:]) < 200.0 * h
    assert np.median(off[:, 2:]) < 1e-9
    np.testing.assert_allclose(seen[::500, 0], np.loadtxt(file, delimiter=",", skiprows=1)[:, 1], atol=1e-12)


def test_samples_are_not_gone_beyond(build: Build, tmp_path: Path) -> None:
    times = np.arange(6) * 0.7  # 5 steps of 0.7 are more than 3.5 by rounding
    folder = build(kind="csv", file=write_csv(tmp_path / "short.csv", times, times, times))
    with Host(folder) as host:
        run(host.initialize(), times)
        refused(host, "short.csv is known from 0 s to 3.5 s", host.step, times[-1], 0.7)
    with Host(folder) as host:
        refused(host, "t = -2 s: the motion in", host.enter_initialization, start=-2.0)
