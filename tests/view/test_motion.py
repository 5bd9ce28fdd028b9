"""What is drawn of a result: nodes, ends, water, numbers; and which results cannot be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from cablefmu.along import node_positions, picture_needs
from cablefmu.errors import OptionError
from cablefmu.simulate import simulate
from cablefmu.view.motion import extent_of, motion_of, tension_range
from tests.fmu_helpers import small_scene
from tests.view.made import made_motion, made_result


@pytest.mark.parametrize(
    ("kind", "top", "end", "in_water"),
    [
        ("air", "floater", "load", False), ("load", "floater", "load", True), ("pin", "floater", "anchor", True),
        ("anchor-spring", "floater", "anchor", True), ("floater", "floater", "floater", True),
        ("moved", "vessel", "load", True), ("between", "vessel", "vessel", True),
    ],
)  # fmt: skip
def test_ends_and_water_are_those_of_the_scene(kind: str, top: str, end: str, in_water: bool) -> None:
    result = made_result()
    result.attrs["scene"] = small_scene(kind).text
    motion = motion_of(result, "x")
    assert (motion.top, motion.end, motion.in_water) == (top, end, in_water)


def test_a_run_with_angles_shows_its_nodes() -> None:
    scene = small_scene("moved")
    result = simulate(scene, stop_time=0.5, record=picture_needs(scene.cable))
    motion = motion_of(result, "mine")
    x, y = node_positions(result)
    np.testing.assert_array_equal(motion.x, x)
    np.testing.assert_array_equal(motion.y, y)
    np.testing.assert_array_equal(motion.time, result["time"])
    assert motion.tension is None
    assert motion.name == "mine" and motion.description == scene.description
    shown = {value.name: value for value in motion.values}
    assert [*shown] == ["x_1", "y_1", "x_c", "y_c", "tension_top", "tension_end", "tension_max", "energy"]
    np.testing.assert_array_equal(shown["x_c"].values, result["x_c"])
    assert shown["tension_max"].unit == "N" and shown["x_c"].text == result["x_c"].attrs["long_name"]


def test_nodes_that_were_recorded_are_taken_as_they_are() -> None:
    result = made_result()
    motion = motion_of(result, "x")
    np.testing.assert_array_equal(motion.x, result["node_x"])
    np.testing.assert_array_equal(motion.y, result["node_y"])
    np.testing.assert_array_equal(motion.tension, result["tension"])


def test_a_result_without_places_is_refused_with_what_to_do() -> None:
    bare = simulate(small_scene("load"), stop_time=0.2)
    with pytest.raises(OptionError, match=r"mine: .* `cablefmu run SCENE --record nodes tensions`"):
        motion_of(bare, "mine")
    angles = simulate(small_scene("moved"), stop_time=0.2, record=["theta"])
    with pytest.raises(OptionError, match="does not say where the cable is"):
        motion_of(angles, "the vessel's place is missing")
    with pytest.raises(OptionError, match="nothing to show"):
        motion_of(made_result().isel(time=slice(0)), "mine")


def test_a_scene_that_is_none_has_a_floater_and_an_anchor() -> None:
    result = made_result()
    for text in ("", "no TOML [", 'top = "floater"\nterminal = 3'):
        result.attrs["scene"] = text
        motion = motion_of(result, "x")
        assert (motion.top, motion.end, motion.in_water) == ("floater", "anchor", False)


def test_the_extent_holds_every_run_and_the_surface() -> None:
    one, other = made_motion(), made_motion(length=30.0, lag=1.0)
    both = extent_of([one, other])
    assert both.left == min(one.x.min(), other.x.min())
    assert both.right == max(one.x.max(), other.x.max())
    assert both.top == min(one.y.min(), other.y.min()) < 0.0
    assert both.bottom == max(one.y.max(), other.y.max())
    sunk = replace(one, y=one.y + 50.0)
    assert extent_of([sunk]).top == 0.0
    assert extent_of([replace(sunk, in_water=False)]).top == sunk.y.min() > 40.0


def test_colours_tell_all_tensions_apart_but_the_rarest() -> None:
    motion = made_motion(links=50, times=100)
    assert motion.tension is not None
    jerked = replace(motion, tension=motion.tension.copy())
    jerked.tension[10, :9] = 1e6  # 9 of 5000
    low, high = tension_range([jerked]) or (0.0, 0.0)
    assert low == motion.tension.min()
    assert 0.9 * motion.tension.max() < high <= motion.tension.max()
    even = replace(motion, tension=np.full_like(motion.tension, 7.0))
    assert tension_range([even]) == (7.0, 8.0)
    assert tension_range([replace(motion, tension=None)]) is None


def test_why_a_run_ended_early_is_kept() -> None:
    assert motion_of(made_result(ended_early="a force was not a number"), "x").ended_early == "a force was not a number"
    assert made_motion().ended_early == ""


def test_a_dataset_of_another_kind_is_refused() -> None:
    with pytest.raises(OptionError, match="does not say where the cable is"):
        motion_of(xr.Dataset({"a": ("time", [1.0])}, coords={"time": [0.0]}), "x")
