"""Signals: values, exact derivatives, and the times at which they jump."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy
from scipy.interpolate import CubicSpline

from cablefmu.signals import Constant, CsvError, Derivative, Sampled, Signal, Sine, Spline, Steps, read_csv


def test_heave_force_of_the_dissertation() -> None:
    # u_m1 = 25000 sin(0.5 pi t) N: zero at full seconds 0, 2, 4, extreme at 1, 3.
    heave = Sine(25000.0, 0.25)
    assert [heave(t) for t in (0.0, 1.0, 3.0)] == pytest.approx([0.0, 25000.0, -25000.0])
    # 25000 N times the rounding of pi at its zeros
    assert [heave(t) for t in (2.0, 4.0)] == pytest.approx([0.0, 0.0], abs=1e-10)


def test_derivatives_of_a_sine_are_those_of_computer_algebra() -> None:
    t = sympy.Symbol("t")
    expression = 3 + 7 * sympy.sin(2 * sympy.pi * sympy.Rational(1, 4) * (t - 2) + sympy.Rational(1, 2))
    signal = Sine(7.0, 0.25, phase=0.5, offset=3.0, start=2.0)
    at = 3.3
    assert signal(at) == pytest.approx(float(expression.subs(t, at)), rel=1e-14)
    expected = [float(sympy.diff(expression, t, k).subs(t, at)) for k in range(1, 7)]
    # sin and cos of an angle of a few radians: rounding only
    assert signal.derivatives(at, 6) == pytest.approx(expected, rel=1e-13)


def test_a_sine_rests_on_its_offset_until_it_starts() -> None:
    signal = Sine(7.0, 0.25, phase=math.pi / 2.0, offset=3.0, start=2.0)
    assert signal(1.999) == 3.0
    assert signal.derivatives(1.999, 2) == [0.0, 0.0]
    assert signal(2.0) == 10.0
    assert signal.breaks(0.0, 10.0) == [2.0]
    assert signal.breaks(2.0, 10.0) == []
    assert Sine(7.0, 0.25).breaks(-10.0, 10.0) == []


def test_steps_have_their_new_value_at_the_jump() -> None:
    lift = Steps((0.0, 15.5), (-2000.0, 0.0))
    assert lift(-1e-9) == 0.0
    assert lift(0.0) == -2000.0
    assert lift(math.nextafter(15.5, 0.0)) == -2000.0
    assert lift(15.5) == 0.0
    assert lift(1e6) == 0.0
    assert lift.derivatives(15.5, 3) == [0.0, 0.0, 0.0]
    assert lift.breaks(0.0, 31.0) == [15.5]
    assert lift.breaks(-1.0, 31.0) == [0.0, 15.5]
    assert lift.breaks(15.5, 31.0) == []


def test_samples_are_joined_by_straight_lines_and_held_outside() -> None:
    times, values = (0.0, 1.0, 3.0), (2.0, 4.0, 0.0)
    signal = Sampled(times, values)
    grid = np.linspace(-2.0, 5.0, 57)
    assert [signal(t) for t in grid] == pytest.approx(list(np.interp(grid, times, values)), rel=1e-15)
    assert signal.derivatives(1.0, 2) == [-2.0, 0.0]
    assert signal.derivatives(-1.0, 1) == [0.0]
    assert signal.derivatives(3.0, 1) == [0.0]
    assert signal.breaks(0.0, 3.0) == [1.0]
    assert signal.breaks(-1.0, 9.0) == [0.0, 1.0, 3.0]


def test_a_motion_is_scipys_clamped_spline_and_rests_outside() -> None:
    times, values = (0.0, 0.7, 1.0, 2.5), (1.0, -2.0, 0.5, 3.0)
    motion, expected = Spline(times, values), CubicSpline(times, values, bc_type="clamped")
    for t in (0.0, 0.3, 0.7, 0.99, 1.0, 1.9, 2.4999):
        # Another order of summation, of numbers below 1e3: rounding only.
        assert motion(t) == pytest.approx(float(expected(t)), abs=1e-13)
        assert motion.derivatives(t, 4) == pytest.approx([float(expected(t, k)) for k in (1, 2, 3, 4)], abs=1e-11)
        assert Derivative(motion, 2)(t) == pytest.approx(float(expected(t, 2)), abs=1e-11)
    assert [motion(t) for t in (-1.0, 2.5, 9.0)] == pytest.approx([1.0, 3.0, 3.0], abs=1e-14)
    assert motion.derivatives(-1.0, 4) == motion.derivatives(2.5, 4) == [0.0] * 4
    assert motion.breaks(0.0, 2.5) == [0.7, 1.0]


def test_no_derivative_beyond_the_degree() -> None:
    """What a host may leave out: it is 0 at all times."""
    motion = Spline((0.0, 1.0, 2.0), (0.0, 1.0, 0.5))
    signals: list[Signal] = [Constant(2.0), Steps((1.0,), (4.0,)), Sampled((0.0, 2.0), (1.0, 3.0)), motion]
    signals += [Derivative(motion, 1), Derivative(motion, 2), Derivative(Constant(1.0), 1)]
    assert [signal.degree for signal in signals] == [0, 0, 1, 3, 2, 1, 0]
    for signal in signals:
        assert signal.degree is not None
        for t in (-0.5, 0.0, 0.3, 1.0, 1.7, 2.0):
            assert not any(signal.derivatives(t, 8)[signal.degree :])
    assert Sine(1.0, 2.0).degree is None and Derivative(Sine(1.0, 2.0), 2).degree is None


def test_between_breaks_derivatives_predict_the_signal() -> None:
    # Taylor series over a tenth of a second: with amplitude 2 and w = pi the rest is 2 (0.1 w)^7 / 7! = 1.2e-7.
    for signal in (
        Constant(5.0),
        Sine(2.0, 0.5, start=1.0),
        Steps((1.0,), (4.0,)),
        Sampled((0.0, 2.0), (1.0, 3.0)),
        Spline((0.0, 1.0, 2.0), (1.0, 3.0, 2.0)),
    ):
        for t in (0.3, 1.0, 1.7):
            assert signal.breaks(t, t + 0.1) == []
            series = signal(t) + sum(
                d * 0.1**k / math.factorial(k) for k, d in enumerate(signal.derivatives(t, 6), start=1)
            )
            assert series == pytest.approx(signal(t + 0.1), abs=1.3e-7)


def test_csv_columns_by_number_and_by_name() -> None:
    data = b"\xef\xbb\xbftime, a,b\n0,1,5\n\n2.5,-1e1,6\n"
    assert read_csv(data) == Sampled((0.0, 2.5), (1.0, -10.0))
    assert read_csv(data, value="b") == Sampled((0.0, 2.5), (5.0, 6.0))
    assert read_csv(data, time=3, value="a") == Sampled((5.0, 6.0), (1.0, -10.0))
    assert read_csv(b"0,1\r\n1,2\r\n") == Sampled((0.0, 1.0), (1.0, 2.0))


@pytest.mark.parametrize(
    ("data", "options", "says"),
    [
        (b"", {}, "no line with numbers"),
        (b"time,force\n", {}, "no line with numbers"),
        (b"0,1\n0,2\n", {}, "row 2: time 0 s does not come after 0 s"),
        (b"0,1\n2,2\n\n1,2\n", {}, "row 4: time 1 s does not come after 2 s"),
        (b"0,1\n1,nan\n", {}, 'row 2, column 2: a finite number is expected, there is "nan"'),
        (b"0,1\n1,inf\n", {}, "row 2, column 2"),
        (b"0,1\n1,one\n", {}, 'there is "one"'),
        (b"0,1\n1\n", {}, "row 2, column 2"),
        (b"0;1\n1;2\n", {}, "no column 2; columns, set off by commas, are numbered 1 to 1"),
        (b"o,1\n1,2\n", {}, 'row 1, column 1: a finite number is expected, there is "o"'),
        (b"0,1\n", {"value": 3}, "no column 3; columns, set off by commas, are numbered 1 to 2"),
        (b"0,1\n", {"value": "force"}, 'no column "force", as the first line has no names'),
        (b"t,F\n0,1\n", {"value": "force"}, 'no column "force"; the columns are t, F'),
        (b"\xff\xfe0", {}, "UTF-8"),
    ],
)
def test_a_bad_table_is_refused_with_its_row(data: bytes, options: dict[str, str | int], says: str) -> None:
    with pytest.raises(CsvError, match=says):
        read_csv(data, **options)
