"""A vessel's archive: what is in it, what its description says, and that it is built without a trace."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description
from fmpy.model_description import ModelDescription
from fmpy.validation import validate_fmu

from cablefmu import OptionError, Vessel, VesselError, build_vessel
from cablefmu.fmu.python_slave import partner_script
from tests.fmu.test_archive import second_checker

BODY = {"kind": "body", "m_x": 2e5, "m_y": 3e5}
SINES = {"kind": "sines", "x": {"amplitude": 1.0, "period": 8.0}}

MOTION = {"x": "m", "y": "m", "vx": "m/s", "vy": "m/s", "ax": "m/s2", "ay": "m/s2"}
OF_AN_AXIS = {"m": "kg", "c": "N.s/m", "k": "N/m", "external": "N", "static_load": "N"}
OF_A_BODY = {f"{name}_{axis}": unit for axis in "xy" for name, unit in OF_AN_AXIS.items()} | {
    "x_0": "m", "y_0": "m", "vx_0": "m/s", "vy_0": "m/s"
}  # fmt: skip


@pytest.fixture
def csv(tmp_path: Path) -> dict[str, object]:
    (tmp_path / "m.csv").write_text("time,x,y\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n")
    return {"kind": "csv", "file": str(tmp_path / "m.csv")}


def described(table: object, folder: Path) -> ModelDescription:
    return read_model_description(str(build_vessel(Vessel.from_table(table), folder / "x.fmu")))


def of(description: ModelDescription, causality: str) -> dict[str, str]:
    return {v.name: v.unit for v in description.modelVariables if v.causality == causality}


def test_every_kind_has_its_own_variables_and_no_others(tmp_path: Path, csv: dict[str, object]) -> None:
    forces = {"F_x": "N", "F_y": "N"}
    rates = {f"der(F_{axis}{order})": unit for axis in "xy" for order, unit in (("", "N/s"), (",2", "N/s2"))}
    sine = {"sine_x[1].amplitude": "m", "sine_x[1].frequency": "Hz", "sine_x[1].phase": "rad", "ramp": "s"}
    for table, parameters, inputs in (
        (BODY, OF_A_BODY, forces), (BODY | {"extrapolation": "given"}, OF_A_BODY, forces | rates), (SINES, sine, {}),
        (csv, {}, {}),
    ):  # fmt: skip
        description = described(table, tmp_path)
        assert of(description, "parameter") == parameters
        assert of(description, "input") == inputs
        assert of(description, "output") == MOTION
        assert len(description.modelVariables) == len(parameters) + len(inputs) + len(MOTION)
        for variable in description.modelVariables:
            assert variable.description.endswith("; x right, y down")


def test_signs_are_said(tmp_path: Path) -> None:
    said = {v.name: v.description for v in described(BODY, tmp_path).modelVariables}
    assert said["F_y"].startswith("Force that the cable exerts on the vessel along y, positive down")
    assert said["F_x"].startswith("Force that the cable exerts on the vessel along x, positive to the right")
    assert said["ay"].startswith("Acceleration of the fairlead along y, positive down")


def test_only_acceleration_passes_the_force_through(tmp_path: Path, csv: dict[str, object]) -> None:
    passed = {"ax": ["F_x"], "ay": ["F_y"]}
    for table, through in ((BODY | {"extrapolation": "given"}, passed), (SINES, {}), (csv, {})):
        for output in described(table, tmp_path).outputs:
            name = output.variable.name
            assert [variable.name for variable in output.dependencies] == through.get(name, [])


def test_inputs_that_are_derivatives_say_of_what(tmp_path: Path) -> None:
    variables = described(BODY | {"extrapolation": "given"}, tmp_path).modelVariables
    of_what = {v.name: v.derivative.name for v in variables if v.derivative}
    assert of_what == {
        "der(F_x)": "F_x", "der(F_x,2)": "der(F_x)", "der(F_y)": "F_y", "der(F_y,2)": "der(F_y)"
    }  # fmt: skip


def test_what_is_offered(tmp_path: Path) -> None:
    description = described(BODY, tmp_path)
    offered = description.coSimulation
    assert description.modelExchange is None and description.defaultExperiment is None
    assert offered.canGetAndSetFMUstate and offered.canSerializeFMUstate and offered.needsExecutionTool
    assert offered.canHandleVariableCommunicationStepSize and not offered.canBeInstantiatedOnlyOncePerProcess
    assert not (offered.canInterpolateInputs or offered.providesDirectionalDerivative)
    assert not offered.maxOutputDerivativeOrder


@pytest.mark.parametrize("kind", ["body", "given", "sines", "csv"])
def test_checkers_find_nothing(
    kind: str, tmp_path: Path, csv: dict[str, object], monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:  # fmt: skip
    tables = {"body": BODY, "given": BODY | {"extrapolation": "given"}, "sines": SINES, "csv": csv}
    path = build_vessel(tables[kind], tmp_path / "x.fmu")
    assert validate_fmu(str(path)) == []
    assert second_checker(path, monkeypatch, caplog) == []


def test_two_builds_are_the_same_to_the_byte_and_leave_no_trace(tmp_path: Path) -> None:
    path, modules = sys.path.copy(), set(sys.modules)
    first = build_vessel(BODY, tmp_path / "a.fmu")
    assert build_vessel(BODY, tmp_path / "b.fmu").read_bytes() == first.read_bytes()
    assert build_vessel(BODY | {"m_x": 1.0}, tmp_path / "c.fmu").read_bytes() != first.read_bytes()
    assert sys.path == path
    assert {name for name in set(sys.modules) - modules if name.startswith("vessel_")} == set()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.fmu", "b.fmu", "c.fmu"]


def test_members(tmp_path: Path) -> None:
    with zipfile.ZipFile(build_vessel(Vessel.from_table(BODY, name="pipe-layer 7"), tmp_path / "x.fmu")) as archive:
        names = archive.namelist()
        module = archive.read("resources/slavemodule.txt").decode()
        assert archive.read(f"resources/{module}.py") == partner_script("vessel")
        about = json.loads(archive.read("resources/vessel.json"))
    assert {"binaries/linux64/pipe_layer_7.so", "documentation/licenses/license.txt"} < set(names)
    assert about["kind"] == "body" and about["identifier"] == "pipe_layer_7"
    assert not any("__pycache__" in name for name in names)


def test_the_package_carries_the_present_script() -> None:
    """If not: python fmu_src/toolchain.py."""
    script = Path(__file__).parents[2] / "fmu_src" / "partners" / "vessel.py"
    assert partner_script("vessel") == script.read_bytes()


def test_a_host_without_this_package_can_run_it(tmp_path: Path) -> None:
    """In a process whose Python refuses to import cablefmu."""
    path = build_vessel(SINES, tmp_path / "x.fmu")
    program = (
        "import sys; sys.modules['cablefmu'] = None\n"
        "import fmpy; rows = fmpy.simulate_fmu(sys.argv[1], stop_time=4.0, output_interval=1.0)\n"
        "print(len(rows), round(float(rows['x'][2]), 12))"
    )
    environment = os.environ | {"PYTHONPATH": ""}
    command = [sys.executable, "-c", program, str(path)]
    ran = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "5 1.0\n", "")


def test_the_default_place_is_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert build_vessel(Vessel.from_table(SINES, name="tug")) == Path("build/tug.fmu")
    assert Path("build/tug.fmu").is_file()


def test_mistakes_build_nothing(tmp_path: Path) -> None:
    with pytest.raises(VesselError, match="this key is missing"):
        build_vessel({"kind": "body"}, tmp_path / "x.fmu")
    for name in ("", "a\nb"):
        with pytest.raises(OptionError, match="a name of one line is expected for a vessel"):
            build_vessel(Vessel.from_table(SINES, name=name), tmp_path / "x.fmu")
    with pytest.raises(OptionError, match="is a folder"):
        build_vessel(SINES, tmp_path)
    assert list(tmp_path.iterdir()) == []
