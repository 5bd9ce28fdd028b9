"""From a scene to results: four ways through FMPy that agree, and mistakes answered before the run."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
import xarray as xr

from cablefmu.cable import SolverChoice
from cablefmu.errors import CableError, FmuError, OptionError, RunError, SceneError
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.table import table
from cablefmu.scene import Scene
from cablefmu.signals import Constant
from cablefmu.simulate import simulate
from tests.fmu.test_archive import rewrite
from tests.fmu_helpers import KINDS, SCENES, from_equilibrium, small_scene, with_links, with_parameters

WAYS = [(2, "cs"), (2, "me"), (3, "cs"), (3, "me")]
SINE = '{ signal = "sine", amplitude = 800, frequency = 0.5 }'
JUMPS = '{ signal = "steps", times = [0.25, 1.13], values = [900, -400] }'


def jumping() -> Scene:
    return Scene.from_text(SCENES["load"].replace(SINE, JUMPS), name="jumping")


@pytest.mark.parametrize("scene", [*map(small_scene, KINDS), jumping()], ids=lambda scene: scene.name)
def test_four_ways_agree(scene: Scene) -> None:
    """Dormand-Prince in the FMU and CVode outside share nothing; both are run at 1e-9."""
    results = [simulate(scene, fmi=fmi, interface=interface, tolerance=1e-9) for fmi, interface in WAYS]
    for other in results[1:]:
        for name in {"y_m1", "v_m1", "x_m1", "vx_m1", "x_c", "y_c", "vx_c", "vy_c"} & set(results[0].data_vars):
            np.testing.assert_allclose(other[name], results[0][name], rtol=0.0, atol=2e-6)
        np.testing.assert_allclose(other["tension_max"], results[0]["tension_max"], rtol=1e-5, atol=1e-3)


@pytest.mark.parametrize("step", [0.5, 0.037])
@pytest.mark.parametrize(("fmi", "interface"), WAYS)
def test_the_communication_step_does_not_matter(fmi: int, interface: str, step: float) -> None:
    """Inside a step the FMU follows the force: only the solver's tolerance is left."""
    fine = simulate(jumping(), fmi=fmi, interface=interface, step=0.01, tolerance=1e-9)
    coarse = simulate(jumping(), fmi=fmi, interface=interface, step=step, tolerance=1e-9)
    assert float(coarse["x_c"][-1]) == pytest.approx(float(fine["x_c"][-1]), abs=1e-7)
    assert float(coarse["y_m1"][-1]) == pytest.approx(float(fine["y_m1"][-1]), abs=1e-7)


@pytest.mark.parametrize("kind", ["load", "floater"])
@pytest.mark.parametrize(("fmi", "interface"), WAYS)
def test_fmpy_runs_the_archive_out_of_the_box(kind: str, fmi: int, interface: str, tmp_path: Path) -> None:
    text = SCENES[kind].replace(SINE, "500")
    scene = Scene.from_text(text, name=kind)  # a constant force is the input's start value
    path = build_fmu(scene, tmp_path / "x.fmu", fmi=fmi)
    kinds = {"cs": "CoSimulation", "me": "ModelExchange"}
    theirs = fmpy.simulate_fmu(str(path), fmi_type=kinds[interface], relative_tolerance=1e-8, output_interval=0.1)
    ours = simulate(path, interface=interface, tolerance=1e-8)
    np.testing.assert_allclose(theirs["time"], ours["time"], atol=1e-12)
    for name in ("y_m1", "x_c", "y_c", "vx_c"):
        np.testing.assert_allclose(theirs[name], ours[name], rtol=0.0, atol=2e-6)


# --- what comes out ---


@pytest.mark.parametrize(
    ("stop", "step", "times"),
    [
        (0.5, 0.2, [0.0, 0.2, 0.4, 0.5]),
        (0.3, 0.1, [0.0, 0.1, 0.2, 0.3]),
        (0.1, 5.0, [0.0, 0.1]),
        (0.1, 1e12, [0.0, 0.1]),
        (0.7, 0.1, [0.0, 0.1, 0.2, 0.1 * 3, 0.4, 0.5, 0.1 * 6, 0.7]),
    ],
)
def test_the_first_row_is_the_start_and_the_last_the_stop(stop: float, step: float, times: list[float]) -> None:
    assert simulate(small_scene("load"), stop_time=stop, step=step)["time"].values.tolist() == times


def test_ten_thousand_steps_end_on_time() -> None:
    result = simulate(small_scene("load"), stop_time=100.0, step=0.01)
    assert len(result["time"]) == 10_001
    assert result["time"].values[-1] == 100.0


def test_defaults_are_the_scenes() -> None:
    result = simulate(small_scene("load"))
    assert (result["time"].values[-1], len(result["time"])) == (2.0, 21)
    assert (result.attrs["fmi"], result.attrs["interface"], result.attrs["tolerance"]) == (2, "cs", 1e-6)


def test_all_angles_make_one_array() -> None:
    result = simulate(small_scene("load"), stop_time=0.3, record=["theta", "omega", "u_m1", "der(v_m1)"])
    assert result["theta"].dims == result["omega"].dims == ("time", "link")
    x = (result["link_length"] * np.sin(result["theta"])).sum("link")
    np.testing.assert_allclose(x, result["x_c"], rtol=1e-14)
    np.testing.assert_allclose(result["u_m1"], 800.0 * np.sin(np.pi * result["time"]), rtol=1e-12, atol=1e-9)


def test_one_link_can_be_recorded_alone() -> None:
    result = simulate(small_scene("load"), stop_time=0.1, record=["theta[3]", "x_c"])
    assert result["theta[3]"].dims == ("time",)
    assert "theta" not in result


def test_progress_is_told() -> None:
    told: list[tuple[float, float]] = []
    simulate(small_scene("load"), stop_time=0.2, progress=lambda time, stop: told.append((time, stop)))
    assert told == [(0.1, 0.2), (0.2, 0.2)]


def test_a_run_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    simulate(small_scene("load"), stop_time=0.1)
    with pytest.raises(RunError):
        simulate(small_scene("load"), parameters={"F_cx": 1e300})
    assert list(tmp_path.iterdir()) == []


def test_a_solver_tells_of_itself_and_nobody_elses_does() -> None:
    """Every figure of the FMU's solver in Co-Simulation; of CVode, which has its own, what it counts."""
    own = simulate(small_scene("load"), stop_time=0.5)
    told = {f"solver.{name.removeprefix('solver_')}": v for name, v in own.attrs.items() if name.startswith("solver_")}
    assert told == {name: own[name].values[-1] for name in table().solver}
    measured = {name for name, value in told.items() if isinstance(value, float)}
    assert measured == {"solver.step_size", "solver.error_estimate", "solver.energy_residual"}
    cvode = simulate(small_scene("load"), stop_time=0.5, interface="me").attrs
    assert {name for name in cvode if name.startswith("solver_")} == {"solver_steps", "solver_rejected", "solver_rhs"}


def test_a_scene_without_health_outputs_runs_and_tells_nothing() -> None:
    scene = Scene.from_text(SCENES["load"] + "[outputs]\nsolver = false\n", name="silent")
    result = simulate(scene, stop_time=0.5)
    assert not [name for name in (*result, *result.attrs) if str(name).startswith("solver")]
    assert result["x_c"].values[-1] == simulate(small_scene("load"), stop_time=0.5)["x_c"].values[-1]


# --- what can be set ---


def test_parameters_inputs_and_start_values_can_be_set() -> None:
    scene = small_scene("load")
    given = {"m_c": 80.0, "u_m1": 150.0, "theta[1]": 0.2, "v_m1": 0.3}
    position, velocity = scene.cable.position.copy(), scene.cable.velocity.copy()
    position[1], velocity[0] = 0.2, 0.3
    built = with_parameters(scene, m_c=80.0)
    cable = replace(built.cable, position=position, velocity=velocity)
    built = replace(built, cable=cable, signals={**scene.signals, "u_m1": Constant(150.0)})
    was_set = simulate(scene, parameters=given, stop_time=1.0)
    text = SCENES["load"].replace(SINE, "150")
    was_built = simulate(replace(built, text=text), stop_time=1.0)
    for name in ("y_m1", "x_c", "tension_top"):
        np.testing.assert_allclose(was_set[name], was_built[name], rtol=1e-12)


@pytest.mark.parametrize(("fmi", "interface"), WAYS)
def test_the_solver_is_set_by_name(fmi: int, interface: str) -> None:
    """In Model Exchange as well, where it changes nothing: the same settings do for both."""
    runs = {
        name: simulate(small_scene("load"), fmi=fmi, interface=interface, tolerance=1e-8, parameters={"solver": name})
        for name in SolverChoice
    }
    assert {name: run.attrs["set"] for name, run in runs.items()} == {name: f"solver={name}" for name in runs}
    jacobians = {name: float(run["solver.jacobians"][-1]) for name, run in runs.items()}
    assert jacobians["explicit"] == 0.0
    assert (jacobians["implicit"] > 0.0) == (interface == "cs")
    for run in runs.values():
        # Two methods that share no formula: a hundred times the tolerance, over two seconds.
        np.testing.assert_allclose(run["x_c"], runs[SolverChoice.EXPLICIT]["x_c"], rtol=0.0, atol=1e-6)
        assert interface == "cs" or run["x_c"].equals(runs[SolverChoice.EXPLICIT]["x_c"])


def test_a_set_force_is_constant_in_place_of_the_scenes() -> None:
    result = simulate(jumping(), parameters={"u_m1": 5.0}, record=["u_m1"])
    assert np.all(result["u_m1"] == 5.0)


WRONG: list[tuple[dict[str, Any], type[CableError], str]] = [
    ({"fmi": 1}, OptionError, "fmi = 1: 2 or 3 is expected"),
    ({"interface": "xx"}, OptionError, "interface = 'xx': cs"),
    ({"stop_time": 0.0}, OptionError, r"stop time = 0.0: a number above 0 \[s\]"),
    ({"stop_time": math.nan}, OptionError, "stop time = nan: a number above 0"),
    ({"step": -1.0}, OptionError, "step = -1.0: a number above 0"),
    ({"step": 1e-9}, OptionError, "more than 10,000,000 output times"),
    ({"tolerance": math.inf}, OptionError, "tolerance = inf: a number above 0"),
    ({"tolerance": 0.5}, OptionError, "tolerance = 0.5: at most 0.1"),
    ({"parameters": {"M_2": 1.0}}, OptionError, "set M_2: there is no such variable; did you mean M_1?"),
    ({"parameters": {"x_c": 1.0}}, OptionError, "set x_c: it is calculated and cannot be set"),
    ({"parameters": {"m_c": math.nan}}, OptionError, r"set m_c=nan: a finite number \[kg\]"),
    ({"parameters": {"m_c": -1.0}}, OptionError, r"set m_c=-1.0: a number above 0 \[kg\] is expected"),
    ({"parameters": {"c_m1": -1.0}}, OptionError, r"set c_m1=-1.0: a number of 0 or more \[N.s/m\] is expected"),
    ({"parameters": {"m_c": "heavy"}}, OptionError, r"set m_c=heavy: a finite number \[kg\] is expected"),
    ({"parameters": {"solver": "fast"}}, OptionError, "set solver=fast: one of automatic, explicit, implicit"),
    ({"parameters": {"solver": 2}}, OptionError, "set solver=2: one of automatic, explicit, implicit"),
    ({"parameters": {"solver.steps": 2.0}}, OptionError, r"set solver.steps: it is calculated"),
    ({"record": ["solver"]}, OptionError, "record solver: it is a fixed choice, not a number over time"),
    ({"record": ["theta[6]"]}, OptionError, r"record theta\[6\]: there is no such variable; did you mean theta\["),
    ({"record": ["time"]}, OptionError, "record time: there is no such variable"),
]


@pytest.mark.parametrize(("options", "error", "says"), WRONG)
def test_mistakes_are_found_before_the_run(options: dict[str, Any], error: type[CableError], says: str) -> None:
    with pytest.raises(error, match=says):
        simulate(small_scene("load"), **options)


def test_an_fmu_has_its_own_version(tmp_path: Path) -> None:
    path = build_fmu(small_scene("load"), tmp_path / "x.fmu", fmi=3)
    with pytest.raises(OptionError, match="is an FMU of version 3; leave the version out"):
        simulate(path, fmi=2)
    xr.testing.assert_equal(simulate(path, stop_time=0.2), simulate(small_scene("load"), fmi=3, stop_time=0.2))


def test_what_cannot_be_run(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match='no scene "load" ships'):
        simulate("load")
    with pytest.raises(FmuError, match="there is no such file"):
        simulate(tmp_path / "x.fmu")
    path = build_fmu(small_scene("load"), tmp_path / "x.fmu")
    before = Path.cwd()
    with pytest.raises(FmuError, match="the FMU's library cannot be loaded"):
        simulate(rewrite(path, {}, tmp_path, without="binaries/"))
    with pytest.raises(FmuError, match=r"resource file .*cable.bin: cannot be opened"):
        simulate(rewrite(path, {}, tmp_path, without="cable.bin"))
    with pytest.raises(FmuError, match=r"does not belong to cable\.bin"):
        simulate(rewrite(path, {b'guid="{': b'guid="{0'}, tmp_path))
    assert Path.cwd() == before


# --- runs that start from equilibrium ---


def test_four_ways_start_from_one_equilibrium() -> None:
    scene = from_equilibrium(small_scene("floater"))
    runs = [simulate(scene, fmi=fmi, interface=interface, tolerance=1e-9) for fmi, interface in WAYS]
    for run in runs:
        assert float(run["vx_c"][0]) == 0.0
        assert len(set(run["statics.residual"].values)) == 1, "it stays as it was at the start"
        assert float(run["statics.residual"][0]) < 1e-7
        for name in ("y_m1", "x_c", "y_c"):
            np.testing.assert_allclose(run[name], runs[0][name], rtol=0.0, atol=2e-6)


@pytest.mark.parametrize(("fmi", "interface"), WAYS)
def test_a_cable_that_nothing_holds_is_not_run(fmi: int, interface: str) -> None:
    with pytest.raises(RunError, match="no stable equilibrium was found near the start shape at t = 0 s"):
        simulate(
            from_equilibrium(small_scene("load")), fmi=fmi, interface=interface, parameters={"k_m1": 0.0, "u_m1": 9.0}
        )


# --- runs that fail ---


SPUN = {f"{name}[{i}]": value for i in range(1, 6) for name, value in (("theta", 1.6e6 - 2.75), ("omega", 5.0))}
"""A cable that whirls about its top and soon has wound up further than sine and cosine reach, 1.6e6 rad."""


@pytest.mark.parametrize(("fmi", "interface"), WAYS)
def test_a_run_that_fails_keeps_what_it_has(fmi: int, interface: str) -> None:
    loose = SCENES["air"].replace("young_modulus = 8e10", "joint_stiffness = 0").replace("damping = 2.8", "damping = 0")
    scene = Scene.from_text(loose, name="whirling")
    with pytest.raises(RunError, match=r"t = 0\.\d+ s.* wound up beyond 1.6e6 rad") as ended:
        simulate(scene, fmi=fmi, interface=interface, parameters=SPUN)
    partial, time = ended.value.partial, ended.value.time
    assert isinstance(partial, xr.Dataset)
    assert time is not None
    assert 0.2 < time < 1.0
    assert partial["time"].values[-1] == time
    assert partial.attrs["ended_early"] == str(ended.value)
    whole = simulate(scene, fmi=fmi, interface=interface, parameters=SPUN, stop_time=time)
    np.testing.assert_array_equal(partial["x_c"], whole["x_c"])


def test_the_reason_is_a_sentence() -> None:
    with pytest.raises(RunError, match=r"doStep ended at t = 0 s: .* the motion is too violent") as ended:
        simulate(small_scene("load"), parameters={"F_cx": 1e300})
    assert ended.value.time == 0.0


# --- FMUs with arrays ---


@pytest.fixture(scope="module")
def with_arrays(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("arrays")
    return {kind: build_fmu(small_scene(kind), folder / f"{kind}.fmu", arrays=True) for kind in ("load", "floater")}


@pytest.mark.parametrize("interface", ["cs", "me"])
@pytest.mark.parametrize("kind", ["load", "floater"])
def test_arrays_are_recorded_link_by_link(kind: str, interface: str, with_arrays: dict[str, Path]) -> None:
    """To the bit what the scene with as many links gives, coordinates and names included."""
    record = ["omega", "theta", "der(omega[7])"]
    found = simulate(with_arrays[kind], interface=interface, parameters={"n": 7, "M_1": 650.0}, record=record)
    scene = with_links(small_scene(kind), 7)
    expected = simulate(scene, fmi=3, interface=interface, parameters={"M_1": 650.0}, record=record)
    xr.testing.assert_identical(found.drop_attrs(), expected.drop_attrs())
    assert {n: v.attrs for n, v in found.variables.items()} == {n: v.attrs for n, v in expected.variables.items()}
    assert found["theta"].dims == ("time", "link")
    assert (found.attrs["fmi"], found.attrs["set"]) == (3, "n=7 M_1=650.0")


def test_single_elements_are_recorded(with_arrays: dict[str, Path]) -> None:
    every = simulate(with_arrays["load"], stop_time=0.5, record=["theta"])
    some = simulate(with_arrays["load"], stop_time=0.5, record=["theta[4]", "der(theta[2])", "theta[2]"])
    np.testing.assert_array_equal(some["theta[4]"], every["theta"][:, 3])
    np.testing.assert_array_equal(some["theta[2]"], every["theta"][:, 1])
    assert some["der(theta[2])"].attrs["long_name"].startswith("Time derivative of theta[2]")


def test_the_cable_that_was_set_is_the_one_of_the_results(with_arrays: dict[str, Path]) -> None:
    given = {"n": 8, "L": 16.0, "theta_start": 0.0, "EI": 800.0}
    found = simulate(with_arrays["load"], stop_time=0.2, parameters=given, record=["theta", "modes"])
    np.testing.assert_array_equal(found["link_length"], np.full(8, 2.0))
    assert float(found["y_c"][0]) == 16.0
    text = SCENES["load"].replace("links = 5", "links = 8").replace("length = 20", "length = 16")
    text = text.replace("young_modulus = 8e10", "joint_stiffness = 400").replace("angle = 0.5", "angle = 0.0")
    static_load = small_scene("load").cable.parameters["static_load"]
    written = Scene.from_text(
        text.replace("damping = 240\n", f"damping = 240\nstatic_load = {static_load!r}\n"), name="x"
    )
    expected = simulate(written, fmi=3, stop_time=0.2, record=["modes"])
    np.testing.assert_array_equal(found["frequency"], expected["frequency"])
    np.testing.assert_array_equal(found["x_c"], expected["x_c"])


def test_modes_are_those_of_the_cable_that_was_set(with_arrays: dict[str, Path]) -> None:
    """Where preloads follow gravity, the equilibrium does as well."""
    given = {"n": 8, "g": 12.0, "rho_w": 900.0}
    found = simulate(with_arrays["floater"], stop_time=0.2, parameters=given, record=["modes"])
    text = "gravity = 12.0\n" + SCENES["floater"].replace("links = 5", "links = 8")
    written = Scene.from_text(text.replace("[water]\n", "[water]\ndensity = 900.0\n"), name="floater")
    expected = simulate(written, fmi=3, stop_time=0.2, record=["modes"])
    np.testing.assert_array_equal(found["frequency"], expected["frequency"])
    np.testing.assert_array_equal(found["x_c"], expected["x_c"])


WRONG_FOR_ARRAYS: list[tuple[dict[str, Any], str]] = [
    ({"parameters": {"n": 0}}, "set n=0: a whole number of links from 1 to 10000 is expected"),
    ({"parameters": {"n": 2.5}}, "set n=2.5: a whole number of links from 1 to 10000 is expected"),
    ({"parameters": {"n": math.nan}}, "set n=nan: a whole number of links from 1 to 10000 is expected"),
    ({"parameters": {"n": "many"}}, "set n=many: a whole number of links from 1 to 10000 is expected"),
    ({"parameters": {"L": -1.0}}, r"set L=-1.0: a number above 0 \[m\] is expected"),
    ({"parameters": {"L": 1e-300}}, r"set L=1e-300: a number from 1e-12 to 1e\+15 \[m\] is expected"),
    ({"parameters": {"theta_start": math.inf}}, r"set theta_start=inf: a finite number \[rad\] is expected"),
    ({"parameters": {"theta": 0.1}}, "set theta: it is calculated and cannot be set"),
    ({"parameters": {"theta[1]": 0.1}}, r"set theta\[1\]: there is no such variable"),
    ({"record": ["n"]}, "record n: it is a fixed choice, not a number over time"),
    ({"record": ["theta[6]"]}, r"record theta\[6\]: there is no such variable"),
]


@pytest.mark.parametrize(("options", "says"), WRONG_FOR_ARRAYS)
def test_mistakes_with_arrays(options: dict[str, Any], says: str, with_arrays: dict[str, Path]) -> None:
    with pytest.raises(OptionError, match=says):
        simulate(with_arrays["load"], **options)


def test_too_few_links_between_two_ports(with_arrays: dict[str, Path]) -> None:
    with pytest.raises(SceneError, match="no rest shape of these links joins the ports"):
        simulate(with_arrays["floater"], parameters={"n": 1})


def test_only_arrays_have_a_number_of_links() -> None:
    with pytest.raises(OptionError, match="set n: there is no such variable"):
        simulate(small_scene("load"), fmi=3, parameters={"n": 7})


# --- motions that are given ---


def test_a_vessel_that_was_put_somewhere_rests_there() -> None:
    """Its velocity and acceleration are not the scene's any more."""
    run = simulate(small_scene("moved"), stop_time=0.5, parameters={"x_1": 2.0}, record=["x_1", "vx_1", "ax_1", "vy_1"])
    assert set(run["x_1"].values) == {2.0}
    assert set(run["vx_1"].values) == set(run["ax_1"].values) == {0.0}
    assert np.ptp(run["vy_1"].values) > 0.1, "the other coordinate is the scene's"


@pytest.mark.parametrize("name", ["vx_1", "ay_1"])
def test_derivatives_of_a_motion_are_not_set(name: str) -> None:
    place = f"{name[1]}_1"
    with pytest.raises(OptionError, match=f"set {name}: it follows {place}, whose derivative it is; that can be set"):
        simulate(small_scene("moved"), parameters={name: 1.0})
