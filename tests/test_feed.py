"""Forces reach the FMU as they are: jumps end steps, polynomials stand for the force to rounding."""

from __future__ import annotations

import math

import pytest

from cablefmu.feed import Feed
from cablefmu.signals import Constant, Derivative, Sampled, Signal, Sine, Spline, Steps


def polynomial(signal: Signal, time: float, ahead: float) -> float:
    """Taylor's series from `time`, summed as it is written."""
    terms = [signal(time), *signal.derivatives(time, 8)]
    return math.fsum(d * ahead**k / math.factorial(k) for k, d in enumerate(terms))


@pytest.mark.parametrize("frequency", [0.01, 0.25, 3.0, 40.0])
@pytest.mark.parametrize("start", [0.0, 0.3, 17.0, 2000.0, 1e5])
def test_pieces_cover_the_step_and_follow_the_force(frequency: float, start: float) -> None:
    """Late in a run the force is known as well as its time is: 2 pi f t carries the rounding of t."""
    signal = Sine(25000.0, frequency, phase=0.4, offset=100.0)
    feed, time, end = Feed({"u_m1": signal}), start, start + 0.5
    rounding = 25000.0 * 2.0 * math.pi * frequency * math.ulp(end) * 20
    pieces = 0
    while time < end:
        reach = feed.polynomial_reach(time, end)
        assert time < reach <= end
        for part in (0.25, 0.5, 0.75, 1.0):
            at = time + part * (reach - time)
            assert polynomial(signal, time, at - time) == pytest.approx(signal(at), rel=1e-11, abs=3e-8 + rounding)
        time, pieces = reach, pieces + 1
    # (w h)^9 / 9! = 1e-12 allows h = 1/33 of a period; halving may lose a factor of two.
    assert pieces <= 2 + 66 * frequency * 0.5


def test_straight_forces_need_one_piece() -> None:
    for signal in (Constant(5.0), Steps((0.0, 9.0), (1.0, 2.0)), Sampled((0.0, 9.0), (-1e4, 1e4))):
        for time in (0.0, 1.0, 4.5):
            assert Feed({"F_cx": signal}).polynomial_reach(time, time + 0.1) == time + 0.1


def test_a_spline_is_followed_in_one_piece_by_three_derivatives() -> None:
    motion = Spline((0.0, 1.0, 2.0, 3.0), (0.0, 4.0, -1.0, 2.0))
    feed = Feed({"x_1": motion, "vx_1": Derivative(motion, 1), "ax_1": Derivative(motion, 2)})
    assert feed.polynomial_reach(1.0, 2.0) == 2.0
    assert [len(derivatives) for derivatives in feed.values_and_derivatives(1.0)[1]] == [3, 2, 1]
    for signal in feed.signals.values():
        # Up to the next sample it is the polynomial of its derivatives: rounding of numbers below 50.
        assert polynomial(signal, 1.0, 0.9) == pytest.approx(signal(1.9), abs=1e-13)


def test_a_step_may_be_as_short_as_time_resolves() -> None:
    """113 times 0.01 s is one unit in the last place beyond a jump at 1.13 s."""
    feed = Feed({"u_m1": Steps((0.25, 1.13), (900.0, -400.0))})
    assert math.nextafter(1.13, 2.0) == 113 * 0.01
    assert feed.polynomial_reach(1.13, 113 * 0.01) == 113 * 0.01


def test_a_force_far_beyond_the_step_ends_the_search() -> None:
    """1 GHz in a step of 0.1 s: no polynomial fits, and the answer still comes."""
    feed = Feed({"u_m1": Sine(1.0, 1e9)})
    assert 5.0 < feed.polynomial_reach(5.0, 5.1) < 5.0 + 1e-6


def test_every_force_ends_a_step_where_it_jumps() -> None:
    feed = Feed({"u_m1": Steps((1.0, 2.0), (3.0, 4.0)), "F_cx": Sampled((0.0, 1.5, 3.0), (0.0, 1.0, 0.0))})
    breaks, time = [], 0.0
    while time < 4.0:
        time = feed.next_break(time, 4.0)
        breaks.append(time)
    assert breaks == [1.0, 1.5, 2.0, 3.0, 4.0]


def test_values_at_a_jump() -> None:
    feed = Feed({"u_m1": Steps((1.0,), (7.0,)), "u_m2": Constant(2.0)})
    assert feed.names == ["u_m1", "u_m2"]
    assert feed.values(1.0) == [7.0, 2.0]
    assert feed.values_before(1.0, limit=1.0) == [0.0, 2.0]
    assert feed.values_before(1.5, limit=2.0) == [7.0, 2.0]


def test_only_constant_forces_do_not_vary() -> None:
    assert not Feed({"u_m1": Constant(1.0), "F_cx": Constant(0.0)}).varies
    assert Feed({"u_m1": Constant(1.0), "F_cx": Steps((1.0,), (1.0,))}).varies
    assert not Feed({}).varies


def test_values_and_derivatives_are_those_of_every_signal_to_the_bit() -> None:
    """Though those that are derivatives of another are read off that one."""
    motion, other = Spline((0.0, 1.0, 2.0, 3.0), (0.0, 4.0, -1.0, 2.0)), Sine(2.0, 0.3)
    signals = {
        "vx_1": Derivative(motion, 1), "x_1": motion, "y_1": other, "ax_1": Derivative(motion, 2),
        "ay_1": Derivative(other, 2), "F_cx": Steps((0.5,), (7.0,)), "F_cy": Constant(2.0),
    }  # fmt: skip
    feed = Feed(signals)
    for time in (-0.5, 0.0, 0.5, 1.3, 3.0, 9.0):
        values, derivatives = feed.values_and_derivatives(time)
        assert values == feed.values(time) == [signal(time) for signal in signals.values()]
        expected = [signal.derivatives(time, len(d)) for signal, d in zip(signals.values(), derivatives, strict=True)]
        assert derivatives == expected and [len(d) for d in derivatives] == [2, 3, 8, 1, 8, 0, 0]
        breaks = [b for signal in signals.values() for b in signal.breaks(time, 10.0)]
        assert feed.next_break(time, 10.0) == min(breaks, default=10.0)
