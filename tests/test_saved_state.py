"""Runs that are saved and gone on with: the same bits, and nothing taken that is not such a state."""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from cablefmu.errors import CableError, OptionError, StateError
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.twin import build_twin
from cablefmu.saved_state import hash_of, read_state
from cablefmu.scene import Scene
from cablefmu.simulate import simulate
from tests.fmu_helpers import KINDS, SCENES, from_equilibrium, small_scene
from tests.test_simulate import jumping

TITLE = b"cablefmu state 1\n"


def assert_the_same(part: xr.Dataset, whole: xr.Dataset) -> None:
    xr.testing.assert_identical(part.drop_attrs(deep=False), whole.drop_attrs(deep=False))


def sealed(body: bytes) -> bytes:
    return body + hashlib.sha256(body).digest()


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    """The state of the scene `load` at 0.5 s."""
    path = tmp_path / "load.state"
    simulate(small_scene("load"), stop_time=0.5, save_state=path)
    return path


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("solver", ["automatic", "explicit", "implicit"])
@pytest.mark.parametrize("scene", [*map(small_scene, KINDS), jumping(), from_equilibrium(small_scene("pin"))],
                         ids=lambda scene: f"{scene.name}-{scene.cable.initial.name}")  # fmt: skip
def test_a_run_in_parts_is_the_run_in_one(scene: Scene, solver: str, fmi: int, tmp_path: Path) -> None:
    """Forces that follow a sine, and jump; the second part is saved as well, where no multiple of 0.1 is a double."""
    settings: dict[str, Any] = {"parameters": {"solver": solver}, "record": ["theta", "omega"], "fmi": fmi}
    whole = simulate(scene, stop_time=1.6, **settings)
    state, settings["parameters"] = tmp_path / "x.state", {}
    simulate(scene, stop_time=0.3, save_state=state, **settings | {"parameters": {"solver": solver}})
    second = simulate(scene, stop_time=1.2, from_state=state, save_state=state, **settings)
    third = simulate(scene, stop_time=1.6, from_state=state, **settings)
    assert_the_same(second, whole.isel(time=slice(3, 13)))
    assert_the_same(third, whole.isel(time=slice(12, None)))
    counted = [name for name in whole.attrs if name.startswith("solver_")]
    assert counted and [third.attrs[name] for name in counted] == [whole.attrs[name] for name in counted]


def test_an_fmu_goes_on_as_its_scene_does(saved: Path, tmp_path: Path) -> None:
    scene = small_scene("load")
    path = build_fmu(scene, tmp_path / "moved.fmu")
    assert_the_same(simulate(path, from_state=saved), simulate(scene, from_state=saved))


def test_the_file_tells_of_the_run(saved: Path) -> None:
    state = read_state(saved)
    assert (state.time, state.step, state.tolerance, state.fmi, state.given) == (0.5, 0.1, 1e-6, 2, {})
    assert state.scene == hash_of(small_scene("load"))
    assert saved.read_bytes().startswith(TITLE)


def test_off_the_grid_a_run_goes_on_to_the_next_multiple_of_the_step(tmp_path: Path) -> None:
    simulate(small_scene("load"), stop_time=0.25, save_state=tmp_path / "x")
    on = simulate(small_scene("load"), stop_time=0.52, from_state=tmp_path / "x")
    assert on["time"].values.tolist() == [0.25, 0.1 * 3, 0.4, 0.5, 0.52]
    finer = simulate(small_scene("load"), stop_time=0.4, step=0.05, from_state=tmp_path / "x")
    np.testing.assert_allclose(finer["time"], [0.25, 0.3, 0.35, 0.4], rtol=1e-14)


def test_inputs_can_be_given_anew_and_stay_as_they_were_set(tmp_path: Path) -> None:
    scene, state = small_scene("load"), tmp_path / "x"
    first = simulate(scene, stop_time=0.5, parameters={"u_m1": 300.0, "m_c": 70.0}, save_state=state)
    as_before = simulate(scene, stop_time=0.8, from_state=state, record=["u_m1", "m_c"])
    assert as_before["u_m1"].values.tolist() == [300.0] * 4
    assert as_before["m_c"].values.tolist() == [70.0] * 4
    anew = simulate(scene, stop_time=0.8, from_state=state, parameters={"u_m1": 0.0}, record=["u_m1"])
    assert anew["u_m1"].values.tolist() == [300.0, 0.0, 0.0, 0.0]
    assert anew["y_m1"].values[0] == first["y_m1"].values[-1]
    assert anew["y_m1"].values[-1] != as_before["y_m1"].values[-1]


WRONG: list[tuple[dict[str, Any], type[CableError], str]] = [
    ({"stop_time": 0.5}, OptionError, "stop time = 0.5 s: the state is of t = 0.5 s; a later time is expected"),
    ({"stop_time": 0.1}, OptionError, "stop time = 0.1 s: the state is of t = 0.5 s; a later time is expected"),
    ({"interface": "me"}, OptionError, "in Model Exchange CVode integrates, and what it remembers cannot be saved"),
    ({"fmi": 3}, StateError, "load.state: was saved of an FMU of version 2; this one is of version 3"),
    ({"tolerance": 1e-3}, OptionError, "tolerance = 0.001: it is in the state (1e-06); leave it out"),
    ({"parameters": {"m_c": 7.0}}, OptionError, "set m_c: it is in the state that the run goes on from; only inputs"),
    ({"parameters": {"theta[1]": 0.1}}, OptionError, "set theta[1]: it is in the state"),
    ({"parameters": {"solver": "explicit"}}, OptionError, "set solver: it is in the state"),
    ({"parameters": {"u_m1": math.nan}}, OptionError, "set u_m1=nan: a finite number [N] is expected"),
    ({"step": 0.0}, OptionError, "step = 0.0: a number above 0 [s] is expected"),
]


@pytest.mark.parametrize(("given", "kind", "says"), WRONG)
def test_what_does_not_go_with_the_state_is_refused(
    given: dict[str, Any], kind: type[CableError], says: str, saved: Path
) -> None:
    with pytest.raises(kind) as refused:
        simulate(small_scene("load"), from_state=saved, **given)
    assert says in str(refused.value)


def test_another_scene_or_an_edited_one_is_refused(saved: Path) -> None:
    edited = Scene.from_text(SCENES["load"].replace("amplitude = 800", "amplitude = 801"), name="load")
    for scene in (small_scene("air"), edited):
        with pytest.raises(
            StateError, match=rf"load\.state: was saved of another scene than {scene.name}, or before it"
        ):
            simulate(scene, from_state=saved)


def test_a_state_of_an_fmu_with_arrays_is_no_state_of_the_scene(tmp_path: Path) -> None:
    archive = build_fmu(small_scene("load"), tmp_path / "arrays.fmu", arrays=True)
    simulate(archive, stop_time=0.2, parameters={"n": 3}, save_state=tmp_path / "n.state")
    with pytest.raises(StateError, match=r"n\.state: was saved of an FMU with arrays; that FMU is expected"):
        simulate(small_scene("load"), from_state=tmp_path / "n.state", stop_time=0.4)
    simulate(archive, stop_time=0.2, save_state=tmp_path / "as-it-was.state")  # n is not among what was set
    with pytest.raises(StateError, match=r"as-it-was\.state: was saved of an FMU with arrays; that FMU is expected"):
        simulate(small_scene("load"), fmi=3, from_state=tmp_path / "as-it-was.state", stop_time=0.4)
    simulate(small_scene("load"), fmi=3, stop_time=0.2, save_state=tmp_path / "scalar.state")
    with pytest.raises(StateError, match=r"scalar\.state: was saved of an FMU without arrays"):
        simulate(archive, from_state=tmp_path / "scalar.state", stop_time=0.4)


def test_a_twin_has_no_state(tmp_path: Path) -> None:
    twin = build_twin(small_scene("load"), tmp_path / "twin.fmu")
    with pytest.raises(OptionError, match=r"twin\.fmu: this FMU cannot save its state; one from `cablefmu build` can"):
        simulate(twin, save_state=tmp_path / "x.state")
    assert not (tmp_path / "x.state").exists()


def test_one_wrong_byte_anywhere_is_found(saved: Path, tmp_path: Path) -> None:
    content = saved.read_bytes()
    damaged = tmp_path / "damaged.state"
    for k in range(len(content)):
        damaged.write_bytes(content[:k] + bytes([content[k] ^ 1 << k % 8]) + content[k + 1 :])
        with pytest.raises(StateError, match=r"damaged\.state: is (damaged or was cut off|not a saved state)"):
            read_state(damaged)
    for length in (0, 5, len(TITLE), len(TITLE) + 20, len(content) - 1):
        damaged.write_bytes(content[:length])
        with pytest.raises(StateError, match=r"damaged\.state: is (damaged or was cut off|not a saved state)"):
            read_state(damaged)


@pytest.mark.parametrize("told", [b"", b"[]", b"{}", b"{", b'{"scene": 1}', b"\xff"])
def test_a_file_of_another_program_is_refused(told: bytes, tmp_path: Path) -> None:
    path = tmp_path / "x.state"
    path.write_bytes(sealed(TITLE + told + b"\n"))
    with pytest.raises(StateError, match=r"x\.state: was not written by `cablefmu run --save-state`"):
        read_state(path)


def test_the_fmu_says_what_is_wrong_with_the_image(saved: Path) -> None:
    """A file in order around an image that is not: as of another version of the package."""
    title, told, image = saved.read_bytes()[:-32].split(b"\n", 2)
    saved.write_bytes(sealed(b"\n".join([title, told, image.replace(b"0.1.0", b"0.0.9", 1)])))
    with pytest.raises(StateError) as refused:
        simulate(small_scene("load"), from_state=saved)
    assert "load.state: deserializing a state: its library's version is 0.0.9; expected is 0.1.0" in str(refused.value)


def test_a_state_that_cannot_be_written_is_said_before_the_run(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OptionError, match="cannot be written"):
        simulate(small_scene("load"), save_state=tmp_path / "file" / "x.state")


def test_json_carries_every_number_to_the_last_bit(saved: Path) -> None:
    told = json.loads(saved.read_bytes()[len(TITLE) :].split(b"\n", 1)[0])
    assert told["time"] == read_state(saved).time == 0.5
