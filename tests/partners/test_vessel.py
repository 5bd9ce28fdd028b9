"""Vessels by themselves, under FMPy: closed forms, orders, curves that agree with their slopes, states, refusals."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy
from fmpy import extract, simulate_fmu
from fmpy.fmi1 import FMICallException
from scipy.integrate import solve_ivp

from cablefmu import Vessel, build_vessel
from cablefmu.cable import Floats
from tests.fmu_helpers import Host

OUTPUTS = ("x", "y", "vx", "vy", "ax", "ay")

ROUNDING = 1e-11
"""Of the largest value: some hundred steps, each a sum of products with an exponential that is good to 1e-15."""

Build = Callable[..., Path]


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """build(name=..., **table): folder of that vessel's FMU."""
    folder = tmp_path_factory.mktemp("vessels")

    def made(name: str = "vessel", **table: object) -> Path:
        target = folder / f"{name}-{len(list(folder.iterdir()))}"
        vessel = Vessel.from_table(table, name=name, folder=folder)
        extract(str(build_vessel(vessel, target.with_suffix(".fmu"))), unzipdir=str(target))
        return target

    return made


def run(host: Host, times: Floats, forces: Callable[[float], Mapping[str, float]] | None = None) -> Floats:
    """The outputs at `times`, one row each; inputs are set at the beginning of every step."""
    rows = []
    for time, after in pairwise([*times, None]):
        host.set_all(forces(time) if forces else {})
        rows.append(host.get(*OUTPUTS))
        if after is not None:
            host.step(time, after - time)
    return np.array(rows)


# --- the body ---

BODY = {"kind": "body", "m_x": 2.0e5, "m_y": 3.0e5, "k_x": 1.0e4, "c_x": 1.2e4, "k_y": 8.0e5, "c_y": 9.0e4}


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
    """Undamped to strongly overdamped, steps from a hundredth of the period to several periods: all exact."""
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

SINES = {
    "kind": "sines",
    "x": {"amplitude": "1.5 m", "period": 8.0, "phase": "30 deg"},
    "y": [{"amplitude": 0.8, "frequency": 0.21}, {"amplitude": -0.3, "frequency": 0.5, "phase": 1.0}],
    "ramp": 5.0,
}


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


def write_csv(path: Path, times: Floats, x: Floats, y: Floats) -> str:
    lines = [
        "time,x,y",
        *(f"{t!r},{a!r},{b!r}" for t, a, b in zip(*map(np.ndarray.tolist, (times, x, y)), strict=True)),
    ]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


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


# --- state ---


@pytest.fixture(scope="module")
def kinds(build: Build, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One vessel of every kind, the body with all ways to go on within a step."""
    times = np.arange(41) * 0.25
    file = write_csv(tmp_path_factory.mktemp("csv") / "m.csv", times, np.sin(times), np.cos(times))
    bodies = {f"body-{e}": build(**BODY, extrapolation=e, name=f"body-{e}") for e in (0, 1, 2, "given")}
    return {"sines": build(**SINES), "csv": build(kind="csv", file=file), **bodies}


KINDS = ("sines", "csv", "body-0", "body-1", "body-2", "body-given")


def pull(host: Host, t: float) -> None:
    """A value for whatever inputs there are."""
    host.set_all({name: 1.0e4 * np.sin(3.0 * t + k) for k, name in enumerate(host.names("input"))})


def bits(host: Host) -> bytes:
    return np.array(host.get(*host.reference)).tobytes()


@pytest.mark.parametrize("kind", KINDS)
def test_a_step_repeated_a_hundred_times_leaves_no_trace(kind: str, kinds: dict[str, Path]) -> None:
    def start(host: Host) -> None:
        host.initialize()
        for k in range(4):
            pull(host, k * 0.1)
            host.step(k * 0.1, 0.1)

    def finish(host: Host) -> list[bytes]:
        rows = []
        for k in range(4, 10):
            pull(host, k * 0.1)
            host.step(k * 0.1, 0.1)
            rows.append(bits(host))
        return rows

    with Host(kinds[kind]) as once, Host(kinds[kind]) as often:
        start(once)
        start(often)
        taken = often.take()
        before = often.image_of(taken)
        for trial in range(100):
            pull(often, 7.0 * trial)  # other forces, other step sizes, more steps than one
            often.step(0.4, 0.1 + 0.001 * trial)
            often.step(0.5 + 0.001 * trial, 0.05)
            often.put(taken)
        assert often.save() == before
        often.free(taken)
        assert finish(often) == finish(once)


@pytest.mark.parametrize("kind", KINDS)
def test_serialized_state_goes_on_in_another_instance_with_the_same_bits(kind: str, kinds: dict[str, Path]) -> None:
    with Host(kinds[kind]) as first, Host(kinds[kind]) as second:
        first.initialize()
        for k in range(3):
            pull(first, k * 0.1)
            first.step(k * 0.1, 0.1)
        image = first.save()
        second.load(image)
        assert second.save() == image and bits(second) == bits(first)
        for host in (first, second):
            pull(host, 5.0)
            host.step(0.30000000000000004, 0.2)
        assert bits(second) == bits(first)


def test_parameters_are_part_of_a_state(kinds: dict[str, Path]) -> None:
    with Host(kinds["body-0"]) as saved, Host(kinds["body-0"]) as other:
        image = saved.initialize(m_x=1.0e5, x_0=0.5).save()
        other.load(image)
        assert other.get("m_x", "x", "ax") == [1.0e5, 0.5, -0.05]


def test_a_state_that_is_damaged_or_of_another_vessel_is_refused(kinds: dict[str, Path]) -> None:
    with Host(kinds["body-0"]) as host:
        image = bytearray(host.initialize().save())
    image[len(image) // 2] ^= 1
    with Host(kinds["body-0"]) as host:
        refused(host, "the state is damaged", host.load, bytes(image))
    with Host(kinds["sines"]) as host:
        foreign = host.initialize().save()
    with Host(kinds["body-0"]) as host:
        refused(host, "the state is of another vessel", host.load, foreign)


# --- refusals ---


def refused(host: Host, says: str, call: Callable[..., Any], *arguments: Any, **named: Any) -> None:
    """The call ends with fmi2Fatal, which is all that pythonfmu has for it, and one message."""
    before = len(host.messages)
    with pytest.raises(FMICallException) as mistake:
        call(*arguments, **named)
    assert mistake.value.status == 4
    assert len(host.messages) == before + 1 and says in host.messages[-1], host.messages


MISTAKES: dict[str, tuple[Callable[[Host], object], str]] = {
    "NaN": (lambda host: host.set(F_x=float("nan")), "F_x = nan at t = 0.3 s: a finite number is expected"),
    "infinity": (lambda host: host.set(F_y=float("-inf")), "F_y = -inf at t = 0.3 s: a finite number is expected"),
    "too late": (lambda host: host.set(m_x=1.0), "m_x = 1.0 at t = 0.3 s: parameters are fixed once initialization"),
    "output": (lambda host: host.set(ax=1.0), "ax = 1.0 at t = 0.3 s: it is calculated and cannot be set"),
    "no step": (lambda host: host.step(0.3, 0.0), "doStep at t = 0.3 s: communication step 0.0 s; a number above 0"),
    "NaN step": (lambda host: host.step(0.3, float("nan")), "communication step nan s; a number above 0"),
    "too short": (lambda host: host.step(0.3, 1e-18), "step 1e-18 s; a number above 0 that moves time on"),
    "NaN point": (lambda host: host.step(float("nan"), 0.1), "communication point nan s is not where the last step"),
    "elsewhere": (lambda host: host.step(0.4, 0.1), "communication point 0.4 s is not where the last step ended"),
    "too strong": (
        lambda host: (host.set(F_y=1e308), host.step(0.3, 1e3)), "the step leads to no finite number; the force is too"
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_are_refused_in_words(mistake: str, kinds: dict[str, Path], capfd: pytest.CaptureFixture[str]) -> None:
    make, says = MISTAKES[mistake]
    with Host(kinds["body-1"]) as host:
        host.initialize()
        host.step(0.0, 0.3)
        refused(host, says, make, host)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [("m_x", 0.0, "above 0"), ("c_y", -1.0, "0 or more"), ("k_x", -1.0, "0 or more"), ("x_0", np.nan, "finite")],
)
def test_parameters_without_sense_are_refused(name: str, value: float, says: str, kinds: dict[str, Path]) -> None:
    with Host(kinds["body-0"]) as host:
        refused(host, f"{name} = {value} at t = 0 s: a", host.set_all, {name: value})
        assert says in host.messages[-1]


def test_a_step_past_the_stop_time_is_refused(kinds: dict[str, Path]) -> None:
    with Host(kinds["sines"]) as host:
        host.fmu.setupExperiment(startTime=0.0, stopTime=0.5)
        host.fmu.enterInitializationMode()
        host.fmu.exitInitializationMode()
        host.step(0.0, 0.5)
        refused(host, "communication step 0.1 s leads past the stop time, 0.5 s", host.step, 0.5, 0.1)


def test_a_run_that_ends_early_does_not_look_like_one_that_ended_well(build: Build, tmp_path: Path) -> None:
    """simulate_fmu stops without a word when pythonfmu discards a step; so a vessel does not discard."""
    times = np.arange(5.0)
    folder = build(kind="csv", file=write_csv(tmp_path / "m.csv", times, times, times))
    assert len(simulate_fmu(str(folder), stop_time=4.0, output_interval=0.5)) == 9
    with pytest.raises(FMICallException):
        simulate_fmu(str(folder), stop_time=5.0, output_interval=0.5)


def test_a_refusal_leaves_the_process_sound(kinds: dict[str, Path]) -> None:
    """pythonfmu gives up its references twice after an error: unless the vessel adds some, memory is freed in use."""
    (module,) = (kinds["body-0"] / "resources" / "slavemodule.txt").read_text().split()

    def references() -> int:
        gc.collect()
        return sys.getrefcount(sys.modules[module].Vessel)

    def mistaken() -> None:
        with Host(kinds["body-0"]) as host:
            refused(host, "F_x = nan", host.set, F_x=float("nan"))

    mistaken()
    before = references()
    for _ in range(20):
        mistaken()
    assert references() == before


def test_reset_goes_back_to_the_start(kinds: dict[str, Path]) -> None:
    with Host(kinds["body-2"]) as host:
        start = host.get(*host.reference)
        host.initialize(m_x=1.0, F_x=50.0).step(0.0, 0.1)
        host.fmu.reset()
        assert host.get(*host.reference) == start


def test_vessels_in_one_process_do_not_touch_each_other(kinds: dict[str, Path], build: Build) -> None:
    """Of all kinds, two of them of one name: step by step beside each other as each by itself."""
    folders = [*kinds.values(), build(**(BODY | {"m_x": 1.0e5}), name="vessel"), build(**SINES, name="vessel")]

    def stepped(hosts: list[Host]) -> list[list[bytes]]:
        for host in hosts:
            host.initialize()
        rows: list[list[bytes]] = [[] for _ in hosts]
        for k in range(5):
            for host, row in zip(hosts, rows, strict=True):
                pull(host, k * 0.1)
                host.step(k * 0.1, 0.1)
                row.append(bits(host))
        for host in hosts:
            host.fmu.freeInstance()
        return rows

    together = stepped([Host(folder) for folder in folders])
    assert together == [rows for folder in folders for rows in stepped([Host(folder)])]
    assert len({tuple(rows) for rows in together}) == len(folders) - 1  # sines are there twice
