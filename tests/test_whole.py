"""Which cables can be divided into any number of links, and what they are then."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from cablefmu.errors import SceneError
from cablefmu.scene import Scene, load_scene, shipped_scenes
from cablefmu.whole import divided, whole_of
from tests.fmu_helpers import KINDS, SCENES, small_scene, with_links


def edited(kind: str, *edits: tuple[str, str]) -> Scene:
    text = SCENES[kind]
    for old, new in edits:
        assert text.count(old) == 1
        text = text.replace(old, new)
    return Scene.from_text(text, name="mine")


def test_numbers_of_the_whole_cable() -> None:
    whole = whole_of(small_scene("load"))
    # (5/6) E pi r^4/4 with r = 1 cm
    assert whole.parameters.pop("EI") == pytest.approx(5.0 / 6.0 * 8e10 * np.pi / 4.0 * 1e-8, rel=1e-15)
    assert whole.parameters == {"L": 20.0, "D": 0.02, "rho_cable": 7850.0, "theta_start": 0.5}
    assert (whole.preloads, whole.place) == ((), (0.0, 0.0))


@pytest.mark.parametrize(
    ("kind", "preloads"),
    [
        ("pin", ("static_load",)),
        ("anchor-mass", ("static_load",)),
        ("anchor-spring", ("static_load", "static_load_2", "static_pull_2")),
        ("floater", ("static_load", "static_load_2", "static_pull_2")),
        ("surge", ("static_load", "static_pull")),
        ("between", ()),
    ],
)
def test_what_follows_from_the_rest_shape(kind: str, preloads: tuple[str, ...]) -> None:
    whole = whole_of(small_scene(kind))
    assert (whole.preloads, whole.place) == (preloads, (12.0, 13.0))
    assert "theta_start" not in whole.parameters


def test_hanging_is_straight_down() -> None:
    whole = whole_of(edited("load", ('kind = "straight"\nangle = 0.5', 'kind = "hanging"')))
    assert whole.parameters["theta_start"] == 0.0


@pytest.mark.parametrize("name", shipped_scenes())
def test_every_scene_that_ships_can_be_divided(name: str) -> None:
    length = 180.0 if name == "lift-60" else 120.0 if name.endswith("ed-40") else 240.0
    assert whole_of(load_scene(name)).parameters["L"] == length


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [2, 5, 60])
def test_divided_is_written_with_as_many_links(kind: str, n: int) -> None:
    found, written = divided(small_scene(kind), n, {}).cable, with_links(small_scene(kind), n).cable
    for field in fields(found.links):
        expected = getattr(written.links, field.name)
        np.testing.assert_array_equal(getattr(found.links, field.name), expected)
    assert found.parameters == written.parameters
    np.testing.assert_array_equal(found.position, written.position)


@pytest.mark.parametrize("n", [1, 2, 3, 7, 60, 997, 10_000])
def test_the_weight_of_a_cable_does_not_depend_on_its_links(n: int) -> None:
    """To the bit: with static_load it becomes a parameter of an FMU whose number of links may change."""
    scene = small_scene("load")
    static_load = with_links(scene, n).cable.parameters["static_load"]
    assert static_load == scene.cable.parameters["static_load"]
    links = with_links(scene, n).cable.links
    load = 60.0 - 60.0 / 7850.0 * 1000.0
    assert static_load == pytest.approx((float(np.sum(links.mass - 1000.0 * links.volume)) + load) * 9.81, rel=1e-13)


PER_LINK = "it is per link, and arrays leave the number of links open; {} is expected"
ONE_VALUE = "arrays leave the number of links open; one value for all links is expected"
REFUSED = {
    "cable.link_length = 4.0: " + PER_LINK.format("cable.length"): ("load", ("\nlength = 20", "\nlink_length = 4")),
    "cable.link_mass = 3.0: " + PER_LINK.format("cable.density"): (
        "load", ("density = 7850\nyoung", "link_mass = 3\nyoung"),
    ),
    "water.drag_per_link = 5.0: " + PER_LINK.format("water.Cd"): ("load", ("Cd = 1.0", "drag_per_link = 5")),
    "cable.diameter: " + ONE_VALUE: ("load", ("diameter = 0.02", f"diameter = {[0.02] * 5}")),
    "cable.joint_damping: " + ONE_VALUE: ("load", ("joint_damping = 2.8", f"joint_damping = {[2.8] * 5}")),
    "water.Cd: " + ONE_VALUE: ("load", ("Cd = 1.0", f"Cd = {[1.0] * 5}")),
    'shape.kind = "angles": arrays leave the number of links open, and these angles do not; '
    "allowed: straight, hanging, catenary": (
        "load", ('kind = "straight"\nangle = 0.5', f'kind = "angles"\nangles = {[0.1] * 5}'),
    ),
    'shape.kind = "straight": arrays leave the number of links open, and so where this shape ends; allowed: catenary': (
        "anchor-mass", ("position = [12, 13]", "position = [11.994, 15.992]"),
        ('kind = "catenary"', f'kind = "straight"\nangle = {np.arctan2(12, 16)}'),
    ),
}  # fmt: skip
"""Message -> kind of scene, edits."""


@pytest.mark.parametrize("says", REFUSED)
def test_cables_that_cannot_be_divided_are_refused(says: str) -> None:
    kind, *edits = REFUSED[says]
    with pytest.raises(SceneError) as refused:
        whole_of(edited(str(kind), *edits))  # type: ignore[arg-type]
    assert str(refused.value) == f"mine.toml: {says}"


def test_all_that_is_in_the_way_is_said_at_once() -> None:
    scene = edited("load", ("diameter = 0.02", f"diameter = {[0.02] * 5}"), ("Cd = 1.0", "drag_per_link = 5"))
    with pytest.raises(SceneError) as refused:
        whole_of(scene)
    assert [line.split(":")[1].split()[0] for line in str(refused.value).splitlines()] == [
        "water.drag_per_link", "cable.diameter"
    ]  # fmt: skip


def test_too_few_links_for_a_rest_shape() -> None:
    with pytest.raises(SceneError, match="no rest shape of these links joins the ports") as refused:
        divided(small_scene("pin"), 1, {})
    assert str(refused.value).startswith("pin.toml: terminal.position = [12.0, 13.0]: ")
