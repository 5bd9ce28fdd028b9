"""State spaces of radiation and excitation against the coefficients that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.fmu.vessel_waves import fitted
from cablefmu.hydrodynamics import (
    SHIPPED,
    Excitation,
    Hydrodynamics,
    Radiation,
    fit_excitation,
    fit_radiation,
    read_database,
    shipped_database,
)

ALL = [(name, axis) for name in SHIPPED for axis in (0, 1)]
ALLOWED = 0.01
"""Half of the 2 % of a curve's largest value that is promised."""


def shipped(name: str) -> Hydrodynamics:
    return read_database(shipped_database(name))


def filters(name: str, axis: int) -> tuple[Radiation, Excitation]:
    """Those that an FMU gets."""
    radiation, excitation = fitted(shipped(name), tuple(shipped(name).points.tolist()))
    return radiation[axis], excitation[axis]


@pytest.mark.parametrize(("name", "axis"), ALL)
def test_memory_of_radiated_waves_has_the_coefficients_real_and_imaginary_part(name: str, axis: int) -> None:
    body = shipped(name)
    memory, fit = body.memory[:, axis], filters(name, axis)[0]
    off = (fit.response(body.omega) - memory) / np.max(np.abs(memory))
    assert np.max(np.abs(off.real)) < ALLOWED and np.max(np.abs(off.imag)) < ALLOWED
    assert np.max(np.abs(off)) == pytest.approx(fit.error, rel=1e-6)


@pytest.mark.parametrize(("name", "axis"), ALL)
def test_memory_is_stable_passive_and_forgets_what_does_not_move(name: str, axis: int) -> None:
    """Over eight decades, far beyond the coefficients."""
    body = shipped(name)
    fit = filters(name, axis)[0]
    size = np.max(np.abs(body.memory[:, axis]))
    assert np.max(np.linalg.eigvals(fit.matrix).real) < 0.0
    wide = np.geomspace(1e-4, 1e4, 2000)
    assert np.min(fit.response(wide).real) > -1e-12 * size
    assert abs(fit.response(np.array([0.0]))[0]) < 1e-12 * size


@pytest.mark.parametrize(("name", "axis"), ALL)
@pytest.mark.parametrize("way", [1, -1])
def test_excitation_has_the_coefficients_whichever_way_waves_travel(name: str, axis: int, way: int) -> None:
    body = shipped(name)
    fit = filters(name, axis)[1]
    assert np.max(np.linalg.eigvals(fit.matrix).real) < 0.0
    arriving = np.exp(-1j * way * body.wavenumber[:, None] * body.points)
    expected = body.excitation[:, axis] * (way if axis == 0 else 1)
    off = fit.response(body.omega, arriving) - expected
    assert np.max(np.abs(off)) < ALLOWED * np.max(np.abs(expected))


@pytest.mark.parametrize("name", SHIPPED)
def test_excitation_of_a_sea_that_rises_as_a_whole_is_buoyancy(name: str) -> None:
    body = shipped(name)
    fit = filters(name, 1)[1]
    lifted = fit.response(np.zeros(1), np.ones((1, len(body.points)), dtype=complex))[0]
    assert lifted == pytest.approx(-body.stiffness[1], rel=1e-3)


def test_the_elevation_at_one_point_is_not_enough() -> None:
    """A filter that looks back only cannot make a force that runs ahead: by how much is measured, not assumed."""
    body = shipped("buoy")
    assert fit_excitation(body, np.zeros(1), 1).error > 0.1
    assert fit_excitation(body, np.zeros(1), 0).error == 1.0


def test_a_memory_of_known_poles_is_found_again() -> None:
    """Two oscillators with dampers: each is passive, and so is their sum."""
    omega = np.arange(1, 80) * 0.1
    s = 1j * omega
    memory = 5.0e3 * s / (s * s + s + 4.0) + 2.0e4 * s / (s * s + 4.0 * s + 9.0)
    assert fit_radiation(omega, memory).error < 0.005


def test_a_body_that_radiates_nothing_has_no_memory() -> None:
    fit = fit_radiation(np.arange(1.0, 5.0), np.zeros(4, dtype=complex))
    assert len(fit.output) == 0 and np.all(fit.response(np.array([1.0])) == 0.0)
