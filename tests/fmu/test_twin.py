"""Twin and native FMU: two implementations that share no computation, driven alike, give one answer."""

from __future__ import annotations

import gc
import json
import sys
import zipfile
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

import cablefmu
from cablefmu.cable import Floats, Top
from cablefmu.errors import FmuError, OptionError, SceneError
from cablefmu.fmu.twin import build_twin, scene_of_twin
from cablefmu.scene import Scene, load_scene
from tests.fmu.test_archive import second_checker
from tests.fmu_helpers import KINDS, SCENES, Host, from_equilibrium, small_scene, unpack

NAMES = (*KINDS, "free-12-water")
"""Every terminal with five links, and a cable of 240 m that ships."""

TOLERANCE = 1e-10
"""Of both solvers, relative."""

AGREEMENT = {"m": 1e-8, "m/s": 1e-7, "N": 1e-5, "J": 1e-5, "kg": 1e-5}
"""By unit. Measured over 1 s: 4e-10 m, 1e-9 m/s, 3e-7 N and 4e-7 J at most, which is what the solvers'
tolerance leaves. Any one parameter that is wrong by 1 % moves some output by 150 times this or more."""

FOLLOWED = {f"{kind}{axis}_{end}" for kind in ("", "v") for axis in "xy" for end in (1, 2)}

Unpacked = Callable[[str], tuple[Path, Path]]


def scene_of(name: str) -> Scene:
    return small_scene(name) if name in KINDS else load_scene(name)


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Unpacked:
    """both(name): folders of the scene's native FMU and of its twin."""
    folder = tmp_path_factory.mktemp("twins")

    @cache
    def build(name: str) -> tuple[Path, Path]:
        scene, twin = scene_of(name), folder / f"{name}-twin"
        extract(str(build_twin(scene, twin.with_suffix(".fmu"))), unzipdir=str(twin))
        return unpack(scene, folder, 2), twin

    return build


def drive(folder: Path, steps: int = 10, **values: float) -> Floats:
    """All outputs at 0, 0.1 s, ... under forces that are held over a step and jump between steps."""
    with Host(folder) as host:
        host.set_all(values)
        host.enter_initialization(tolerance=TOLERANCE)
        host.fmu.exitInitializationMode()
        outputs = [name for name in host.names("output") if not name.startswith("solver.")]
        inputs = host.names("input")
        # Forces [N]; of a motion the acceleration alone [m/s^2], which velocity and place follow from step to step.
        sizes = {name: 0.3 if name[0] == "a" else 300.0 for name in inputs if name not in FOLLOWED}
        rows = [host.get(*outputs)]
        for k in range(steps):
            host.set_all({name: size * np.sin(0.7 * k + place) for place, (name, size) in enumerate(sizes.items())})
            host.step(k * 0.1, 0.1)
            rows.append(host.get(*outputs))
    return np.array(rows)


def agreement(folder: Path) -> Floats:
    """Allowed difference of each output."""
    variables = read_model_description(str(folder), validate=False).modelVariables
    return np.array([AGREEMENT[v.unit] for v in variables if v.causality == "output"])


@pytest.mark.parametrize("name", NAMES)
def test_twin_and_native_fmu_give_the_same_outputs(name: str, both: Unpacked) -> None:
    native, twin = both(name)
    apart = np.max(np.abs(drive(native) - drive(twin)), axis=0)
    assert np.all(apart < agreement(twin)), apart


@pytest.mark.parametrize("name", KINDS)
def test_parameters_and_start_values_that_are_set_give_the_same(name: str, both: Unpacked) -> None:
    native, twin = both(name)
    cable = scene_of(name).cable
    # Every parameter by another factor, so that none can stand in for another.
    values = {key: value * (1.1 + 0.01 * k) + 0.01 for k, (key, value) in enumerate(cable.parameters.items())}
    held = name in ("pin", "surge", "between")
    if not held:  # such a start is off the pin, and each of the two comes back to it in its own way
        values |= {"theta[2]": cable.angles_in(cable.position)[1] + 0.1, "omega[3]": 0.2}
        values |= {"y_m1": 0.05} if cable.top is Top.FLOATER else {}
    was_set = drive(twin, **values)
    assert np.all(np.max(np.abs(drive(native, **values) - was_set), axis=0) < agreement(twin))
    differs = np.max(np.abs(drive(twin) - was_set), axis=0) > agreement(twin)
    # Place and velocity of an end that is held or moved are four outputs that nothing changes.
    assert np.count_nonzero(~differs) == (4 if held else 0)


# --- what a host sees ---


@pytest.mark.parametrize("name", NAMES)
def test_the_description_is_the_native_one_without_counters(name: str, both: Unpacked) -> None:
    def seen(folder: Path) -> dict[str, tuple[Any, ...]]:
        variables = read_model_description(str(folder), validate=False).modelVariables
        return {
            v.name: (v.valueReference, v.causality, v.variability, v.initial, v.unit, v.start, v.min, v.nominal)
            for v in variables
            if not v.name.startswith("solver")
        }

    native, twin = both(name)
    assert seen(twin) == seen(native)
    with Host(twin) as host:
        assert host.description.modelExchange is None
        offered = host.description.coSimulation
        assert not (offered.canInterpolateInputs or offered.canGetAndSetFMUstate or offered.canSerializeFMUstate)
        assert not (offered.providesDirectionalDerivative or offered.maxOutputDerivativeOrder)
        assert host.description.coSimulation.needsExecutionTool
        given = {v.name: float(v.start) for v in host.description.modelVariables if v.start is not None}
        assert host.get(*given) == list(given.values())


def test_derivatives_are_those_of_the_native_fmu(both: Unpacked) -> None:
    rates = []
    for folder in both("load"):
        with Host(folder) as host:
            host.initialize(F_cx=50.0)
            rates.append(host.get(*(name for name in host.reference if name.startswith("der("))))
    np.testing.assert_allclose(rates[0], rates[1], rtol=1e-9, atol=1e-9)  # rounding of a dense solve


@pytest.mark.parametrize("name", NAMES)
def test_checkers_find_nothing(
    name: str, both: Unpacked, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = both(name)[1].with_suffix(".fmu")
    assert validate_fmu(str(path)) == []
    assert second_checker(path, monkeypatch, caplog) == []


MISTAKES: dict[str, tuple[Callable[[Host], object], str]] = {
    "mass": (lambda host: host.set(m_c=-1.0), "a number above 0 is expected"),
    "damping": (lambda host: host.set(c_m1=-1.0), "a number of 0 or more is expected"),
    "no number": (lambda host: host.set(u_m1=float("nan")), "a finite number is expected"),
    "output": (lambda host: host.set(x_c=1.0), "it is calculated and cannot be set"),
    "too late": (lambda host: host.initialize().set(M_1=1.0), "are fixed once initialization has ended"),
    "tolerance": (lambda host: host.enter_initialization(tolerance=-1.0), "a number above 0 is expected"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_both_refuse_the_same_mistakes_in_the_same_words(mistake: str, both: Unpacked) -> None:
    make, says = MISTAKES[mistake]
    for folder, status in zip(both("load"), (3, 4), strict=True):  # fmi2Error; pythonfmu knows only fmi2Fatal
        with Host(folder) as host:
            with pytest.raises(FMICallException) as refused:
                make(host)
            assert refused.value.status == status
            assert says in host.messages[-1]


def test_a_refusal_leaves_the_process_sound(both: Unpacked) -> None:
    """pythonfmu gives up its references twice after an error: unless the twin adds some, memory is freed in use."""
    folder = both("load")[1]

    def references() -> int:
        gc.collect()
        return sys.getrefcount(sys.modules["twin_load"].Twin)

    def refused() -> None:
        with Host(folder) as host, pytest.raises(FMICallException):
            host.set(m_c=-1.0)

    refused()
    before = references()
    for _ in range(20):
        refused()
    assert references() == before


def test_a_step_that_cannot_be_done_is_discarded_and_the_state_stays(both: Unpacked) -> None:
    with Host(both("load")[1]) as host:
        host.initialize()
        start = host.get("x_c", "y_m1")
        for force, length, says in ((1e200, 0.1, "The reference integration ended"), (0.0, 0.0, "communication step")):
            host.set(F_cx=force)
            with pytest.raises(FMICallException) as discarded:
                host.step(0.0, length)
            assert discarded.value.status == 2  # fmi2Discard
            assert says in host.messages[-1]
        assert host.get("x_c", "y_m1") == start
        host.step(0.0, 0.1)
        assert host.get("x_c", "y_m1") != start


def test_reset_goes_back_to_the_start(both: Unpacked) -> None:
    with Host(both("load")[1]) as host:
        start = host.get(*host.reference)
        host.initialize(m_c=90.0, u_m1=50.0).step(0.0, 0.1)
        host.fmu.reset()
        assert host.get(*host.reference) == start


# --- building and running ---


def test_two_builds_are_the_same_to_the_byte_and_leave_no_trace(tmp_path: Path) -> None:
    path, modules = sys.path.copy(), set(sys.modules)
    first = build_twin(small_scene("air"), tmp_path / "a.fmu")
    assert build_twin(small_scene("air"), tmp_path / "b.fmu").read_bytes() == first.read_bytes()
    assert sys.path == path
    assert {name for name in set(sys.modules) - modules if name.startswith("twin")} == set()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.fmu", "b.fmu"]


def test_members(tmp_path: Path) -> None:
    with zipfile.ZipFile(build_twin(small_scene("load-volume"), tmp_path / "x.fmu")) as archive:
        names = archive.namelist()
        assert archive.read("resources/load-volume.toml").decode() == SCENES["load-volume"]
        assert archive.read("resources/slavemodule.txt") == b"twin_load_volume"
        page = archive.read("documentation/index.html").decode()
    assert {"binaries/linux64/load_volume.so", "documentation/licenses/license.txt"} < set(names)
    assert "FMI 2.0, Co-Simulation." in page and "Twin for checking" in page
    assert "solver.steps" not in page and "Model Exchange" not in page
    assert not any("__pycache__" in name for name in names)


def test_the_package_carries_the_present_script() -> None:
    """If not: python fmu_src/toolchain.py."""
    script = Path(__file__).parents[2] / "fmu_src" / "partners" / "twin.py"
    assert (files("cablefmu") / "binaries" / "partners" / "twin.py").read_bytes() == script.read_bytes()


@pytest.fixture
def wavy(tmp_path: Path) -> Path:
    """A scene with a force from a file in a folder below it."""
    scene = tmp_path / "wavy.toml"
    force = '{ signal = "sine", amplitude = 800, frequency = 0.5 }'
    scene.write_text(SCENES["load"].replace(force, '{ signal = "csv", file = "waves/heave.csv" }'))
    (tmp_path / "waves").mkdir()
    (tmp_path / "waves" / "heave.csv").write_text("0,0\n0.7,500\n2,-200\n")
    return scene


def test_files_that_a_scene_names_travel_with_it(wavy: Path, tmp_path: Path) -> None:
    path = cablefmu.build_twin(wavy, tmp_path / "x.fmu")
    wavy.unlink()
    result = cablefmu.simulate(path, stop_time=0.2, record=["u_m1"])
    np.testing.assert_allclose(result["u_m1"].values, [0.0, 500.0 / 7.0, 1000.0 / 7.0])


def test_a_run_holds_forces_in_the_middle_of_a_step(tmp_path: Path) -> None:
    """Against the native FMU, which follows them: an error of second order, so a quarter at half the step."""
    path = build_twin(small_scene("load"), tmp_path / "x.fmu")
    errors = []
    for step in (0.1, 0.05):
        runs = [cablefmu.simulate(what, step=step, tolerance=TOLERANCE) for what in (path, small_scene("load"))]
        errors.append(float(np.max(np.abs(runs[0]["y_m1"].values - runs[1]["y_m1"].values))))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_a_twin_of_a_pinned_cable_stays_on_its_pin(tmp_path: Path) -> None:
    text = SCENES["anchor-mass"].replace('"anchor-mass"\nmass = 1e4', '"pin"')
    result = cablefmu.simulate(build_twin(Scene.from_text(text, name="pinned"), tmp_path / "x.fmu"), tolerance=1e-9)
    assert np.ptp(result["y_m1"].values) > 0.1
    assert np.max(np.abs(result["x_c"].values - 12.0)) < 1e-7  # m
    assert np.max(np.abs(result["y_c"].values - 13.0)) < 1e-7


def test_what_a_twin_cannot_do(tmp_path: Path, both: Unpacked) -> None:
    path = both("load")[1].with_suffix(".fmu")
    with pytest.raises(FmuError, match="the FMU offers no interface me"):
        cablefmu.simulate(path, interface="me")
    with pytest.raises(SceneError, match='no scene "free" ships'):
        build_twin("free", tmp_path / "x.fmu")
    with pytest.raises(OptionError, match="is a folder, a file name is expected"):
        build_twin("free-12-air", tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_twin_has_no_solver_to_choose_and_seeks_no_equilibrium(tmp_path: Path, both: Unpacked) -> None:
    path = both("load")[1].with_suffix(".fmu")
    with pytest.raises(OptionError, match="set solver: there is no such variable"):
        cablefmu.simulate(path, parameters={"solver": "implicit"})
    with pytest.raises(OptionError, match=r"record solver\.steps: there is no such variable"):
        cablefmu.simulate(path, record=["solver.steps"])
    with pytest.raises(SceneError, match=r'load: run.initial = "equilibrium": a twin starts from the shape'):
        build_twin(from_equilibrium(small_scene("load")), tmp_path / "x.fmu")
    assert list(tmp_path.iterdir()) == []


def test_a_twin_of_another_version_is_not_run(tmp_path: Path) -> None:
    (tmp_path / "twin.json").write_text(json.dumps({"cablefmu": "0.0.1", "scene": "load"}))
    with pytest.raises(FmuError, match=r"was built by cablefmu 0\.0\.1, installed is"):
        scene_of_twin(tmp_path)
