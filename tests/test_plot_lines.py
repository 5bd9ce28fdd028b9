"""Which variables are drawn when some are named, or none."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from cablefmu.errors import OptionError
from cablefmu.plot_lines import chosen_lines
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return simulate(small_scene("load"), stop_time=0.3, record=["theta", "nodes", "modes", "u_m1"])


def test_all_outputs_by_their_units(result: xr.Dataset) -> None:
    """What was recorded as a number counts; arrays, modes and the solver's own figures do not."""
    found = {units: [line.name for line in lines] for units, lines in chosen_lines(result).items()}
    assert {units: sorted(names) for units, names in found.items()} == {
        "m": ["x_c", "y_c", "y_m1"],
        "m/s": ["v_m1", "vx_c", "vy_c"],
        "N": ["tension_end", "tension_max", "tension_top", "u_m1"],
        "J": ["energy"],
    }
    for lines in chosen_lines(result).values():
        for line in lines:
            np.testing.assert_array_equal(line.values, result[line.name])
            assert line.is_named and line.color is None


def test_names_elements_and_arrays_in_the_order_they_are_given(result: xr.Dataset) -> None:
    found = chosen_lines(result, ["theta[4]", "node_y[0]", "solver.steps", "x_c", "theta"])
    names = {units: [line.name for line in lines] for units, lines in found.items()}
    assert names == {
        "rad": ["theta[4]", *(f"theta[{i}]" for i in range(1, 6))], "m": ["node_y[0]", "x_c"], "1": ["solver.steps"],
    }  # fmt: skip
    np.testing.assert_array_equal(found["rad"][0].values, result["theta"].sel(link=4))
    np.testing.assert_array_equal(found["m"][0].values, result["y_m1"])
    links = found["rad"][1:]
    assert [line.is_named for line in links] == [True, False, False, False, True]
    brightness = [sum(line.color[:3]) for line in links]
    assert brightness == sorted(brightness) and brightness[0] < brightness[-1]


def test_a_coupled_run_has_its_models_names_in_front() -> None:
    values = {
        name: ("time", [0.0]) for name in ("cable.solver.steps", "cable.x_c", "statics.residual", "solver_room.y")
    }
    (lines,) = chosen_lines(xr.Dataset(values, {"time": [0.0]})).values()
    assert [line.name for line in lines] == ["cable.x_c", "solver_room.y"]


@pytest.mark.parametrize("name", ["X_c", "theta[0]", "theta[6]", "theta[", "frequency", "x_c[1]", "node_x[7]", ""])
def test_names_of_nothing(name: str, result: xr.Dataset) -> None:
    with pytest.raises(OptionError, match="the result has no such variable over time"):
        chosen_lines(result, [name])


def test_the_nearest_name_is_told(result: xr.Dataset) -> None:
    with pytest.raises(OptionError, match="tension_max"):
        chosen_lines(result, ["tension_mx"])


def test_a_result_without_numbers(result: xr.Dataset) -> None:
    with pytest.raises(OptionError, match="there are no numbers over time to draw"):
        chosen_lines(result[["theta"]])
