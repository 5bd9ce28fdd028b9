"""Modes and end stiffness among the results of a run: in the Dataset, on disk, with what was set and what fails."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablefmu.cable import Terminal
from cablefmu.errors import OptionError, RunError
from cablefmu.results import write_results
from cablefmu.simulate import simulate
from cablefmu.statics import ENDS, end_stiffness, equilibrium, modes
from cablefmu.statics_results import statics_dataset
from tests.fmu_helpers import small_scene
from tests.kernel.resting import cable_of
from tests.random_cables import KINDS

BOTH = ("modes", "stiffness")


def test_a_run_holds_them_beside_what_is_over_time() -> None:
    scene = small_scene("floater")
    result = simulate(scene, stop_time=0.2, record=["theta", *BOTH])
    found = modes(scene)
    np.testing.assert_array_equal(result["frequency"], found.frequency)
    np.testing.assert_array_equal(result["mode_heave"], found.shapes[:, 0])
    np.testing.assert_array_equal(result["mode_shape"], found.shapes[:, 1:])
    np.testing.assert_array_equal(result["end_stiffness"], end_stiffness(scene))
    assert result["mode_shape"].dims == ("mode", "link")
    assert result["theta"].dims == ("time", "link")
    assert result["end_force"].values.tolist() == list(ENDS)
    units = {name: result[name].attrs["units"] for name in ("frequency", "mode_heave", "mode_shape", "end_stiffness")}
    assert units == {"frequency": "Hz", "mode_heave": "m", "mode_shape": "rad", "end_stiffness": "N/m"}
    plain = simulate(scene, stop_time=0.2, record=["theta"])
    for name in plain.data_vars:
        if not str(name).startswith("solver."):
            np.testing.assert_array_equal(result[name], plain[name])


def test_only_what_is_asked_for() -> None:
    assert not statics_dataset(small_scene("load"), {}, []).variables
    assert set(statics_dataset(small_scene("load"), {}, ["modes"]).data_vars) == {
        "frequency", "mode_heave", "mode_shape",
    }  # fmt: skip


def test_they_are_about_what_was_set() -> None:
    """Inputs, parameters and where the search begins; what is no number has no part in it."""
    scene = small_scene("load")
    given = {"F_cx": 300.0, "m_c": 90.0, "theta[2]": 0.3, "omega[1]": 1.0, "solver": "implicit"}
    result = statics_dataset(scene, given, BOTH)
    rest = equilibrium(scene, {"F_cx": 300.0}, {"m_c": 90.0})
    np.testing.assert_allclose(result["frequency"], modes(rest).frequency, rtol=1e-8)
    np.testing.assert_allclose(result["end_stiffness"], end_stiffness(rest), rtol=1e-6)


def test_csv_has_tables_of_their_own(tmp_path: Path) -> None:
    result = simulate(small_scene("anchor-spring"), stop_time=0.2, record=BOTH)
    written = write_results(result, tmp_path / "x.csv")
    assert written == [tmp_path / name for name in ("x.csv", "x.modes.csv", "x.stiffness.csv")]
    over_time = (tmp_path / "x.csv").read_text().splitlines()[0].split(",")
    assert not {"frequency", "mode_heave", "end_stiffness"} & set(over_time)
    with (tmp_path / "x.modes.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["mode", "frequency", "y_m1", *(f"theta[{i}]" for i in range(1, 6))]
    numbers = np.array([[float(cell) for cell in row] for row in rows])
    np.testing.assert_array_equal(numbers[:, 1], result["frequency"])
    np.testing.assert_array_equal(numbers[:, 3:], result["mode_shape"])
    with (tmp_path / "x.stiffness.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["force", *ENDS] and [row[0] for row in rows] == list(ENDS)
    np.testing.assert_array_equal([[float(cell) for cell in row[1:]] for row in rows], result["end_stiffness"])


def test_netcdf_holds_all_of_it(tmp_path: Path) -> None:
    result = simulate(small_scene("floater"), stop_time=0.2, record=BOTH)
    assert write_results(result, tmp_path / "x.nc") == [tmp_path / "x.nc"]
    with xr.open_dataset(tmp_path / "x.nc", engine="scipy", decode_times=False) as read:
        for name in ("frequency", "mode_shape", "end_stiffness"):
            np.testing.assert_array_equal(read[name], result[name])
        assert read["end_displacement"].values.tolist() == list(ENDS)


def test_a_link_that_two_points_hold_has_no_modes() -> None:
    """One link on a pin cannot move at all: no modes, and no end stiffness."""
    cable = cable_of(next(k for k, (terminal, *_) in enumerate(KINDS) if terminal is Terminal.PIN), 1)
    found = modes(cable)
    assert found.pulsation.shape == (0,) and found.shapes.shape == (0, 2)
    with pytest.raises(RunError, match="its links do not stretch"):
        end_stiffness(cable)


def test_where_there_is_no_equilibrium_the_run_does_not_begin() -> None:
    with pytest.raises(RunError, match="no stable equilibrium was found near the start shape"):
        simulate(small_scene("load"), stop_time=0.2, record=["modes"], parameters={"k_m1": 0.0, "u_m1": 5.0})


def test_a_run_that_ends_early_keeps_them() -> None:
    """1e160 rad/s at the start are beyond any solver; the equilibrium knows nothing of rates."""
    with pytest.raises(RunError) as caught:
        simulate(small_scene("load"), stop_time=0.2, record=["modes"], parameters={"omega[1]": 1e100})
    assert isinstance(caught.value.partial, xr.Dataset)
    assert "frequency" in caught.value.partial


def test_a_name_that_is_nearly_one_is_told() -> None:
    with pytest.raises(OptionError, match=r"record stifness: there is no such variable; did you mean stiffness\?"):
        simulate(small_scene("load"), stop_time=0.2, record=["stifness"])
