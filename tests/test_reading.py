"""Results come back from either kind of file as they were; what is none of ours is refused in a sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import cablefmu
from cablefmu.errors import ResultError, RunError
from cablefmu.reading import open_result
from cablefmu.results import write_results
from cablefmu.scene import Scene
from cablefmu.simulate import simulate
from tests.fmu_helpers import SCENES, small_scene, with_links

ALL = ("theta", "omega[2]", "nodes", "tensions", "modes", "stiffness")


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("floater"), stop_time=0.5, record=ALL, parameters={"M_2": 510.0})


@pytest.fixture(scope="module")
def coupled() -> xr.Dataset:
    return cablefmu.couple("moored-vessel")


def assert_same(back: xr.Dataset, result: xr.Dataset) -> None:
    """Names, dimensions, every bit, every attribute, and their types."""
    xr.testing.assert_identical(back, result)
    assert list(back.attrs) == list(result.attrs)
    assert {key: type(value) for key, value in back.attrs.items()} == {
        key: type(value) for key, value in result.attrs.items()
    }
    for name, variable in result.variables.items():
        if variable.dtype.kind == "f":
            assert back[name].values.tobytes() == np.ascontiguousarray(variable.values).tobytes()
        assert back[name].dtype.kind == variable.dtype.kind and back[name].dims == variable.dims


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_all_of_it_comes_back(name: str, result: xr.Dataset, tmp_path: Path) -> None:
    write_results(result, tmp_path / name)
    back = open_result(tmp_path / name)
    assert {"node_x", "tension", "theta", "omega[2]", "mode_shape", "mode_heave", "end_stiffness"} <= set(back)
    assert_same(back, result)


def test_from_one_kind_to_the_other_and_back(result: xr.Dataset, tmp_path: Path) -> None:
    """The files are the same to the byte: nothing is lost on the way."""
    write_results(result, tmp_path / "a.csv")
    write_results(open_result(tmp_path / "a.csv"), tmp_path / "a.nc")
    write_results(open_result(tmp_path / "a.nc"), tmp_path / "b.csv")
    write_results(open_result(tmp_path / "b.csv"), tmp_path / "b.nc")
    for suffix in (".csv", ".csv.json", ".modes.csv", ".stiffness.csv", ".nc"):
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_one_link_and_nothing_recorded(name: str, tmp_path: Path) -> None:
    """Without what was set there is nothing to say of it."""
    plain = simulate(with_links(small_scene("load"), 1), stop_time=0.2)
    write_results(plain, tmp_path / name)
    del plain.attrs["set"]
    assert_same(open_result(tmp_path / name), plain)


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_a_coupled_run_comes_back(name: str, coupled: xr.Dataset, tmp_path: Path) -> None:
    """Names with dots, attributes of its own; those that are empty are not there."""
    write_results(coupled, tmp_path / name)
    told = {key: value for key, value in coupled.attrs.items() if value != ""}
    expected = coupled.drop_attrs().assign_attrs(told)
    for key, variable in coupled.variables.items():
        expected[key].attrs = {word: value for word, value in variable.attrs.items() if value != ""}
    back = open_result(tmp_path / name)
    assert "vessel.y" in back
    assert_same(back, expected)


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_a_run_that_ended_early_still_opens(name: str, tmp_path: Path) -> None:
    with pytest.raises(RunError) as ended:
        simulate(small_scene("load"), parameters={"F_cx": 1e300}, record=["nodes"])
    partial = ended.value.partial
    assert isinstance(partial, xr.Dataset)
    write_results(partial, tmp_path / name)
    back = cablefmu.open_result(tmp_path / name)
    assert_same(back, partial)
    assert "too violent" in back.attrs["ended_early"]
    assert back["time"].values.tolist() == [0.0]


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_a_run_without_outputs_has_its_times(name: str, tmp_path: Path) -> None:
    outputs = ["y_m1", "v_m1", "x_c", "y_c", "vx_c", "vy_c", "tension_top", "tension_end", "tension_max", "energy"]
    silent = SCENES["air"] + f"[outputs]\ndrop = {json.dumps(outputs)}\nsolver = false\n"
    run = simulate(Scene.from_text(silent, name="silent"), stop_time=0.2)
    assert not run.data_vars
    write_results(run, tmp_path / name)
    assert open_result(tmp_path / name)["time"].values.tolist() == [0.0, 0.1, 0.2]


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_an_older_run_leaves_no_modes_behind(name: str, result: xr.Dataset, tmp_path: Path) -> None:
    """NAME.modes.csv of a run before stays on disk; it is not part of a result that does not tell of it."""
    write_results(result, tmp_path / name)
    plain = result.drop_dims(["mode", "end_force", "end_displacement"])
    write_results(plain, tmp_path / name)
    assert_same(open_result(tmp_path / name), plain)


# --- files that are none of ours ---


def test_names_and_places() -> None:
    with pytest.raises(ResultError, match=r"x\.txt: a name that ends with \.csv or \.nc is expected"):
        open_result("x.txt")
    for name in ("x.csv", "x.nc"):
        with pytest.raises(ResultError, match=f"{name}: there is no such file"):
            open_result(Path("nowhere") / name)


def test_a_table_without_its_description(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("time,x\n0,1\n")
    with pytest.raises(ResultError, match=r"x\.csv: x\.csv\.json, .* is not beside it; a file from `cablefmu run`"):
        open_result(tmp_path / "x.csv")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"variables": 1, "dimensions": {}, "coordinates": {}}', "\x00"])
def test_descriptions_that_are_none(text: str, tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("time,x\n0,1\n")
    (tmp_path / "x.csv.json").write_text(text)
    with pytest.raises(ResultError, match=r"x\.csv\.json: is not the description of a run's results"):
        open_result(tmp_path / "x.csv")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("time,", "Time,", "its columns are not those that x.csv.json tells of"),
        ("x_c,", "", "its columns are not those that x.csv.json tells of"),
        ("\n0.1,", "\n0.1;", "is damaged or was cut off"),
        ("\n0.2,", "\nnought,", "is damaged or was cut off"),
    ],
)
def test_tables_that_were_changed(old: str, new: str, says: str, result: xr.Dataset, tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    write_results(result, path)
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(ResultError, match=says):
        open_result(path)


def test_descriptions_that_were_changed(result: xr.Dataset, tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    for key in ("time", "x_c"):
        write_results(result, path)
        told = json.loads((tmp_path / "x.csv.json").read_text())
        del told["variables"][key]
        (tmp_path / "x.csv.json").write_text(json.dumps(told))
        with pytest.raises(ResultError, match=r"x\.csv: is damaged, or was changed by hand"):
            open_result(path)
    write_results(result, path)
    (tmp_path / "x.modes.csv").unlink()
    with pytest.raises(ResultError, match=r"x\.csv: frequency is missing; it was written to a file of its own"):
        open_result(path)


@pytest.mark.parametrize("content", [b"", b"CDF", b"not NetCDF at all", b"\x89HDF\r\n\x1a\n" + bytes(99)])
def test_files_that_are_no_netcdf(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "x.nc").write_bytes(content)
    with pytest.raises(ResultError, match=r"x\.nc: .*a file from `cablefmu run` or `cablefmu couple` is expected"):
        open_result(tmp_path / "x.nc")


def test_a_netcdf_file_that_was_cut_off(result: xr.Dataset, tmp_path: Path) -> None:
    write_results(result, tmp_path / "x.nc")
    whole = (tmp_path / "x.nc").read_bytes()
    for length in (40, len(whole) // 2, len(whole) - 8):
        (tmp_path / "x.nc").write_bytes(whole[:length])
        with pytest.raises(ResultError, match=r"x\.nc: "):
            open_result(tmp_path / "x.nc")


def test_netcdf_of_somebody_else(tmp_path: Path) -> None:
    xr.Dataset({"t2m": ("time", [280.0])}, {"time": [0.0]}).to_netcdf(tmp_path / "x.nc", engine="scipy")
    with pytest.raises(ResultError, match=r"x\.nc: holds no results of a run"):
        open_result(tmp_path / "x.nc")
