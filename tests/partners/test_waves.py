"""Seas by themselves: linear theory's closed forms, waves that are not linear, spectra."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import numpy as np
import pytest
import raschii
import sympy
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.signal import welch

from cablefmu import Waves
from cablefmu.cable import Floats
from tests.partners.seas import AIRY, ALL, FENTON, JONSWAP, SHORT, Build, builder, slave, values

ROUNDING = 1e-12
"""Of a wave's largest value; its phase is some 100 rad, each good to 1e-16."""


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """build(name=..., **table): folder of that sea's FMU."""
    return builder(tmp_path_factory.mktemp("seas"))


def at(number: int) -> list[str]:
    return [f"{name}[{number}]" for name in ("elevation", "vx", "vy", "ax", "ay")]


# --- linear theory ---


def potential(depth: bool) -> tuple[Callable[..., Floats], sympy.Expr]:
    """Elevation, velocities and accelerations by the derivatives of Airy's potential, z up; and the potential."""
    a, g, k, d, w, p, x, z, t = sympy.symbols("a g k d w p x z t", real=True)
    profile = sympy.cosh(k * (z + d)) / sympy.cosh(k * d) if depth else sympy.exp(k * z)
    phi = a * g / w * profile * sympy.sin(k * x - w * t + p)
    across, up = phi.diff(x), phi.diff(z)
    surface = -phi.diff(t).subs(z, 0) / g
    formulas = [surface, across, -up, across.diff(t), -up.diff(t)]
    return sympy.lambdify((a, g, k, d, w, p, x, z, t), formulas, "numpy"), phi


@pytest.mark.parametrize("depth", [14.0, None])
@pytest.mark.parametrize("direction", [0.0, 180.0])
def test_airy_is_the_derivatives_of_its_potential(build: Build, depth: float | None, direction: float) -> None:
    table = {key: value for key, value in AIRY.items() if key != "depth"} | ({"depth": depth} if depth else {})
    points = [{"x": 0.0}, {"x": -31.0, "y": 3.0}, {"x": 12.0, "y": 14.0}]
    folder = build(**table, direction=f"{direction} deg", points=points, outputs=ALL)
    omega = 2.0 * np.pi / 7.0
    d = depth or 0.0
    k = brentq(lambda k: 9.81 * k * (np.tanh(k * d) if depth else 1.0) - omega**2, 1e-4, 1.0, xtol=1e-16, rtol=1e-15)
    formulas, _ = potential(bool(depth))
    times = np.arange(60) * 0.37
    way = 1.0 if direction == 0.0 else -1.0
    for number, point in enumerate(points, start=1):
        seen = values(folder, at(number), times).T
        x, z = way * point["x"], -point.get("y", 0.0)
        expected = np.array(formulas(1.2, 9.81, k, d, omega, np.radians(40.0), x, z, times))
        expected[[1, 3]] *= way  # a wave to the left is one to the right in the mirror
        assert np.abs(seen - expected).max() < 10 * ROUNDING


def test_the_potential_that_it_is_compared_with_solves_the_problem() -> None:
    """Laplace's equation, no flow through the seabed, and a surface that moves with the water."""
    _, phi = potential(True)
    a, g, k, d, w, _, x, z, t = sympy.symbols("a g k d w p x z t", real=True)
    assert sympy.simplify(phi.diff(x, 2) + phi.diff(z, 2)) == 0
    assert phi.diff(z).subs(z, -d) == 0
    kinematic = phi.diff(z).subs(z, 0) + phi.diff(t, 2).subs(z, 0) / g
    assert sympy.simplify(kinematic.subs(g, w**2 / (k * sympy.tanh(k * d))).rewrite(sympy.exp)) == 0
    assert a in phi.free_symbols


def test_above_the_still_water_linear_theory_is_that_of_its_level(build: Build) -> None:
    points = [{"y": 0.0}, {"y": -1.0}, {"y": -500.0}]
    seen = values(build(**AIRY, points=points, outputs=ALL), [*at(1), *at(2), *at(3)], np.arange(10) * 0.6)
    assert np.array_equal(seen[:, :5], seen[:, 5:10]) and np.array_equal(seen[:, :5], seen[:, 10:])


@pytest.mark.parametrize("table", [AIRY, SHORT], ids=["airy", "jonswap"])
def test_height_of_linear_waves_is_a_parameter(build: Build, table: dict[str, object]) -> None:
    name = "height" if table is AIRY else "significant_height"
    times, folder = np.arange(30) * 0.9, build(**table)
    double = values(folder, ["elevation[1]"], times, **{name: 2.0 * float(str(table[name]))})
    assert np.array_equal(double, 2.0 * values(folder, ["elevation[1]"], times))


def test_phase_is_a_parameter(build: Build) -> None:
    """Of all harmonics: a crest a quarter of a period earlier."""
    folder = build(**FENTON, outputs=ALL)
    times = np.arange(30) * 0.25
    turned = values(folder, at(1), times, phase=-np.pi / 2)
    assert np.abs(turned - values(folder, at(1), times + 2.25)).max() < 10 * ROUNDING


@pytest.mark.parametrize("table", [AIRY, FENTON, SHORT], ids=["airy", "fenton", "jonswap"])
def test_the_ramp_grows_velocities_and_accelerations_are_their_slopes(build: Build, table: dict[str, object]) -> None:
    """Central differences over 2 ms: their error is the third derivative, some m/s^4, times 2e-7."""
    h, names = 1e-3, at(1)
    centres = np.arange(0.5, 30.0, 1.7)
    times = np.ravel([centres - h, centres, centres + h], order="F")
    point = [{"x": 5.0, "y": 2.0}]
    ramped, full = (values(build(**table, ramp=r, points=point, outputs=ALL), names, times) for r in (20.0, 0.0))
    before, now, after = ramped[0::3], ramped[1::3], ramped[2::3]
    assert np.abs((after - before)[:, 1:3] / (2.0 * h) - now[:, 3:]).max() < 3e-6
    s = np.clip(times / 20.0, 0.0, 1.0)
    grown = (6.0 * s**5 - 15.0 * s**4 + 10.0 * s**3)[:, None]
    assert np.abs(ramped[:, :3] - grown * full[:, :3]).max() < ROUNDING
    assert np.array_equal(ramped[times > 20.0], full[times > 20.0])


# --- waves that are not linear ---


@pytest.mark.parametrize(
    ("kind", "table"),
    [
        ("Fenton", FENTON), ("Fenton", FENTON | {"depth": 10.0, "order": 16}), ("Fenton", FENTON | {"depth": 900.0}),
        ("Stokes", FENTON | {"kind": "stokes", "depth": 60.0}),
    ],
    ids=["fenton", "shallow", "deep", "stokes"],
)  # fmt: skip
def test_nonlinear_waves_are_raschiis(build: Build, kind: str, table: dict[str, object]) -> None:
    """Its own evaluation, at depths and in the crest."""
    points = [{"x": 3.0}, {"x": 20.0, "y": 6.0}, {"x": 0.0, "y": -2.0}]
    train = Waves.from_table(table).train
    folder = build(**table, points=points, outputs=ALL)
    length = 2.0 * np.pi / train.k[0]
    depth = min(float(str(table["depth"])), 5.0 * length)
    order = len(train.k)
    make = raschii.FentonWave if kind == "Fenton" else raschii.StokesWave
    more = {"relax": 1.0} if kind == "Fenton" else {}
    wave = make(5.0, depth, length, N=order, **more)
    assert train.period == 9.0 and wave.period == pytest.approx(9.0, rel=1e-9)
    times = np.arange(40) * 0.25
    for number, point in enumerate(points, start=1):
        seen = values(folder, at(number), times)
        x, z = point["x"], depth - point.get("y", 0.0)
        assert np.abs(seen[:, 0] - wave.surface_elevation(x, times, include_depth=False)).max() < ROUNDING
        across, up = wave.velocity(x, z, times, all_points_wet=True).T
        assert np.abs(seen[:, 1] - across).max() < ROUNDING and np.abs(seen[:, 2] + up).max() < ROUNDING
        if kind == "Fenton":  # it has no accelerations for Stokes' waves
            across, up = wave.acceleration(x, z, times, all_points_wet=True).T
            assert np.abs(seen[:, 3] - across).max() < ROUNDING and np.abs(seen[:, 4] + up).max() < ROUNDING


def test_the_stream_function_wave_fulfils_bernoullis_equation_on_its_surface(build: Build) -> None:
    """Of no one's code but the FMU's: in the frame of the wave the pressure is the same all along, and no water crosses
    the surface. The order's truncation leaves 1e-9 of g H."""
    table = FENTON | {"order": 16}
    train = Waves.from_table(table).train
    length = 2.0 * np.pi / train.k[0]
    x = np.linspace(-0.5, 0.5, 33) * length
    folder = build(**table, points=[{"x": v} for v in x.tolist()])
    surface = values(folder, [f"elevation[{k + 1}]" for k in range(len(x))], np.zeros(1))[0]
    assert surface.max() - surface.min() == pytest.approx(5.0, abs=1e-6)
    on_it = [{"x": v, "y": -e} for v, e in zip(x.tolist(), surface.tolist(), strict=True)]
    velocity = build(**table, points=on_it, outputs=["velocity"])
    u, down = (values(velocity, [f"{v}[{k + 1}]" for k in range(len(x))], np.zeros(1))[0] for v in ("vx", "vy"))
    relative = u - length / train.period
    head = (relative**2 + down**2) / 2.0 + 9.81 * surface
    assert np.ptp(head) < 1e-8 * 9.81 * 5.0
    slope = np.array([-np.sum(train.elevation * train.k * np.sin(train.k * v)) for v in x])
    assert np.abs(-down - relative * slope).max() < 1e-7


def test_low_waves_are_the_same_in_every_theory(build: Build) -> None:
    """They differ by the steepness squared: H/L = 1e-5."""
    low = {"height": 1e-3, "period": 8.0, "depth": 30.0, "points": [{"x": 11.0, "y": 4.0}], "outputs": ALL}
    times = np.arange(20) * 0.5
    airy, stokes, fenton = (values(build(kind=kind, **low), at(1), times) for kind in ("airy", "stokes", "fenton"))
    assert np.abs(stokes - airy).max() < 1e-7 and np.abs(fenton - airy).max() < 1e-7


# --- irregular seas ---


def spectrum(f: float, peak: float, gamma: float) -> float:
    """JONSWAP's formula (Hasselmann et al. 1973), less its constants; gamma = 1 is Pierson and Moskowitz'."""
    r = f / peak
    width = 0.07 if r <= 1.0 else 0.09
    return float(r**-5 * np.exp(-1.25 * r**-4) * gamma ** np.exp(-((r - 1.0) ** 2) / (2.0 * width**2)))


@pytest.mark.parametrize("kind", ["jonswap", "pierson-moskowitz"])
def test_three_hours_of_sea_have_the_spectrum(build: Build, kind: str) -> None:
    """Height, peak, zero crossings and the energy in ten bands, from the elevation alone, every 0.9 s.

    Three hours are the time after which the sea begins again, so its variance and the periodogram are exact. Zero
    crossings are counted: some 1,200 of them, good to 1 %.
    """
    peak, step, height = 1.0 / 12.0, 0.9, 3.0
    gamma = 3.3 if kind == "jonswap" else 1.0
    times = np.arange(12_000) * step
    elevation = values(build(**JONSWAP | {"kind": kind, "peak_period": 12.0}), ["elevation[1]"], times)[:, 0]
    assert abs(elevation.mean()) < 1e-9
    assert 4.0 * elevation.std() == pytest.approx(height, rel=1e-9)
    assert abs(np.mean(elevation**3) / elevation.std() ** 3) < 0.1  # symmetrical, and as high as Gauss has it
    assert np.mean(elevation**4) / elevation.std() ** 4 == pytest.approx(3.0, abs=0.2)

    # Smoothed over 12 lines, 0.001 Hz, a hundredth of the peak: that many harmonics have one peak.
    energy = np.abs(np.fft.rfft(elevation)) ** 2 * 2.0 / len(times) ** 2
    frequency = np.fft.rfftfreq(len(times), step)
    smooth = np.convolve(energy, np.ones(13) / 13.0, mode="same")
    assert frequency[smooth.argmax()] == pytest.approx(peak, rel=0.005)
    by_welch = welch(elevation, 1.0 / step, nperseg=1024)
    assert by_welch[0][by_welch[1].argmax()] == pytest.approx(peak, rel=0.1)  # its lines scatter by a quarter

    def moment(order: int, low: float, high: float) -> float:
        at_peak = [peak] if low < peak < high else None
        return float(quad(lambda f: f**order * spectrum(f, peak, gamma), low, high, points=at_peak, limit=200)[0])

    whole = moment(0, 0.5 * peak, 6.0 * peak)
    edges = peak * np.array([0.5, 0.7, 0.85, 0.95, 1.05, 1.2, 1.5, 2.0, 3.0, 4.5, 6.01])
    for low, high in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        seen = energy[(frequency >= low) & (frequency < high)].sum()
        assert seen == pytest.approx((height / 4.0) ** 2 * moment(0, low, high) / whole, rel=0.02)
    fine = np.fft.irfft(np.fft.rfft(elevation), 8 * len(times))  # the same curve, so that no short wave is missed
    crossings = np.count_nonzero((fine[:-1] < 0.0) & (fine[1:] >= 0.0))
    expected = np.sqrt(moment(2, 0.5 * peak, 6.0 * peak) / whole)
    assert crossings / 10_800.0 == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("direction", [0.0, 180.0])
def test_all_of_an_irregular_sea_follows_from_its_elevation_at_one_point(build: Build, direction: float) -> None:
    """Its Fourier transform over the repetition time, and linear theory's transfer functions."""
    depth, count = 60.0, 1024
    table = SHORT | {"direction": f"{direction} deg", "outputs": ALL}
    folder = build(**table, points=[{}, {"x": 140.0, "y": 9.0}])
    times = np.arange(count) * (200.0 / count)
    seen = values(folder, [*at(1), *at(2)], times)
    lines = np.fft.rfft(seen[:, 0])
    assert np.count_nonzero(np.abs(lines) > 1e-9) == len(Waves.from_table(table).train.k)
    omega = 2.0 * np.pi * np.arange(len(lines)) / 200.0
    k = np.array([0.0, *(brentq(lambda k, w=w: 9.81 * k * np.tanh(k * depth) - w**2, 1e-9, 99.0) for w in omega[1:])])
    way = 1.0 if direction == 0.0 else -1.0
    there = lines * np.exp(
        -1j * way * k * 140.0
    )  # e^(i omega t) is numpy's, e^(i (k x - omega t)) the wave's conjugate
    with np.errstate(over="ignore", invalid="ignore"):
        across = np.nan_to_num(np.where(k > 0.0, omega * np.cosh(k * (depth - 9.0)) / np.sinh(k * depth), 0.0))
        up = np.nan_to_num(np.where(k > 0.0, omega * np.sinh(k * (depth - 9.0)) / np.sinh(k * depth), 0.0))
    u, down = way * across * there, -1j * up * there
    for place, line in ((5, there), (6, u), (7, down), (8, 1j * omega * u), (9, 1j * omega * down)):
        assert np.abs(seen[:, place] - np.fft.irfft(line, count)).max() < 1e-9


def test_seeds_make_different_seas_of_one_spectrum(build: Build) -> None:
    """Set on the FMU or built in: the same. Different ones have nothing to do with each other."""
    times = np.arange(0.0, 200.0, 0.5)
    one, other = (build(**SHORT | {"seed": seed}) for seed in (7, 8))
    seen = {seed: values(one, ["elevation[1]"], times, seed=seed)[:, 0] for seed in (7.0, 8.0, 2.0**53 - 1.0)}
    assert np.array_equal(seen[8.0], values(other, ["elevation[1]"], times)[:, 0])
    assert np.abs(np.corrcoef(list(seen.values())) - np.eye(3)).max() < 0.5  # a third of 120 waves carry the energy


def test_a_sea_begins_again_after_its_duration_and_not_before(build: Build) -> None:
    times = np.arange(0.0, 20.0, 0.5)
    first, second, half = (
        values(build(**SHORT), ["elevation[1]"], times + start)[:, 0] for start in (0.0, 200.0, 100.0)
    )
    assert np.abs(second - first).max() < 1e-11
    assert np.abs(half - first).max() > 0.5


# --- the script's own numbers ---


def test_sine_and_cosine_are_good_to_the_last_digits() -> None:
    turns = np.array([0.0, 0.125, 0.25, 0.5, 0.75, 1.0, -0.3, 1e-9, 12345.678901, -7.0 / 3.0, *np.linspace(-1, 1, 199)])
    sine, cosine = slave().sincos(turns)
    with mpmath.workdps(40):
        angles = [2 * mpmath.pi * mpmath.mpf(turn) for turn in turns.tolist()]
        exact = np.array([[float(mpmath.sin(angle)), float(mpmath.cos(angle))] for angle in angles]).T
    assert np.abs(np.array([sine, cosine]) - exact).max() < 3e-16


def test_phases_are_those_of_splitmix64() -> None:
    """Its published test vector, and its steps in whole numbers of Python."""
    golden = 0x9E3779B97F4A7C15
    states = np.array([(1234567 + n * golden) % 2**64 for n in range(1, 6)], np.uint64)
    published = [
        6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431, 16408922859458223821
    ]  # fmt: skip
    assert slave().mixed(states).tolist() == published

    def mixed(z: int) -> int:
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
        z = (z ^ (z >> 27)) * 0x94D049BB133111EB % 2**64
        return z ^ (z >> 31)

    for seed in (0, 1, 2**53 - 1):
        key = mixed((seed + 1) * golden % 2**64)
        expected = [(mixed((key + n * golden) % 2**64) >> 11) / 2**53 for n in (1, 2, 7000)]
        assert slave().scattered(float(seed), np.array([1.0, 2.0, 7000.0])).tolist() == expected
