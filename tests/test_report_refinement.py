"""The same continuous cable in more links: what stays, what it converges to, and how many are enough."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu import report_refinement
from cablefmu.cable import Floats
from cablefmu.errors import RunError
from cablefmu.report_refinement import SHARES, refined, refinement, unevenness
from cablefmu.report_runs import apart, fmu_runs
from cablefmu.scene import Scene, load_scene
from tests.fmu_helpers import KINDS, SCENES, small_scene

SMOOTH = (
    SCENES["air"]
    .replace('kind = "straight"\nangle = 0.5', 'kind = "hanging"')
    .replace("rotary_inertia = 50\n", "")
    .replace("[inputs]\nu_m1", '[inputs]\nF_cx = { signal = "sine", amplitude = 30, frequency = 0.25 }\nu_m1')
)
"""Hanging at rest, and pushed gently: a start without a kink, so that the order is that of the links."""


def quiet(_: str) -> None:
    """Says nothing."""


# --- what stays ---


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("links", [3, 5, 40])
def test_the_continuous_cable_stays(kind: str, links: int) -> None:
    scene = small_scene(kind)
    before, after = scene.cable, refined(scene, links).cable
    for name in ("length", "mass", "volume", "drag_area"):
        assert np.sum(getattr(after.links, name)) == pytest.approx(np.sum(getattr(before.links, name)))
    length = after.links.length[1:]
    # bending stiffness 5/6 E I, and the damping of its rate, behind the joint that fastens the cable
    assert after.links.joint_stiffness[1:] * length == pytest.approx(5 / 6 * 8e10 * np.pi / 4 * 0.01**4)
    assert after.links.joint_damping[1:] * length == pytest.approx(2.8 * 20.0 / 5)
    np.testing.assert_array_equal(after.links.drag, before.links.drag[0])
    assert after.links.joint_stiffness[0] == before.links.joint_stiffness[0]
    assert after.links.joint_damping[0] == before.links.joint_damping[0]


def test_with_its_own_number_of_links_a_scene_is_itself() -> None:
    scene = small_scene("load")
    again = refined(scene, 5).cable
    assert again.parameters == scene.cable.parameters
    np.testing.assert_array_equal(again.links.joint_stiffness, scene.cable.links.joint_stiffness)
    with fmu_runs(refined(scene, 5)) as one, fmu_runs(scene) as other:
        assert apart(one.run(tolerance=1e-6), other.run(tolerance=1e-6), 2.0).position == 0.0


def test_what_is_given_per_link_is_shared_out_and_per_joint_grows() -> None:
    text = (
        SCENES["load"]
        .replace("length = 20", "link_length = 4")
        .replace("density = 7850\nyoung", "link_mass = 10\nyoung")
        .replace("young_modulus = 8e10", "joint_stiffness = [100, 100, 100, 100, 100]")
        .replace("Cd = 1.0", "drag_per_link = 40")
    )
    after = refined(Scene.from_text(text, name="given"), 20).cable.links
    assert after.length == pytest.approx(1.0)
    assert after.mass == pytest.approx(2.5)
    assert after.drag == pytest.approx(10.0)
    assert after.joint_stiffness == pytest.approx([100.0] + [400.0] * 19)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("diameter = 0.02", "diameter = [0.02, 0.02, 0.03, 0.02, 0.02]", "diameter differs from link to link"),
        ("Cd = 1.0", "Cd = [1, 1, 1, 1, 2]", "Cd differs from link to link"),
        (
            'kind = "straight"\nangle = 0.5',
            'kind = "angles"\nangles = [0, 0, 0, 0, 1]',
            "start shape is given link by link",
        ),
    ],
)
def test_a_cable_that_is_not_even_is_not_cut_anew_and_it_is_said_why(old: str, new: str, reason: str) -> None:
    scene = Scene.from_text(SCENES["load"].replace(old, new), name="uneven")
    assert reason in str(unevenness(scene))
    with pytest.raises(RunError, match=reason):
        refined(scene, 10)
    found = refinement(scene, 2.0, 60.0, say=quiet)
    assert (found.steps, found.enough_position) == ((), {})
    assert reason in found.note


# --- convergence ---


def test_links_converge_with_second_order_from_a_smooth_start() -> None:
    """Rigid links are a method of order 2, and the joint at the floater stays a joint."""
    found = refinement(
        Scene.from_text(SMOOTH, name="smooth"), 2.0, 60.0, numbers=(6, 8, 12, 16, 24, 32, 48), say=quiet
    )  # fmt: skip
    assert found.position_order == pytest.approx(2.0, abs=0.25)
    assert [step.links for step in found.steps] == [6, 8, 12, 16, 24]
    assert found.finest[0] < found.steps[-1].position
    assert "extrapolated with order" in found.reference


def test_a_start_that_is_bent_at_the_floater_holds_no_more_energy_with_more_links() -> None:
    """timing-60 starts at 45 degrees from its root. Were that joint EI/l as the others are, its energy would double."""

    def bending(scene: Scene) -> float:
        links, angle = scene.cable.links, scene.cable.position[1:]
        return float(0.5 * np.sum(links.joint_stiffness * np.diff(angle, prepend=0.0) ** 2))

    scene = load_scene("timing-60")
    assert bending(refined(scene, 480)) == bending(refined(scene, 60)) > 0.0


def test_what_is_too_slow_ends_the_list_and_is_said() -> None:
    found = refinement(small_scene("load"), 2.0, 1e-9, numbers=(4, 8, 16), say=quiet)
    assert found.steps == ()
    assert "more than 1e-09 s of CPU time" in found.note


def values_of(order: float, *numbers: int) -> dict[int, Floats]:
    return {n: np.array([5.0 + 3.0 * n**-order]) for n in numbers}


def off(one: Floats, other: Floats) -> float:
    return float(np.abs(one - other)[0])


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0])
def test_an_order_that_shows_is_extrapolated(order: float) -> None:
    found = report_refinement._errors_of(values_of(order, 10, 20, 40, 80), off)
    assert found.errors[10] == pytest.approx(3.0 * 10**-order)
    assert found.finest == pytest.approx(3.0 * 80**-order)
    assert (found.doubt, found.words) == (0.0, f"40 and 80 links extrapolated with order {order:.2f}")


def test_without_an_order_the_finest_stands_in_and_is_doubted() -> None:
    values = {20: np.array([1.0]), 40: np.array([1.1]), 80: np.array([1.3])}
    found = report_refinement._errors_of(values, off)
    assert found.errors[20] == pytest.approx(0.3)
    assert found.doubt == found.finest == pytest.approx(0.2 / (2**0.5 - 1))
    assert "show no order" in found.words


def test_enough_are_the_fewest_from_which_on_all_are_good() -> None:
    errors = [(10, 0.5), (20, 0.0005), (40, 0.005), (80, 0.0009)]
    assert report_refinement._enough(errors) == dict(zip(SHARES, (20, 80, None), strict=True))
