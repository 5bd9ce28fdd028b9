"""Vessels that float in waves, under FMPy: what the coefficients say in the frequency domain, stepped in time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from cablefmu import Vessel, VesselError
from cablefmu.cable import Floats
from cablefmu.fmu.vessel_waves import fitted
from cablefmu.hydrodynamics import Hydrodynamics, read_database, shipped_database
from tests.fmu_helpers import Host
from tests.partners.vessels import Build, builder, run

MOORING = {"buoy": (60.0, 2.0e3, 3.0e3), "barge": (120.0, 2.0e4, 8.0e4)}
"""By body: when its start is forgotten [s], and the spring [N/m] and damper [N s/m] along x that see to it."""


def moored(name: str) -> dict[str, object]:
    """Keys of a table."""
    _, spring, damper = MOORING[name]
    return {"kind": "floating", "body": name, "k_x": spring, "c_x": damper}


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """build(name=..., **table): folder of that vessel's FMU."""
    return builder(tmp_path_factory.mktemp("floating"))


@pytest.fixture(scope="module")
def buoy(build: Build) -> Path:
    return build(**moored("buoy"), extrapolation="given")


@pytest.fixture(scope="module")
def barge(build: Build) -> Path:
    return build(**moored("barge"), extrapolation="given")


def shipped(name: str) -> Hydrodynamics:
    return read_database(shipped_database(name))


# --- regular waves ---


def arriving(body: Hydrodynamics, omega: float, way: int = 1) -> npt.NDArray[np.complex128]:
    """Elevations at the points, as amplitudes of waves of 1 m that travel to +x (1) or -x (-1)."""
    return np.asarray(np.exp(-1j * way * omega**2 / body.gravity * body.points))


def wave(amplitudes: npt.NDArray[np.complex128], omega: float) -> Callable[[float], dict[str, float]]:
    """Elevations and their slopes at a time."""

    def inputs(t: float) -> dict[str, float]:
        values = {}
        for order, form in enumerate(("{}", "der({})", "der({},2)")):
            now = (amplitudes * (1j * omega) ** order * np.exp(1j * omega * t)).real
            values |= {form.format(f"elevation[{k}]"): float(value) for k, value in enumerate(now, start=1)}
        return values

    return inputs


def amplitude(times: Floats, values: Floats, omega: float) -> complex:
    """Of the oscillation with omega in the values, by least squares with a mean."""
    columns = np.stack([np.cos(omega * times), -np.sin(omega * times), np.ones_like(times)], axis=-1)
    real, imaginary, _ = np.linalg.lstsq(columns, values, rcond=None)[0]
    return complex(real, imaginary)


def expected(body: Hydrodynamics, axis: int, omega: float, spring: float, damper: float) -> complex:
    """Response in waves of 1 m that travel to +x, of the coefficients alone."""
    mass, damping, force = (
        CubicSpline(body.omega, values[:, axis])(omega) for values in (body.added_mass, body.damping, body.excitation)
    )
    inertia = -(omega**2) * (body.mass + mass) + 1j * omega * (damping + damper)
    return complex(force / (inertia + body.stiffness[axis] + spring))


def off_by(folder: Path, name: str, period: float) -> list[float]:
    """How far surge and heave of a stepped FMU are from the coefficients' response, phase included, by its size."""
    body, omega = shipped(name), 2.0 * np.pi / period
    step = period / 30.0
    settled, spring, damper = MOORING[name]
    count = int(settled / step) + 90
    times = np.arange(count) * step
    with Host(folder) as host:
        rows = run(host.initialize(), times, wave(arriving(body, omega), omega))
    late = slice(count - 90, None)
    sought = [expected(body, axis, omega, *mooring) for axis, mooring in enumerate([(spring, damper), (0.0, 0.0)])]
    return [abs(amplitude(times[late], rows[late, axis], omega) / value - 1.0) for axis, value in enumerate(sought)]


@pytest.mark.parametrize("period", [3.0, 3.5, 4.5, 6.0, 9.0, 15.0])
def test_response_of_the_buoy_in_regular_waves_is_that_of_the_coefficients(buoy: Path, period: float) -> None:
    """Within 2 % of heave and surge themselves, the phase included, from next to the resonance of heave (2.8 s) on."""
    assert np.max(off := off_by(buoy, "buoy", period)) < 0.02, off


@pytest.mark.parametrize("period", [4.0, 4.7, 6.5, 12.0])
def test_response_of_the_barge_in_regular_waves_is_that_of_the_coefficients(barge: Path, period: float) -> None:
    """Within 1 %, about the resonance of heave (4.6 s) and in longer waves."""
    assert np.max(off := off_by(barge, "barge", period)) < 0.01, off


def test_waves_from_the_right_push_the_other_way_and_lift_alike(buoy: Path) -> None:
    body, omega = shipped("buoy"), 1.3
    times = np.arange(100) * 0.1
    rows = []
    for way in (1, -1):
        with Host(buoy) as host:
            rows.append(run(host.initialize(), times, wave(arriving(body, omega, way), omega)))
    size = np.max(np.abs(rows[0]))
    np.testing.assert_allclose(rows[0][:, 0::2], -rows[1][:, 0::2], atol=1e-9 * size)
    np.testing.assert_allclose(rows[0][:, 1::2], rows[1][:, 1::2], atol=1e-9 * size)


def test_the_barge_in_long_waves_goes_with_the_water(build: Build) -> None:
    """Waves of 30 s: heave is the elevation, and y is down. Surge, hardly moored: that of the water, 1/(k L)^2 less."""
    body, omega = shipped("barge"), 2.0 * np.pi / 30.0
    times = np.arange(300) * 1.0
    with Host(build(kind="floating", body="barge", c_x=2.0e3, extrapolation="given")) as host:
        rows = run(host.initialize(), times, wave(arriving(body, omega), omega))
    late = slice(210, None)
    heave = amplitude(times[late], rows[late, 1], omega)
    assert abs(heave + 1.0) < 0.02
    assert abs(heave - expected(body, 1, omega, 0.0, 0.0)) < 0.01


# --- a body that is held ---


def test_a_held_body_tells_the_force_of_the_coefficients(build: Build) -> None:
    body, omega = shipped("buoy"), 1.4
    times = np.arange(400) * 0.1
    with Host(build(kind="excitation", body="buoy", extrapolation="given")) as host:
        assert host.names("output") == ["F_wave_x", "F_wave_y"]
        host.initialize()
        rows = []
        for time in times:
            host.set_all(wave(arriving(body, omega), omega)(float(time)))
            rows.append(host.get("F_wave_x", "F_wave_y"))
            host.step(float(time), 0.1)
    late = slice(200, None)
    for axis, column in enumerate(np.transpose(rows)):
        sought = complex(CubicSpline(body.omega, body.excitation[:, axis])(omega))
        assert abs(amplitude(times[late], column[late], omega) - sought) < 0.01 * np.max(
            np.abs(body.excitation[:, axis])
        )


def test_a_held_body_and_a_floating_one_feel_the_same_waves(build: Build, buoy: Path) -> None:
    body = shipped("buoy")
    seen = []
    for folder in (buoy, build(kind="excitation", body="buoy", extrapolation="given")):
        with Host(folder) as host:
            host.initialize()
            for k in range(50):
                host.set_all(wave(arriving(body, 1.1), 1.1)(k * 0.2))
                host.step(k * 0.2, 0.2)
            seen.append(host.get("F_wave_x", "F_wave_y"))
    assert seen[0] == pytest.approx(seen[1], rel=1e-9)


# --- the equation, against scipy's DOP853, which knows no exponential ---


def pulses(t: float) -> tuple[float, float]:
    """Force of the cable along y [N] and elevation at all points [m]; both begin gently."""
    return 4.0e3 * (1.0 - np.cos(0.9 * t)) ** 2, 0.4 * (1.0 - np.cos(0.7 * t)) ** 2


def rates(t: float) -> dict[str, float]:
    """Values and the first two derivatives of both."""
    found = {}
    for name, size, w in (("F_y", 4.0e3, 0.9), *((f"elevation[{k}]", 0.4, 0.7) for k in range(1, 6))):
        gone = 1.0 - np.cos(w * t)
        found[name] = size * gone**2
        found[f"der({name})"] = size * 2.0 * w * gone * np.sin(w * t)
        found[f"der({name},2)"] = size * 2.0 * w**2 * (np.sin(w * t) ** 2 + gone * np.cos(w * t))
    return found


@pytest.fixture(scope="module")
def solved() -> Floats:
    """Heave of the buoy under both, every 0.2 s up to 4 s."""
    body = shipped("buoy")
    radiation, excitation = (both[1] for both in fitted(body, tuple(body.points.tolist())))
    n, mass = len(radiation.output), body.mass + body.added_mass_at_infinity[1]
    lift = excitation.elevations @ excitation.signals @ np.ones(len(body.points))

    def right(t: float, z: Floats) -> Floats:
        pull, elevation = pulses(t)
        q, v, r, e = z[0], z[1], z[2 : 2 + n], z[2 + n :]
        total = pull + excitation.output @ e - radiation.output @ r - body.stiffness[1] * q
        return np.concatenate([
            [v, total / mass], radiation.matrix @ r + radiation.velocity * v, excitation.matrix @ e + lift * elevation
        ])  # fmt: skip

    start = np.zeros(2 + n + len(excitation.output))
    times = np.arange(21) * 0.2
    return np.asarray(solve_ivp(right, (0.0, 4.0), start, "DOP853", times, rtol=1e-11, atol=1e-13).y[0])


@pytest.mark.parametrize(("extrapolation", "order"), [(0, 1), (1, 2), (2, 3), ("given", 3)])
def test_order_of_extrapolation(build: Build, solved: Floats, extrapolation: int | str, order: int) -> None:
    folder, errors = build(kind="floating", body="buoy", extrapolation=extrapolation), []
    for parts in (4, 8, 16):
        with Host(folder) as host:
            names = host.names("input")

            def inputs(t: float, names: list[str] = names) -> dict[str, float]:
                return {name: value for name, value in rates(t).items() if name in names}

            seen = run(host.initialize(), np.arange(20 * parts + 1) * (0.2 / parts), inputs)[::parts, 1]
        errors.append(np.max(np.abs(seen - solved)))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([order, order], abs=0.2), errors


def test_steps_of_any_length_are_exact(build: Build) -> None:
    """Pulled by a constant force: one step of 4 s, or 400; and 3,000 s later it hangs where its springs hold it."""
    with Host(build(kind="floating", body="buoy", k_x=500.0, c_x=400.0)) as host:
        host.initialize(F_x=1.0e3, F_y=2.0e3)
        host.step(0.0, 4.0)
        once = host.get("x", "y", "vx", "vy", "ax", "ay")
        host.step(4.0, 3000.0)
        assert host.get("x", "y") == pytest.approx([2.0, 2.0e3 / shipped("buoy").stiffness[1]], rel=1e-6)
    with Host(build(kind="floating", body="buoy", k_x=500.0, c_x=400.0)) as host:
        host.initialize(F_x=1.0e3, F_y=2.0e3)
        for k in range(400):
            host.step(k * 0.01, 0.01)
        assert host.get("x", "y", "vx", "vy", "ax", "ay") == pytest.approx(once, rel=1e-9, abs=1e-11)


# --- energy, loads, parameters ---


@pytest.mark.parametrize("body", ["buoy", "barge"])
def test_radiated_waves_take_energy_and_give_none(build: Build, body: str) -> None:
    """Let go: what floats never has more energy than at the start, and after a while next to none."""
    held = shipped(body)
    mass = held.mass + held.added_mass_at_infinity
    with Host(build(kind="floating", body=body, k_x=0.05 * float(mass[0]), y_0=0.6, x_0=1.0)) as host:
        rows = run(host.initialize(), np.arange(600) * 0.2)
    heave = 0.5 * mass[1] * rows[:, 3] ** 2 + 0.5 * held.stiffness[1] * rows[:, 1] ** 2
    surge = 0.5 * mass[0] * rows[:, 2] ** 2 + 0.5 * 0.05 * mass[0] * rows[:, 0] ** 2
    assert np.max(heave) <= heave[0] and np.max(surge) <= surge[0]
    assert heave[-1] < 1e-3 * heave[0]


def test_acceleration_answers_a_pull_at_once_by_the_mass_at_infinite_frequency(buoy: Path) -> None:
    body = shipped("buoy")
    with Host(buoy) as host:
        host.initialize()
        assert host.get("ax", "ay") == [0.0, 0.0]
        host.set(F_x=700.0, F_y=-900.0)
        mass = body.mass + body.added_mass_at_infinity
        assert host.get("ax", "ay") == pytest.approx([700.0 / mass[0], -900.0 / mass[1]], rel=1e-12)
        assert host.get("F_wave_x", "F_wave_y") == [0.0, 0.0]


def test_static_load_and_mass_are_parameters(buoy: Path) -> None:
    body = shipped("buoy")
    with Host(buoy) as host:
        host.initialize(mass=5.0e3, static_load_y=4.0e3, F_y=4.0e3, F_x=0.0)
        assert np.all(run(host, np.arange(5) * 0.2) == 0.0)
        host.set(F_y=4.0e3 + 100.0)
        assert host.get("ay") == pytest.approx([100.0 / (5.0e3 + body.added_mass_at_infinity[1])])


# --- refusals ---


def test_mistakes_of_the_table_are_said_at_once(tmp_path: Path) -> None:
    (tmp_path / "other.nc").write_bytes(b"no coefficients")
    for table, says in {
        ("kind", "floating"): "vessel.body: this key is missing",
        ("body", "boy"): 'vessel.body = "boy": the nearest is "buoy"; allowed: buoy, barge, or a NetCDF file NAME.nc',
        ("body", "other.nc"): 'vessel.body = "other.nc": this is no NetCDF file',
        ("body", "none.nc"): 'vessel.body = "none.nc": there is no such file',
        ("points", (0.0, 1.0)): "places that rise and lie alike on both sides of 0 are expected",
        ("mass", -3.0): "vessel.mass = -3.0: a mass must be greater than 0",
    }.items():
        with pytest.raises(VesselError) as refused:
            Vessel.from_table({"kind": "floating", table[0]: table[1]}, folder=tmp_path)
        assert says in str(refused.value)


def test_points_that_do_not_tell_the_force_are_refused(build: Build) -> None:
    with pytest.raises(VesselError) as refused:
        build(name="boje", kind="excitation", body="buoy", points=[0.0])
    first, second = str(refused.value).splitlines()
    assert first.startswith("boje: with elevations at 0 m the force of waves along x is met to 100.0% only")
    assert "along y is met to" in second and second.endswith("other or more points are needed")


def test_a_body_of_ones_own_is_a_file_beside_the_table(build: Build, tmp_path: Path) -> None:
    path = tmp_path / "mine.nc"
    path.write_bytes(shipped_database("buoy"))
    with Host(build(kind="floating", body=str(path), y_0=0.5)) as host, Host(build(**moored("buoy"))) as other:
        assert host.initialize().get("y") == [0.5] and host.names("input") == other.names("input")
