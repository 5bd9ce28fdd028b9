"""The script that makes databases, run anew: a hemisphere of the literature, and the buoy that ships."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from cablefmu.hydrodynamics import read_database, shipped_database

FOLDER = Path(__file__).parents[2] / "fmu_src" / "hydrodynamics"

HULME = {  # K a: added mass and damping of heave, of surge; by the displaced mass, damping by omega as well
    0.2: (0.7938, 0.2793, 0.5515, 0.0082),
    0.5: (0.5861, 0.3391, 0.6439, 0.0987),
    1.0: (0.4284, 0.2484, 0.5740, 0.3535),
}
"""A. Hulme, The wave forces acting on a floating hemisphere undergoing forced periodic oscillations, Journal of Fluid
Mechanics 121 (1982), tables 1 and 2: multipoles, no panels."""


@pytest.fixture
def compute(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(FOLDER)
    import compute as script

    script.cpt.set_logging("ERROR")
    return script  # type: ignore[no-any-return]


@pytest.mark.slow
def test_a_floating_hemisphere_is_that_of_hulme(compute: ModuleType) -> None:
    """Within 1 % of the largest value of each curve (0.88, 0.34, 0.67, 0.41): what meshes of 12 and 20 rings leave."""
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
    off = np.abs(np.stack([*heave, *surge], axis=-1) - list(HULME.values())) / [0.88, 0.34, 0.67, 0.41]
    assert np.max(off) < 0.01, off
    assert found["added_mass_at_infinity"][0, 0] / displaced == pytest.approx(0.2732, rel=0.01)


@pytest.mark.slow
def test_the_buoy_computed_anew_is_the_one_that_ships(compute: ModuleType) -> None:
    """By coarser meshes: within 1 % of each curve's largest value."""
    body, hull = read_database(shipped_database("buoy")), compute.HULLS["buoy"]
    places = [9, 19, 34]
    coarse, fine = (compute.solved(hull.mesh(n), body.omega[places], hull.lid / n) for n in (6, 12))
    found = compute.extrapolated(coarse, fine, 2.0)
    for axis in range(2):
        for name, held in (("added_mass", body.added_mass), ("radiation_damping", body.damping)):
            off = np.abs(found[name][:, axis, axis] - held[places, axis])
            assert np.max(off) < 0.01 * np.max(held[:, axis]), (name, axis)
        off = np.abs(found["excitation"][:, axis] - body.excitation[places, axis])
        assert np.max(off) < 0.01 * np.max(np.abs(body.excitation[:, axis]))


def test_unknown_names_are_refused(compute: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    assert compute.main(["boat"]) == 2
    assert capsys.readouterr().err == "name one or more of buoy, barge\n"
