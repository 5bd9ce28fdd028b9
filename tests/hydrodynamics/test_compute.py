"""The script that makes databases, run anew: a hemisphere of the literature, and what ships."""

from __future__ import annotations

import io
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xarray as xr

from cablefmu.hydrodynamics import SHIPPED, shipped_database

FOLDER = Path(__file__).parents[2] / "fmu_src" / "hydrodynamics"

HULME = {  # K a: added mass and damping of heave, of surge; by the displaced mass, damping by omega as well
    0.2: (0.7938, 0.2793, 0.5515, 0.0082),
    0.5: (0.5861, 0.3391, 0.6439, 0.0987),
    1.0: (0.4284, 0.2484, 0.5740, 0.3535),
}
"""A. Hulme, The wave forces acting on a floating hemisphere undergoing forced periodic oscillations, Journal of Fluid
Mechanics 121 (1982), tables 1 and 2: multipoles, no panels. Table 1 is comparison/HulmeResult.dat of
github.com/LHEEA/Hulme_Heaving_Sphere as well."""
LARGEST = (0.8764, 0.3410, 0.6682, 0.4060)
"""Of each column of these tables."""
AT_INFINITY = (0.2732, 0.5)
"""Added mass of surge and heave: Storti and D'Elia, Journal of Fluids Engineering 126 (2004); that of a sphere in
endless water for heave."""


@pytest.fixture
def compute(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(FOLDER)
    import compute as script

    script.cpt.set_logging("ERROR")
    return script  # type: ignore[no-any-return]


@pytest.mark.slow
def test_a_floating_hemisphere_is_that_of_hulme(compute: ModuleType) -> None:
    """Within 1 % of the largest value of each column: what meshes of 12 and 20 rings leave."""
    import hulls

    mesh = hulls.hemisphere(1.0)
    omega = np.sqrt(9.81 * np.array(list(HULME)))
    coarse, fine = (compute.solved(mesh(n), omega, 0.6 / n) for n in (12, 20))
    found = compute.extrapolated(coarse, fine, 20 / 12)
    displaced = 1000.0 * 2.0 / 3.0 * np.pi
    heave, surge = (
        (found["added_mass"][:, i, i] / displaced, found["radiation_damping"][:, i, i] / displaced / omega)
        for i in (1, 0)
    )
    off = np.abs(np.stack([*heave, *surge], axis=-1) - list(HULME.values())) / LARGEST
    assert np.max(off) < 0.01, off
    assert np.diag(found["added_mass_at_infinity"]) / displaced == pytest.approx(AT_INFINITY, rel=0.01)


def opened(data: bytes) -> xr.Dataset:
    return xr.open_dataset(io.BytesIO(data), engine="scipy").load()


@pytest.mark.parametrize("name", SHIPPED)
def test_a_file_that_ships_is_what_the_script_writes_of_its_numbers(compute: ModuleType, name: str) -> None:
    """Grid, geometry, units and all attributes; only versions of numpy and xarray may be others."""
    held = opened(shipped_database(name))
    results = {key: held[key].values for key in compute.UNITS}
    results["excitation"] = results["excitation"] @ [1.0, 1j]
    made = compute.dataset(name, compute.HULLS[name], results, float(held.attrs["mesh_error"]))
    written = opened(bytes(made.to_netcdf(engine="scipy")))
    ours, theirs = (each.attrs.pop("source").split(",")[0] for each in (held, written))
    assert ours == theirs
    xr.testing.assert_identical(written, held)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_one_frequency_computed_anew_is_what_ships(compute: ModuleType, name: str) -> None:
    """By the two coarser of its three meshes: within the error that is stored, which is of what the finest changes."""
    held, hull = opened(shipped_database(name)), compute.HULLS[name]
    place = len(hull.omega) // 2
    n = hull.fineness[:2]
    coarse, fine = (compute.solved(hull.mesh(k), hull.omega[[place]], hull.lid and hull.lid / k) for k in n)
    found = compute.extrapolated(coarse, fine, n[1] / n[0])
    allowed = 1.001 * held.attrs["mesh_error"]
    for i in range(2):
        pairs = {key: (found[key][0, i, i], held[key].values[:, i, i]) for key in ("added_mass", "radiation_damping")}
        pairs["excitation"] = (found["excitation"][0, i], held["excitation"].values[:, i] @ [1.0, 1j])
        for key, (anew, stored) in pairs.items():
            assert abs(anew - stored[place]) < allowed * np.max(np.abs(stored)), (key, i)
        beyond = held["added_mass_at_infinity"].values[i, i]
        assert found["added_mass_at_infinity"][i, i] == pytest.approx(beyond, rel=allowed), i


def test_unknown_names_are_refused(compute: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    assert compute.main(["boat"]) == 2
    assert capsys.readouterr().err == "name one or more of buoy, barge\n"
