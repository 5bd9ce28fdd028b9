"""Scenes by name, by path and from memory; what ships."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from cablefmu.cable import Initial, SolverChoice, Terminal
from cablefmu.errors import SceneError
from cablefmu.fmu.table import table
from cablefmu.scene import Scene, load_scene, shipped_scenes
from cablefmu.scene_schema import STATICS

# n, stop time [s] and frames [s] as the dissertation has them (section 6); None where it shows no frames.
# Ours are seabed-pin-60, which is seabed-mass-60 with an ideal anchor, and those with ends that it does not have:
# lift-60, lifted-40, moored-40, towed-40.
EXPECTED = {
    "angles-12-water": (12, 62.0, None),
    "floaters-both-80": (80, 15.5, 0.5),
    "floaters-loose-80": (80, 15.5, 0.5),
    "floaters-restrained-80": (80, 15.5, 0.5),
    "free-12-air": (12, 31.0, 1.0),
    "free-12-water": (12, 31.0, 1.0),
    "free-60-air": (60, 31.0, 1.0),
    "free-60-water": (60, 31.0, 1.0),
    "heave-60-air": (60, 31.0, 1.0),
    "heave-60-water": (60, 31.0, 1.0),
    "lift-60": (60, 31.0, 1.0),
    "lifted-40": (40, 15.5, 0.5),
    "load-diagonal-80": (80, 15.5, 0.5),
    "load-horizontal-80": (80, 15.5, 0.5),
    "load-lift-80": (80, 31.0, 1.0),
    "moored-40": (40, 31.0, 1.0),
    "seabed-mass-60": (60, 15.5, 0.5),
    "seabed-mass-110": (110, 15.5, 0.5),
    "seabed-pin-60": (60, 15.5, 0.5),
    "seabed-spring-60": (60, 15.5, 0.5),
    **{f"timing-{n}": (n, 10.0, None) for n in (20, 40, 60, 80, 100, 120)},
    "towed-40": (40, 31.0, 1.0),
}


def test_the_scenes_of_the_dissertation_ship_in_a_sensible_order() -> None:
    assert shipped_scenes() == list(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_a_shipped_scene_is_what_the_dissertation_describes(name: str) -> None:
    scene = load_scene(name)
    n, stop, frames = EXPECTED[name]
    assert (scene.name, scene.cable.name) == (name, name)
    assert (scene.cable.n, scene.stop_time, scene.step, scene.tolerance) == (n, stop, 0.1, 1e-6)
    assert frames is None or scene.frame_interval == frames
    assert scene.cable.in_water is not name.endswith("-air")
    assert scene.text.startswith("# ")
    assert "What to see:" in scene.text
    assert "# Assumed" in scene.text
    assert set(scene.signals) == set(scene.cable.inputs)


@pytest.mark.parametrize("medium", ["12", "60"])
def test_air_and_water_twins_start_from_the_same_shape(medium: str) -> None:
    air, water = load_scene(f"free-{medium}-air").cable, load_scene(f"free-{medium}-water").cable
    assert air.position.tolist() == water.position.tolist()


@pytest.mark.parametrize(
    ("name", "key", "amplitude"),
    [
        ("heave-60-air", "u_m1", 25000.0),
        ("heave-60-water", "u_m1", 25000.0),
        ("seabed-mass-60", "u_m1", 25000.0),
        ("seabed-pin-60", "u_m1", 25000.0),
        ("floaters-restrained-80", "u_m1", 25000.0),
        ("floaters-loose-80", "u_m1", 15000.0),
        ("floaters-both-80", "u_m1", 2500.0),
        ("floaters-both-80", "u_m2", 2500.0),
    ],
)
def test_floaters_are_heaved_with_a_period_of_four_seconds(name: str, key: str, amplitude: float) -> None:
    signal = load_scene(name).signals[key]
    for t in (0.0, 0.7, 1.0, 9.1):
        assert signal(t) == pytest.approx(amplitude * math.sin(0.5 * math.pi * t), rel=1e-12)


def test_loads_are_pulled_and_lifted() -> None:
    horizontal, diagonal, lift = (load_scene(f"load-{kind}-80").signals for kind in ("horizontal", "diagonal", "lift"))
    assert (horizontal["F_cx"](3.0), horizontal["F_cy"](3.0)) == (200.0, 0.0)
    assert (diagonal["F_cx"](3.0), diagonal["F_cy"](3.0)) == (200.0, -200.0)
    assert [lift["F_cy"](t) for t in (0.0, 15.49, 15.5, 31.0)] == [-2000.0, -2000.0, 0.0, 0.0]
    assert lift["F_cy"].breaks(0.0, 31.0) == [15.5]
    assert lift["F_cx"](20.0) == 1.0


def test_a_scene_by_path_brings_its_files(tmp_path: Path) -> None:
    text = load_scene("free-12-air").text
    text = text.replace("[run]", '[inputs]\nu_m1 = { signal = "csv", file = "waves/heave.csv", value = "F" }\n\n[run]')
    text = text.replace("[run]", '[outputs]\ndrop = ["energy"]\n\n[run]').replace('frame_interval = "1 s"', "")
    path = tmp_path / "my-heave.toml"
    path.write_text(text, encoding="utf-8")
    (tmp_path / "waves").mkdir()
    (tmp_path / "waves" / "heave.csv").write_bytes(b"t,F\n0,100\n10,300\n")
    scene = load_scene(path)
    assert (scene.name, scene.path, scene.text) == ("my-heave", path, text)
    assert scene.files == {"waves/heave.csv": b"t,F\n0,100\n10,300\n"}
    assert scene.signals["u_m1"](5.0) == 200.0
    assert scene.cable.input_start == {"u_m1": 100.0}
    assert scene.dropped_outputs == ("energy",)
    assert scene.frame_interval == pytest.approx(31.0 / 30.0)
    # The same again from what travels inside the FMU
    again = Scene.from_text(scene.text, name=scene.name, files=scene.files)
    assert again.signals == scene.signals
    assert again.cable.parameters == scene.cable.parameters
    with pytest.raises(SceneError, match=r"^my-heave\.toml: inputs\.u_m1: waves/heave\.csv: there is no such file"):
        Scene.from_text(scene.text, name=scene.name)


def test_the_pinned_scene_is_the_one_with_the_huge_mass_but_for_its_anchor() -> None:
    pinned, heavy = (load_scene(f"seabed-{anchor}-60") for anchor in ("pin", "mass"))
    cable = dataclasses.replace(pinned.cable, terminal=Terminal.ANCHOR_MASS, rest_position=(0.0, 0.0))
    for name in ("position", "velocity", "terminal", "rest_position", "drag", "inputs", "input_start"):
        assert np.array_equal(getattr(cable, name), getattr(heavy.cable, name)), name
    assert dataclasses.astuple(cable.links)[0].tolist() == heavy.cable.links.length.tolist()
    assert cable.parameters | {"m_c": 8e8} == heavy.cable.parameters
    assert pinned.signals == heavy.signals


def test_a_motion_is_given_by_its_place_and_its_derivatives_follow() -> None:
    scene = load_scene("towed-40")
    w = 2.0 * math.pi / 8.0
    for t in (0.0, 0.7, 9.1):
        sine, cosine = math.sin(w * t), math.cos(w * t)
        place, velocity, acceleration = (scene.signals[f"{kind}y_1"](t) for kind in ("", "v", "a"))
        assert place == pytest.approx(1.5 * (1.0 - cosine), rel=0, abs=1e-14)
        assert velocity == pytest.approx(1.5 * w * sine, rel=0, abs=1e-14)
        assert acceleration == pytest.approx(1.5 * w * w * cosine, rel=0, abs=1e-14)
    start = scene.cable.input_start
    assert start["ay_1"] == pytest.approx(1.5 * w * w)
    assert {name: start[name] for name in ("x_1", "y_1", "vx_1", "vy_1")} == pytest.approx(
        {"x_1": 0.0, "y_1": 0.0, "vx_1": 0.0, "vy_1": 0.0}, abs=1e-14
    )


def test_a_vessel_of_which_nothing_is_said_rests() -> None:
    text = "\n".join(line for line in load_scene("lifted-40").text.splitlines() if not line.startswith(("x_2", "y_")))
    scene = Scene.from_text(text, name="lifted")
    assert {name: signal(3.0) for name, signal in scene.signals.items() if signal(3.0)} == {"x_2": 80.0, "y_2": 10.0}
    assert {name: value for name, value in scene.cable.input_start.items() if value} == {"x_2": 80.0, "y_2": 10.0}


def test_a_motion_from_samples_is_smooth() -> None:
    """A clamped cubic spline: through every sample, without a jump of velocity or acceleration, at rest outside."""
    samples = b"0,2\n1,2.5\n3,-1\n4,0\n"
    text = "\n".join(
        line if not line.startswith("y_1") else 'y_1 = { signal = "csv", file = "ship.csv" }'
        for line in load_scene("towed-40").text.splitlines()
    )
    signals = Scene.from_text(text, name="x", files={"ship.csv": samples}).signals
    place, velocity, acceleration = (signals[name] for name in ("y_1", "vy_1", "ay_1"))
    assert [place(t) for t in (-1.0, 0.0, 1.0, 3.0, 4.0, 9.0)] == pytest.approx([2.0, 2.0, 2.5, -1.0, 0.0, 0.0])
    for t in (1.0, 3.0):
        assert velocity(t) == pytest.approx(velocity(t - 1e-9), abs=1e-7)
        assert acceleration(t) == pytest.approx(acceleration(t - 1e-9), abs=1e-7)
    assert [velocity(t) for t in (0.0, 4.0)] == pytest.approx([0.0, 0.0], abs=1e-12)
    h = 1e-5
    for t in (0.3, 2.2, 3.9):
        assert velocity(t) == pytest.approx((place(t + h) - place(t - h)) / (2 * h), rel=1e-8, abs=1e-8)
        assert acceleration(t) == pytest.approx((velocity(t + h) - velocity(t - h)) / (2 * h), rel=1e-8, abs=1e-8)
    assert velocity.breaks(0.0, 5.0) == [1.0, 3.0, 4.0]


def with_lines(table: str, *lines: str, scene: str = "free-12-air") -> Scene:
    """A shipped scene with further lines in one of its tables, which it may not have yet."""
    text = load_scene(scene).text
    header = f"[{table}]\n"
    text = text if header in text else f"{text}\n{header}"
    return Scene.from_text(text.replace(header, header + "\n".join(lines) + "\n"), name="changed")


def test_solver_and_start_are_chosen_by_name() -> None:
    plain = load_scene("free-12-air").cable
    assert (plain.solver, plain.initial) == (SolverChoice.AUTOMATIC, Initial.SHAPE)
    for solver in SolverChoice:
        for initial in Initial:
            cable = with_lines("run", f'solver = "{solver}"', f'initial = "{initial}"').cable
            assert (cable.solver, cable.initial) == (solver, initial)


def test_health_of_the_solver_can_be_left_out_as_a_whole() -> None:
    health = tuple(table().solver)
    assert "solver.steps" in health and load_scene("free-12-air").dropped_outputs == ()
    assert with_lines("outputs", "solver = false").dropped_outputs == health
    assert with_lines("outputs", "solver = true").dropped_outputs == ()
    both = with_lines("outputs", "solver = false", 'drop = ["energy", "solver.rhs"]').dropped_outputs
    assert sorted(both) == sorted(("energy", *health))


def test_outputs_of_an_equilibrium_can_be_dropped_where_there_is_one() -> None:
    text = load_scene("free-12-air").text.replace("[run]\n", '[run]\ninitial = "equilibrium"\n')
    scene = Scene.from_text(text + '[outputs]\ndrop = ["statics.residual", "statics.iterations"]\n', name="still")
    assert scene.dropped_outputs == STATICS


def test_a_byte_order_mark_and_foreign_line_ends_do_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + load_scene("free-12-air").text.replace("\n", "\r\n").encode())
    assert load_scene(str(path)).cable.n == 12


def test_a_scene_does_not_change() -> None:
    scene = load_scene("free-12-air")
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene.name = "other"  # type: ignore[misc]
    with pytest.raises(ValueError, match="frozen"):
        scene.spec.gravity = 1.0
