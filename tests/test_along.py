"""Nodes and pulls of a run against the dense model, which shares no code with the kernel, and the FMU's outputs."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cablefmu.along import node_positions, states_for
from cablefmu.cable import Cable, Floats
from cablefmu.errors import OptionError, RunError
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.twin import build_twin
from cablefmu.kernel import KernelModel
from cablefmu.reference.kinematics import motion_of, points
from cablefmu.reference.model import Reference
from cablefmu.reference.outputs import pulls
from cablefmu.scene import Scene
from cablefmu.simulate import simulate
from tests.fmu_helpers import KINDS, SCENES, small_scene, with_links, with_parameters
from tests.random_cables import KINDS as RANDOM_KINDS
from tests.random_cables import random_cable, random_inputs

DENSE = 1e-12
"""Over the largest pull: rounding of the dense equations. Measured on ten kinds of scenes: 3e-14."""

BOTH = ("nodes", "tensions")


def states_of(run: xr.Dataset, cable: Cable) -> tuple[Floats, Floats, list[dict[str, float]]]:
    """q, dq/dt over time, and the inputs at every time by name."""
    halves = []
    for link, heave, surge in (("theta", "y_m1", "x_m1"), ("omega", "v_m1", "vx_m1")):
        names = [{"y_m1": heave, "x_m1": surge}.get(name, link) for name in cable.coordinate_names]
        columns = [run[name].values.reshape(len(run["time"]), -1) for name in dict.fromkeys(names)]
        halves.append(np.hstack(columns))
    inputs = [{name: float(run[name].values[k]) for name in cable.inputs} for k in range(len(run["time"]))]
    return halves[0], halves[1], inputs


@pytest.mark.parametrize("kind", KINDS)
def test_they_are_those_of_the_dense_model(kind: str) -> None:
    scene = small_scene(kind)
    run = simulate(scene, stop_time=0.6, record=[*BOTH, "theta", "omega", *scene.cable.inputs])
    q, v, inputs = states_of(run, scene.cable)
    reference = Reference(scene.cable)
    assert run["tension"].shape == (7, 5) and run["node_x"].shape == (7, 6)
    size = np.abs(run["tension"].values).max()
    for k in range(7):
        motion = motion_of(q[k], v[k], top=scene.cable.top, inputs=inputs[k])
        ends = pulls(motion, reference.joint_forces(q[k], v[k], inputs[k]))
        np.testing.assert_allclose(run["tension"].values[k], ends.max(axis=1), rtol=0.0, atol=DENSE * size)
        shown = np.stack([run["node_x"].values[k], run["node_y"].values[k]], axis=-1)
        np.testing.assert_allclose(shown, points(reference.chain, motion), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("kind", range(len(RANDOM_KINDS)))
def test_both_ends_of_every_link_of_random_cables(kind: int) -> None:
    """Above the middle the elimination has left the forces, below it they come by Newton for each link."""
    rng = np.random.default_rng([4, kind])
    terminal, water, drag = RANDOM_KINDS[kind]
    for n in (1, 2, 9):
        cable = random_cable(rng, n, terminal, water, drag=drag)
        inputs = random_inputs(rng, cable)
        q, v = rng.uniform(-1.0, 1.0, (2, cable.coordinates))
        model, reference = KernelModel(cable), Reference(cable)
        found = model.pulls(np.concatenate([q, v]), model.forces(inputs))
        exact = pulls(motion_of(q, v, top=cable.top, inputs=inputs), reference.joint_forces(q, v, inputs))
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=DENSE * np.abs(exact).max())
        outputs = model.outputs(np.concatenate([q, v]), model.forces(inputs))
        assert (found[0, 0], found[-1, 1]) == (outputs["tension_top"], outputs["tension_end"])
        assert found.max() == outputs["tension_max"]


def test_states_that_cannot_be_are_refused() -> None:
    model = KernelModel(small_scene("load").cable)
    for x in (np.zeros(3), np.full(12, np.nan)):
        with pytest.raises(OptionError, match="x: 12 finite numbers are expected"):
            model.pulls(x, model.forces({}))
    with pytest.raises(OptionError, match=r"angles within 1\.6e6 rad"):
        model.pulls(np.full(12, 1e7), model.forces({}))


@pytest.mark.parametrize(("fmi", "interface"), [(2, "cs"), (2, "me"), (3, "cs"), (3, "me")])
def test_the_largest_along_the_cable_is_the_output(fmi: int, interface: str) -> None:
    """Of the same inputs as the FMU had, also where a force jumps at an output time: tension_max to rounding."""
    jumps = 'F_cx = { signal = "steps", times = [0.2, 0.31], values = [400, -300] }\n'
    scene = Scene.from_text(SCENES["load"].replace("[inputs]\n", f"[inputs]\n{jumps}"), name="load")
    run = simulate(scene, fmi=fmi, interface=interface, stop_time=0.5, record=BOTH)
    np.testing.assert_allclose(run["tension"].max("link"), run["tension_max"], rtol=1e-12)
    np.testing.assert_allclose(run["node_x"][:, -1], run["x_c"], rtol=1e-13)
    np.testing.assert_allclose(run["node_y"][:, -1], run["y_c"], rtol=1e-13)


def test_they_cost_nothing_where_nobody_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> None:
        raise AssertionError("a run without --record found what is along the cable")

    monkeypatch.setattr(sys.modules["cablefmu.simulate"], "along_of", never)
    scene = small_scene("load")
    assert states_for(scene.cable, ["theta", "modes"]) == ()
    run = simulate(scene, stop_time=0.2, record=["omega"])
    assert set(run.dims) == {"time", "link"} and "tension" not in run and "theta" not in run


def test_only_what_was_asked_for_is_kept() -> None:
    """The states and inputs behind the pulls are not, and one angle of them stays one."""
    plain = simulate(small_scene("moved"), stop_time=0.2)
    run = simulate(small_scene("moved"), stop_time=0.2, record=["tensions", "theta[2]"])
    assert set(run.data_vars) - set(plain.data_vars) == {"tension", "theta[2]"}
    assert run["tension"].dims == ("time", "link")
    assert (run["tension"].attrs["units"], run["link_length"].values.tolist()) == ("N", [4.0] * 5)
    nodes = simulate(small_scene("moved"), stop_time=0.2, record=["nodes"])
    assert set(nodes.data_vars) - set(plain.data_vars) == {"node_x", "node_y"}
    assert nodes["node_y"].dims == ("time", "node") and nodes["node"].values.tolist() == [0, 1, 2, 3, 4, 5]


def test_a_scene_asks_for_them() -> None:
    asking = Scene.from_text(SCENES["load"].replace("[run]\n", '[run]\nrecord = ["nodes", "tensions"]\n'), name="load")
    asked = simulate(small_scene("load"), stop_time=0.3, record=[*BOTH, "omega"])
    for name in ("node_x", "node_y", "tension", "omega"):
        np.testing.assert_array_equal(simulate(asking, stop_time=0.3, record=["omega"])[name], asked[name])


def test_a_single_text_is_one_name() -> None:
    assert simulate(small_scene("load"), stop_time=0.2, record="nodes").sizes["node"] == 6


def test_they_are_of_what_was_set() -> None:
    given = {"m_c": 75.0, "F_cx": 300.0, "k_joint": 900.0, "theta[1]": 0.7, "solver": "implicit"}
    run = simulate(small_scene("load"), stop_time=0.3, record=BOTH, parameters=given)
    np.testing.assert_allclose(run["tension"].max("link"), run["tension_max"], rtol=1e-12)
    numbers = {name: given[name] for name in ("m_c", "k_joint")}
    other = simulate(with_parameters(small_scene("load"), **numbers), stop_time=0.3, record=BOTH)
    assert np.abs(run["tension"] - other["tension"]).max() > 1.0, "the force and the angle count as well"


def test_outputs_that_a_scene_drops_are_no_hindrance() -> None:
    text = SCENES["surge"] + '[outputs]\ndrop = ["y_m1", "v_m1", "x_m1", "vx_m1", "tension_max"]\n'
    dropped = simulate(Scene.from_text(text, name="surge"), stop_time=0.3, record=BOTH)
    whole = simulate(small_scene("surge"), stop_time=0.3, record=BOTH)
    assert "y_m1" not in dropped
    for name in ("node_x", "node_y", "tension"):
        np.testing.assert_array_equal(dropped[name], whole[name])


def test_with_arrays_they_have_as_many_links_as_were_asked_for(tmp_path: Path) -> None:
    path = build_fmu(small_scene("floater"), tmp_path / "floater.fmu", arrays=True)
    run = simulate(path, stop_time=0.3, record=BOTH, parameters={"n": 8})
    same = simulate(with_links(small_scene("floater"), 8), fmi=3, stop_time=0.3, record=BOTH)
    assert run.sizes["node"] == 9
    for name in ("node_x", "node_y", "tension"):
        np.testing.assert_array_equal(run[name], same[name])


def test_a_run_that_goes_on_has_them_as_if_it_had_never_stopped(tmp_path: Path) -> None:
    scene, given = small_scene("moved"), {"m_c": 75.0}
    whole = simulate(scene, stop_time=0.4, record=BOTH, parameters=given)
    simulate(scene, stop_time=0.2, parameters=given, save_state=tmp_path / "x.state")
    later = simulate(scene, stop_time=0.4, record=BOTH, from_state=tmp_path / "x.state")
    for name in ("node_x", "node_y", "tension"):
        np.testing.assert_array_equal(later[name], whole[name][2:])


def test_a_twin_has_them_as_well(tmp_path: Path) -> None:
    """The dense model as an FMU: the largest along the cable is what that says itself."""
    run = simulate(build_twin(small_scene("load"), tmp_path / "twin.fmu"), stop_time=0.3, record=BOTH)
    np.testing.assert_allclose(run["tension"].max("link"), run["tension_max"], rtol=1e-10)
    np.testing.assert_allclose(run["node_y"][:, -1], run["y_c"], rtol=1e-13)


@pytest.mark.parametrize("n", [1, 2])
def test_the_shortest_cables(n: int) -> None:
    run = simulate(with_links(small_scene("load"), n), stop_time=0.3, record=BOTH)
    assert run["tension"].shape == (4, n)
    np.testing.assert_allclose(run["tension"].max("link"), run["tension_max"], rtol=1e-12)
    np.testing.assert_allclose(run["node_y"][:, -1], run["y_c"], rtol=1e-13)


def test_a_run_that_fails_has_them_up_to_its_end() -> None:
    with pytest.raises(RunError) as ended:
        simulate(small_scene("load"), parameters={"F_cx": 1e300}, record=BOTH)
    partial = ended.value.partial
    assert isinstance(partial, xr.Dataset)
    assert partial["tension"].shape == (1, 5) and partial["node_x"].shape == (1, 6)
    assert np.all(np.isfinite(partial["node_x"]))


def test_nodes_follow_from_angles_where_they_were_not_recorded() -> None:
    run = simulate(small_scene("load"), stop_time=0.2, record=["nodes", "theta"])
    x, y = node_positions(run.drop_vars(["node_x", "node_y"]))
    np.testing.assert_array_equal(x, run["node_x"])
    np.testing.assert_array_equal(y, run["node_y"])
