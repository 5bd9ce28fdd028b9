"""The stress grid is data, and has what it claims: counts, ranges, kinds, all read from its scenes."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from cablefmu.cable import Floats, Initial, SolverChoice, Terminal
from cablefmu.errors import SceneError
from cablefmu.report_runs import is_measured
from cablefmu.scene import Scene, load_scene, shipped_scenes
from cablefmu.signals import Constant, Sine, Steps
from cablefmu.stress_grid import Case, grid, grid_from
from tests.random_cables import TERMINALS


@cache
def scenes() -> dict[str, tuple[Case, Scene]]:
    """Every case whose scene can be made; the others end in an error before they run."""
    made = {}
    for case in grid():
        try:
            made[case.name] = case, case.scene()
        except SceneError:
            assert case.fails, f"{case.name} is no scene, and the grid gives no reason"
    return made


def extremes(value: Callable[[Scene], Floats | float | None]) -> tuple[float, float]:
    """Least and largest over all scenes that have the value."""
    found = [np.atleast_1d(v) for _, scene in scenes().values() if (v := value(scene)) is not None]
    flat = np.concatenate(found)
    return float(np.min(flat)), float(np.max(flat))


def parameter(*names: str) -> Callable[[Scene], Floats | None]:
    def value(scene: Scene) -> Floats | None:
        found = [scene.cable.parameters[name] for name in names if name in scene.cable.parameters]
        return np.array(found) if found else None

    return value


def drag_factor(scene: Scene) -> Floats | None:
    """How many times the drag of a cable with Cd = 1."""
    return scene.cable.links.drag if scene.cable.in_water and np.any(scene.cable.links.drag_area) else None


@pytest.mark.parametrize(
    ("value", "least", "largest"),
    [
        pytest.param(lambda s: s.cable.n, 1, 10_000, id="number of links"),
        # EI = (6/5) k l; the grid writes k with eight digits
        pytest.param(lambda s: 1.2 * s.cable.links.joint_stiffness * s.cable.links.length, 0, 0.99999999e9, id="EI"),
        pytest.param(lambda s: s.cable.links.joint_damping, 0, 1e6, id="c_i"),
        pytest.param(parameter("m_c"), 1e-6, 1e12, id="m_c"),
        pytest.param(parameter("M_1", "M_2"), 1, 1e9, id="M"),
        pytest.param(parameter("k_m2H", "k_m2V"), 0, 1e10, id="k_m2"),
        pytest.param(parameter("c_m2H", "c_m2V"), 0, 1e8, id="c_m2"),
        pytest.param(parameter("k_cH", "k_cV"), 1e3, 1e10, id="springs of an anchor"),
        pytest.param(lambda s: s.step, 1e-6, 10, id="communication step"),
        pytest.param(lambda s: s.tolerance, 1e-11, 1e-2, id="tolerance"),
        pytest.param(drag_factor, 0, 1e6, id="drag"),
        pytest.param(lambda s: np.ptp(np.log10(s.cable.links.length)), 0, 4, id="decades of link lengths in one cable"),
    ],
)
def test_the_grid_reaches_from_one_extreme_to_the_other(
    value: Callable[[Scene], Floats | float | None], least: float, largest: float
) -> None:
    low, high = extremes(value)
    assert low <= least * (1.0 + 1e-12) and high >= largest * (1.0 - 1e-12)


def test_there_are_at_least_150_cases_of_different_names_that_run() -> None:
    names = [case.name for case in grid()]
    assert len(set(names)) == len(names)
    assert len(scenes()) >= 150


def test_at_most_five_per_cent_may_end_in_an_error_and_no_shipped_scene() -> None:
    failing = [case for case in grid() if case.fails]
    assert 0 < len(failing) <= 0.05 * len(grid())
    assert all(case.group != "shipped" for case in failing)


def test_every_shipped_scene_is_in_it_as_it_ships() -> None:
    """But for ends whose errors are not measured."""
    shipped = [case for case in grid() if case.group == "shipped"]
    assert sorted(case.base for case in shipped) == sorted(
        name for name in shipped_scenes() if is_measured(load_scene(name))
    )
    for case in shipped:
        scene, original = case.scene(), load_scene(case.base)
        np.testing.assert_array_equal(scene.cable.position, original.cable.position)
        for column in ("length", "mass", "joint_stiffness", "drag"):
            np.testing.assert_array_equal(getattr(scene.cable.links, column), getattr(original.cable.links, column))
        assert (scene.cable.parameters, scene.signals, scene.stop_time, scene.step, scene.tolerance) == (
            original.cable.parameters, original.signals, original.stop_time, original.step, original.tolerance,
        )  # fmt: skip


def test_every_terminal_every_start_and_both_versions_are_in_it() -> None:
    cases, made = zip(*scenes().values(), strict=True)
    assert {(scene.cable.terminal, scene.cable.initial) for scene in made} == {
        (terminal, initial) for terminal in TERMINALS for initial in Initial
    }
    assert {case.fmi for case in cases} == {2, 3}
    assert min(sum(case.fmi == version for case in cases) for version in (2, 3)) >= 40
    assert {scene.cable.solver for scene in made} == {SolverChoice.AUTOMATIC}


def test_shapes_are_hanging_taut_slack_upside_down_coiled_and_straight() -> None:
    def first(name: str) -> float:
        return float(np.degrees(scenes()[name][1].cable.position[1]))

    assert first("shape-straight-90") == pytest.approx(90.0)
    assert first("shape-straight-179-99") == pytest.approx(179.99)
    assert first("shape-upside-down") == pytest.approx(180.0)
    assert np.ptp(scenes()["shape-coiled"][1].cable.position[1:]) > 6.0, "nearly a whole turn"
    spans = {
        name: float(np.hypot(*scene.cable.rest_position) / np.sum(scene.cable.links.length))
        for name, (_, scene) in scenes().items()
        if scene.cable.terminal is Terminal.PIN
    }
    assert max(spans.values()) > 0.99999 and min(spans.values()) < 0.05
    assert any(not np.any(scene.cable.position) for _, scene in scenes().values()), "hanging"


def test_forces_are_constant_steps_and_fast_sines_of_ten_million_newtons() -> None:
    signals = [signal for _, scene in scenes().values() for signal in scene.signals.values()]
    assert max(abs(s(0.0)) for s in signals if isinstance(s, Constant)) == 1e7
    assert max(abs(value) for s in signals if isinstance(s, Steps) for value in s.values) == 1e7
    fast = [s for s in signals if isinstance(s, Sine) and s.frequency == 50.0]
    assert max(s.amplitude for s in fast) == 1e7


def test_some_water_is_denser_than_the_cable() -> None:
    lighter = [
        scene
        for _, scene in scenes().values()
        if scene.cable.in_water
        and np.all(scene.cable.links.mass < scene.cable.parameters["rho_w"] * scene.cable.links.volume)
    ]
    assert {scene.cable.terminal for scene in lighter} >= {Terminal.LOAD, Terminal.PIN, Terminal.FLOATER}


# --- how a case is written ---


def one(text: str) -> Case:
    (case,) = grid_from(f'[[group]]\nname = "g"\nbase = "free-12-water"\n{text}')
    return case


def test_a_case_is_its_base_with_the_changes_of_group_and_case() -> None:
    case = one('common = { cable.links = 6, run.stop_time = "2 s" }\n[group.cases]\na = { cable.links = 3, fmi = 3 }')
    assert (case.name, case.group, case.base, case.fmi) == ("g-a", "g", "free-12-water", 3)
    assert case.changed == 'cable.links = 3, run.stop_time = "2 s"'
    base, scene = tomllib.loads(load_scene("free-12-water").text), tomllib.loads(case.text)
    base["cable"]["links"], base["run"]["stop_time"], base["description"] = 3, "2 s", scene["description"]
    del base["run"]["frame_interval"]
    assert scene == base


def test_a_table_of_another_kind_and_excluding_keys_replace_what_was_there() -> None:
    case = one(
        "[group.cases]\na = { cable.joint_stiffness = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], water.drag_per_link = 5,"
        ' terminal = { kind = "pin", position = [100, 100] }, shape = { kind = "catenary" } }'
    )
    scene = tomllib.loads(case.text)
    assert "young_modulus" not in scene["cable"] and "Cd" not in scene["water"]
    assert scene["terminal"] == {"kind": "pin", "position": [100, 100]}
    assert "cable.joint_stiffness = [1, ..., 12]" in case.changed
    assert case.scene().cable.terminal is Terminal.PIN
