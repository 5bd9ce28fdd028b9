"""Coefficients that ship, against theory that shares nothing with their program; files that are refused."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from cablefmu.hydrodynamics import SHIPPED, Hydrodynamics, read_database, shipped_database
from cablefmu.hydrodynamics.database import DatabaseError
from tests.hydrodynamics.cylinder import added_mass_and_damping

RADIUS, DRAFT = 1.2, 6.0 / (np.pi * 1.2**2)


def opened(name: str) -> xr.Dataset:
    return xr.open_dataset(io.BytesIO(shipped_database(name)), engine="scipy").load()


def shipped(name: str) -> Hydrodynamics:
    return read_database(shipped_database(name))


@pytest.mark.parametrize("name", SHIPPED)
def test_a_database_says_what_it_is_of_and_how_good_it_is(name: str) -> None:
    held = opened(name)
    assert "Capytaine 3.0.0" in held.attrs["source"]
    assert held.attrs["irregular_frequencies"] == {"buoy": "removed by a lid", "barge": "above the band"}[name]
    assert 0.0 < held.attrs["mesh_error"] < 0.02
    assert len(shipped_database(name)) < 100_000
    body = shipped(name)
    assert body.mass == pytest.approx(1000.0 * float(held["volume"]), rel=1e-12)
    assert body.stiffness == pytest.approx([0.0, 9810.0 * float(held["waterplane"])], rel=1e-12)


@pytest.mark.parametrize("omega", [2.0, 2.5, 3.0, 4.0])
@pytest.mark.parametrize(("axis", "mode"), [(0, "surge"), (1, "heave")])
def test_the_buoy_is_the_cylinder_of_matched_eigenfunctions(axis: int, mode: str, omega: float) -> None:
    """Within 0.6 % of each curve's largest value: 0.5 % of the meshes, 0.1 % of the series.

    A depth of 15 m is deep from 2 rad/s on.
    """
    body = shipped("buoy")
    k = int(np.argmin(np.abs(body.omega - omega)))
    mass, damping = added_mass_and_damping(mode, omega, radius=RADIUS, draft=DRAFT, depth=15.0)
    assert abs(body.added_mass[k, axis] - mass) < 0.006 * np.max(body.added_mass[:, axis])
    assert abs(body.damping[k, axis] - damping) < 0.006 * np.max(body.damping[:, axis])


@pytest.mark.parametrize("axis", [0, 1])
def test_haskind_ties_the_buoys_damping_to_its_excitation(axis: int) -> None:
    """Damping is of a body that moves, excitation of one that is held: B = k |X|^2/(8 rho g c_g), for heave twice that.

    Newman, Marine Hydrodynamics (1977), section 6.17, for bodies of revolution; c_g = g/(2 omega) in deep water. Within
    1.5 % of the largest damping: panels are less than a twentieth of a wave up to 4 rad/s, where it is 0.5 %.
    """
    body = shipped("buoy")
    group = body.gravity / (2.0 * body.omega)
    implied = body.wavenumber * np.abs(body.excitation[:, axis]) ** 2 / (8.0 * 1000.0 * body.gravity * group)
    off = np.abs((1 + axis) * implied - body.damping[:, axis]) / np.max(body.damping[:, axis])
    assert np.max(off) < 0.015 and np.max(off[body.omega < 4.05]) < 0.005


@pytest.mark.parametrize("name", SHIPPED)
def test_long_waves_lift_a_body_by_buoyancy_and_push_it_along(name: str) -> None:
    """Heave: rho g A_w up, less 2 k T or so. Surge: displaced mass and added mass times the water's acceleration."""
    body = shipped(name)
    omega = body.omega[0]
    assert body.excitation[0, 1] == pytest.approx(-body.stiffness[1], rel=0.01)
    pushed = 1j * omega**2 * (body.mass + body.added_mass[0, 0])
    assert abs(body.excitation[0, 0] - pushed) < 0.01 * abs(pushed)


def test_the_barges_band_ends_below_the_first_irregular_frequency() -> None:
    """Of the water inside a box, 16 by 10 by 2 m, still at its walls: omega^2 = g k coth(k T)."""
    k = np.pi * np.hypot(1.0 / 16.0, 1.0 / 10.0)
    assert shipped("barge").omega[-1] < np.sqrt(9.81 * k / np.tanh(2.0 * k))


def test_kramers_and_kronig_tie_the_buoys_added_mass_to_its_damping() -> None:
    """A(w) - A_inf = (2/pi) int B(s)/(s^2 - w^2) ds: at w = 0 it is an integral without a pole, and B falls fast."""
    body = shipped("buoy")
    heave, beyond = body.damping[:, 1], body.added_mass_at_infinity[1]
    integral = 2.0 / np.pi * np.trapezoid(heave / body.omega**2, body.omega)
    assert integral == pytest.approx(body.added_mass[0, 1] - beyond, rel=0.03)  # from 0.1 rad/s on, not from 0


def without(name: str) -> Callable[[xr.Dataset], xr.Dataset]:
    return lambda held: held.drop_vars(name)


def changed(name: str, value: Callable[[np.ndarray], np.ndarray]) -> Callable[[xr.Dataset], xr.Dataset]:
    return lambda held: held.assign({name: (held[name].dims, value(held[name].values.copy()))})


def put(values: np.ndarray, place: tuple[int, ...], number: float) -> np.ndarray:
    values[place] = number
    return values


MISTAKES: dict[str, tuple[Callable[[xr.Dataset], xr.Dataset], str]] = {
    "missing": (without("excitation"), "the variable excitation is missing"),
    "shape": (
        lambda held: held.assign(mass=("omega", np.ones(held.sizes["omega"]))),
        r"mass over \('omega',\): \(\) is expected",
    ),
    "NaN": (changed("added_mass", lambda a: put(a, (3, 0, 0), np.nan)), "added_mass: finite numbers are expected"),
    "falling": (lambda held: held.isel(omega=slice(None, None, -1)), "omega: at least 10 frequencies above 0 that"),
    "few": (lambda held: held.isel(omega=slice(5)), "omega: at least 10 frequencies"),
    "waves give": (changed("radiation_damping", lambda b: -b), "radiation_damping: numbers of 0 or more are expected"),
    "coupled": (
        changed("added_mass", lambda a: put(a, (3, 0, 1), 500.0)), "added_mass: surge and heave are coupled"
    ),
    "no mass": (changed("mass", lambda m: 0.0 * m), "mass: what moves must weigh more than 0"),
    "shallow": (lambda held: held.assign_attrs(water_depth=30.0), "water_depth = 30 m: deep water is expected"),
    "no depth": (lambda held: held.assign_attrs(water_depth="deep"), "the attribute water_depth is missing, or no"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_file_that_is_not_in_order_is_refused(mistake: str) -> None:
    change, says = MISTAKES[mistake]
    with pytest.raises(DatabaseError, match=says):
        read_database(bytes(change(opened("buoy")).to_netcdf(engine="scipy")))


def test_what_is_no_netcdf_is_refused() -> None:
    with pytest.raises(DatabaseError, match="this is no NetCDF file"):
        read_database(b"time,x,y\n")
