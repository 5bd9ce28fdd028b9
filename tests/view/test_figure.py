"""What Bokeh is told to draw: parts by their names, axes with units and y downward, water where there is some."""

from __future__ import annotations

from typing import Any

import pytest

from cablefmu.errors import OptionError
from cablefmu.view.figure import MARKERS, bokeh_script, figure_json, need_bokeh, palette
from cablefmu.view.motion import Motion, extent_of
from tests.view.made import made_motion


def parts(motions: list[Motion], tensions: tuple[float, float] | None = (100.0, 900.0)) -> list[dict[str, Any]]:
    """All objects of the figure, each with its attributes beside its name."""
    found: list[dict[str, Any]] = []

    def walk(node: object) -> None:
        if isinstance(node, dict):
            if node.get("type") == "object":
                found.append({"kind": node["name"], **node.get("attributes", {})})
            for inner in node.values():
                walk(inner)
        elif isinstance(node, list):
            for inner in node:
                walk(inner)

    walk(figure_json(motions, extent_of(motions), tensions)["doc"])
    return found


def named(found: list[dict[str, Any]]) -> set[str]:
    return {str(part["name"]) for part in found if "name" in part}


def test_every_run_has_its_parts_under_their_names() -> None:
    own = {"plot", "nodes0", "links0", "ends0", "line0", "pulls0"}
    assert named(parts([made_motion()])) == own
    assert named(parts([made_motion(), made_motion(lag=1.0)])) == own | {"nodes1", "links1", "ends1", "line1", "pulls1"}


def test_axes_have_units_and_y_is_downward() -> None:
    found = parts([made_motion()])
    labels = {part["axis_label"] for part in found if "axis_label" in part}
    assert labels == {"x [m], to the right", "y [m], down"}
    extent = extent_of([made_motion()])
    across, down = [part for part in found if part["kind"] == "Range1d"]
    assert (across["start"], across["end"]) == (extent.left, extent.right)
    assert (down["start"], down["end"]) == (extent.bottom, extent.top)


@pytest.mark.parametrize("water", [True, False])
def test_water_has_a_surface_and_air_has_none(water: bool) -> None:
    found = parts([made_motion(water=water)])
    surfaces = [part for part in found if part["kind"] == "Span"]
    assert len(surfaces) == sum(part["kind"] == "BoxAnnotation" for part in found) == int(water)
    assert all(part["location"] == 0.0 and part.get("dimension", "width") == "width" for part in surfaces)


def test_colours_are_of_the_range_that_is_told() -> None:
    (mapper,) = [part for part in parts([made_motion()]) if part["kind"] == "LinearColorMapper"]
    assert (mapper["low"], mapper["high"]) == (100.0, 900.0)
    assert mapper["palette"] == palette()
    assert len(set(palette())) == len(palette()) >= 30


def test_every_kind_of_end_has_its_own_sign() -> None:
    assert len(set(MARKERS.values())) == len(MARKERS) == 4


def test_the_script_is_whole_and_fits_into_a_page() -> None:
    script = bokeh_script()
    assert "Copyright (c) Anaconda" in script, "its licence goes along"
    assert "</script" not in script
    assert 500_000 < len(script.encode()) < 1_500_000


def test_without_bokeh_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(OptionError, match=r"pip install 'cablefmu\[view\]'"):
        need_bokeh()
