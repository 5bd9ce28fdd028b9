"""The picture of the start shape: to scale, inside its frame, small whatever the number of links."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from lxml import etree

from cablefmu.cable import Cable, Floats, Links, Terminal, Top
from cablefmu.fmu.sketch import sketch
from tests.fmu_helpers import KINDS, small_scene


def drawn(cable: Cable) -> etree._Element:
    return etree.fromstring(sketch(cable))


def line(svg: etree._Element) -> Floats:
    (polyline,) = svg.iter("polyline")
    return np.array([[float(value) for value in point.split(",")] for point in str(polyline.get("points")).split()])


def texts(svg: etree._Element) -> list[str]:
    return [str(text.text) for text in svg.iter("text")]


def pixels_per_metre(svg: etree._Element) -> float:
    """By the scale bar."""
    label = texts(svg)[-1]
    (bar,) = (path.get("d") for path in svg.iter("path") if re.search(r"m0 -4h([\d.]+)m0 -4v8$", str(path.get("d"))))
    length = re.search(r"m0 -4h([\d.]+)m", str(bar))
    assert length is not None
    return float(length[1]) / float(label.removesuffix(" m"))


def longer(cable: Cable, n: int) -> Cable:
    """As many links of the same length, winding down."""
    same = {name: np.full(n, getattr(cable.links, name)[0]) for name in Links.__dataclass_fields__}
    angles = 0.5 + 0.4 * np.sin(np.linspace(0.0, 20.0, n))
    before = 0 if cable.top is Top.MOTION else 1
    position = np.concatenate([cable.position[:before], angles, cable.position[before + cable.n :]])
    return replace(cable, links=Links(**same), position=position, velocity=np.zeros(len(position)))


@pytest.mark.parametrize("kind", KINDS)
def test_the_cable_is_to_scale(kind: str) -> None:
    cable = small_scene(kind).cable
    svg = drawn(cable)
    points = line(svg)
    assert len(points) == cable.n + 1
    angles = cable.angles_in(cable.position)
    along = cable.links.length[:, None] * np.column_stack([np.sin(angles), np.cos(angles)])
    # Points are rounded to 0.1 px, the length of the bar as well.
    np.testing.assert_allclose(np.diff(points, axis=0) / pixels_per_metre(svg), along, atol=0.02)


@pytest.mark.parametrize("kind", KINDS)
def test_everything_is_inside_the_frame(kind: str) -> None:
    for cable in (small_scene(kind).cable, longer(small_scene(kind).cable, 300)):
        svg = drawn(cable)
        width, height = (float(value) for value in str(svg.get("viewBox")).split()[2:])
        places = [line(svg), *([[float(t.get("x") or 0), float(t.get("y") or 0)]] for t in svg.iter("text"))]
        for x, y in np.concatenate(places):
            assert 0.0 <= x <= width and 0.0 <= y <= height


def test_ends_are_named() -> None:
    named = {kind: [text for text in texts(drawn(small_scene(kind).cable)) if "m" in text][:-1] for kind in KINDS}
    for kind in KINDS:
        top = "vessel 1" if kind in ("moved", "between") else "floater 1"
        assert top in texts(drawn(small_scene(kind).cable))
    assert named["pin"] == ["pin (12, 13) m"]
    assert named["anchor-mass"] == named["anchor-spring"] == ["anchor (12, 13) m"]
    assert named["floater"] == ["(12, 13) m"]
    assert named["load"] == ["load (9.589, 17.55) m"]
    assert named["moved"] == ["load (9.789, 17.55) m"], "x_1 starts at 0.2 m"
    assert named["between"] == ["(12, 12.9) m"]
    assert "vessel 2" in texts(drawn(small_scene("between").cable))


def test_what_is_zero_but_for_rounding_is_zero() -> None:
    cable = replace(small_scene("floater").cable, position=np.array([0.0, *[np.pi / 2.0] * 5]))
    assert "(20, 0) m" in texts(drawn(cable))


def test_water_is_drawn_where_there_is_some() -> None:
    for kind in KINDS:
        levels = [path.get("class") for path in drawn(small_scene(kind).cable).iter("path")]
        assert ("water" in levels) == (kind != "air")


def test_ten_thousand_links_are_no_long_file() -> None:
    cable = longer(small_scene("load").cable, 10_000)
    assert cable.terminal is Terminal.LOAD
    assert len(sketch(cable)) < 20_000
    points = line(drawn(cable))
    assert np.max(np.abs(np.diff(points, axis=0))) < 1.0  # px: nothing is cut off


def test_a_straight_vertical_cable_has_a_width() -> None:
    svg = drawn(replace(small_scene("load").cable, position=np.zeros(6)))
    assert float(str(svg.get("viewBox")).split()[2]) > 250.0
