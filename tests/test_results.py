"""Results on disk are the results in memory, to the last bit."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from cablefmu.errors import OptionError
from cablefmu.fmu.table import table
from cablefmu.results import ORDER, write_results
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=0.5, record=["theta", "omega[2]"], parameters={"m_c": 61.5})


def read(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(newline="") as file:
        head, *rows = csv.reader(file)
    return head, np.array([[float(cell) for cell in row] for row in rows])


def test_csv_holds_every_bit(result: xr.Dataset, tmp_path: Path) -> None:
    write_results(result, tmp_path / "x.csv")
    head, rows = read(tmp_path / "x.csv")
    outputs = ["x_c", "y_c", "vx_c", "vy_c", "tension_top", "tension_end", "tension_max", "energy"]
    links = [f"theta[{i}]" for i in range(1, 6)]
    assert head[:3] == ["time", "y_m1", "v_m1"]
    assert set(head) == {"time", "y_m1", "v_m1", *outputs, *table().solver, *links, "omega[2]"}
    for name, column in zip(head, rows.T, strict=True):
        expected = result["theta"].sel(link=int(name[6])) if name.startswith("theta") else result[name]
        np.testing.assert_array_equal(column, expected)


def test_numbers_have_a_point_and_lines_end_plainly(result: xr.Dataset, tmp_path: Path) -> None:
    write_results(result, tmp_path / "x.csv")
    content = (tmp_path / "x.csv").read_bytes()
    assert b"\r" not in content
    assert content.count(b"\n") == 1 + 6
    assert content.splitlines()[1].startswith(b"0.0,0.0,0.0,")


def test_metadata_tell_how_it_was_made(result: xr.Dataset, tmp_path: Path) -> None:
    write_results(result, tmp_path / "x.csv")
    told = json.loads((tmp_path / "x.csv.json").read_text())
    assert told["title"] == "load"
    assert told["scene"] == small_scene("load").text
    assert (told["fmi"], told["interface"], told["step"], told["stop_time"]) == (2, "cs", 0.1, 0.5)
    assert (told["tolerance"], told["set"]) == (1e-6, "m_c=61.5")
    assert told["solver_steps"] == result["solver.steps"].values[-1]
    assert "cablefmu" in told["source"]
    assert told["variables"]["tension_top"]["units"] == "N"
    assert told["variables"]["theta"]["units"] == "rad"
    assert told["variables"]["time"]["units"] == "s"


def test_netcdf_comes_back(result: xr.Dataset, tmp_path: Path) -> None:
    write_results(result, tmp_path / "x.nc")
    with xr.open_dataset(tmp_path / "x.nc", engine="scipy") as back:  # its defaults must not take seconds for dates
        numbers = {name: v.drop_attrs() for name, v in result.data_vars.items()}
        xr.testing.assert_identical(
            xr.Dataset({name: back[name].drop_attrs() for name in numbers}), xr.Dataset(numbers)
        )
        assert back["theta"].dims == ("time", "link")
        assert back["link_length"].values.tolist() == [4.0] * 5
        assert {key: value for key, value in back.attrs.items() if key != ORDER} == result.attrs


def test_another_library_reads_it(result: xr.Dataset, tmp_path: Path) -> None:
    """netCDF4, as MATLAB does, reads through the C library: kinds of numbers, dimensions, texts and units."""
    write_results(result, tmp_path / "x.nc")
    with netCDF4.Dataset(tmp_path / "x.nc") as file:
        assert file.data_model == "NETCDF3_64BIT_OFFSET"
        assert {name: len(d) for name, d in file.dimensions.items()} == {"time": 6, "link": 5}
        assert set(file.variables) == {*map(str, result.variables)}
        for name, variable in file.variables.items():
            assert variable.dtype == (np.int32 if name == "link" else np.float64)
            assert variable.dimensions == result[name].dims
            assert "_FillValue" not in variable.ncattrs()
            values = np.ma.getdata(variable[:])
            np.testing.assert_array_equal(values, result[name].values)
            assert variable.long_name == result[name].attrs["long_name"]
        assert (file["tension_top"].units, file["theta"].units, file["time"].units) == ("N", "rad", "s")
        assert file["theta"].coordinates == "link_length"
        told = {key: file.getncattr(key) for key in file.ncattrs()}
    assert told["scene"] == small_scene("load").text
    assert {key: told[key] for key in ("fmi", "interface", "step", "set")} == {
        "fmi": 2, "interface": "cs", "step": 0.1, "set": "m_c=61.5",
    }  # fmt: skip
    assert told.keys() == {*result.attrs, ORDER}


def test_netcdf_of_a_run_with_nothing_set(tmp_path: Path) -> None:
    plain = simulate(small_scene("load"), stop_time=0.1)
    write_results(plain, tmp_path / "x.nc")
    with xr.open_dataset(tmp_path / "x.nc", engine="scipy", decode_times=False) as back:
        np.testing.assert_array_equal(back["energy"], plain["energy"])


@pytest.mark.parametrize("name", ["x", "x.txt", "x.csv.gz", "x.CSV"])
def test_other_suffixes_are_refused(name: str, result: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"a name that ends with .csv or .nc is expected"):
        write_results(result, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["x.csv", "x.nc"])
def test_a_failure_leaves_the_old_results(
    name: str, result: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / name).write_text("old")
    monkeypatch.setattr("cablefmu.results._write_csv", full)
    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    with pytest.raises(OptionError, match=r"cannot be written \(No space left on device\)"):
        write_results(result, tmp_path / name)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [(name, "old")]
