"""A sea's archive: what is in it, what its description says, and that it is built without a trace."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.model_description import ModelDescription
from fmpy.validation import validate_fmu

from cablefmu import OptionError, Waves, WavesError, build_waves
from cablefmu.fmu.python_slave import partner_script
from tests.fmu.test_archive import second_checker

POINTS = [{"x": 1.0, "y": 2.0}, {"x": 3.0}]
AIRY = {"kind": "airy", "height": 2.0, "period": 8.0, "points": POINTS}
FENTON = AIRY | {"kind": "fenton", "outputs": ["velocity"]}
SEA = {"kind": "jonswap", "significant_height": 3.0, "peak_period": 9.0, "duration": 200.0}
ALL = {"outputs": ["elevation", "velocity", "acceleration"]}


def described(table: dict[str, object], folder: Path) -> ModelDescription:
    return read_model_description(str(build_waves(table, folder / "x.fmu")))


def of(description: ModelDescription, causality: str) -> dict[str, str]:
    return {v.name: v.unit for v in description.modelVariables if v.causality == causality}


def test_there_is_what_was_asked_for_and_nothing_else(tmp_path: Path) -> None:
    regular, irregular = {"ramp": "s", "phase": "rad"}, {"ramp": "s", "significant_height": "m", "seed": "1"}
    velocity = {"vx": "m/s", "vy": "m/s"}
    every = {"elevation": "m"} | velocity | {"ax": "m/s2", "ay": "m/s2"}
    for table, parameters, outputs, points in (
        (AIRY, regular | {"height": "m"}, {"elevation": "m"}, 2), (FENTON, regular, velocity, 2),
        (SEA | ALL, irregular, every, 1), (SEA | {"kind": "pierson-moskowitz"}, irregular, {"elevation": "m"}, 1),
    ):  # fmt: skip
        description = described(table, tmp_path)
        assert of(description, "parameter") == parameters
        assert of(description, "output") == {f"{n}[{k}]": u for k in range(1, points + 1) for n, u in outputs.items()}
        assert len(description.modelVariables) == len(parameters) + points * len(outputs)
        for variable in description.modelVariables:
            assert variable.description.endswith("; x right, y down")
        for output in description.outputs:
            assert output.dependencies == []


def test_signs_and_places_are_said(tmp_path: Path) -> None:
    said = {v.name: v.description for v in described(AIRY | ALL, tmp_path).modelVariables}
    assert said["elevation[2]"].startswith("Elevation of the surface, positive UP, at x = 3 m, y = 0 m")
    assert said["vy[1]"].startswith("Orbital velocity of the water along y, positive down, at x = 1 m, y = 2 m")


def test_what_is_offered(tmp_path: Path) -> None:
    description = described(SEA, tmp_path)
    offered = description.coSimulation
    assert description.modelExchange is None and description.defaultExperiment is None
    assert offered.canGetAndSetFMUstate and offered.canSerializeFMUstate and offered.needsExecutionTool
    assert offered.canHandleVariableCommunicationStepSize and not offered.canBeInstantiatedOnlyOncePerProcess
    assert not (offered.canInterpolateInputs or offered.providesDirectionalDerivative)


def test_limits_of_parameters_are_said(tmp_path: Path) -> None:
    """Beyond them the FMU refuses, and that is its end: hosts must be able to know."""
    by_name = {v.name: v for v in described(AIRY, tmp_path).modelVariables}
    assert float(by_name["height"].max) == pytest.approx(0.142 * 9.81 * 64.0 / (2.0 * np.pi), rel=1e-12)
    assert (float(by_name["phase"].min), float(by_name["phase"].max)) == (-2.0 * np.pi, 2.0 * np.pi)
    assert (by_name["height"].min, by_name["ramp"].min) == ("0.0", "0.0")


def test_no_sources_are_promised(tmp_path: Path) -> None:
    """Such a file would be one of sources/, and there is none in a script's FMU."""
    with zipfile.ZipFile(build_waves(AIRY, tmp_path / "x.fmu")) as archive:
        assert b"SourceFiles" not in archive.read("modelDescription.xml")
        assert not any(name.startswith("sources/") for name in archive.namelist())


@pytest.mark.parametrize("table", [AIRY | ALL, FENTON, SEA], ids=["airy", "fenton", "jonswap"])
def test_checkers_find_nothing(
    table: dict[str, object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = build_waves(table, tmp_path / "x.fmu")
    assert validate_fmu(str(path)) == []
    assert second_checker(path, monkeypatch, caplog) == []


def test_two_builds_are_the_same_to_the_byte_and_leave_no_trace(tmp_path: Path) -> None:
    build_waves(SEA, tmp_path / "a.fmu")  # imports what it needs
    path, modules = sys.path.copy(), set(sys.modules)
    first = build_waves(SEA, tmp_path / "a.fmu")
    assert build_waves(SEA, tmp_path / "b.fmu").read_bytes() == first.read_bytes()
    assert build_waves(SEA | {"seed": 2}, tmp_path / "c.fmu").read_bytes() != first.read_bytes()
    assert sys.path == path and set(sys.modules) == modules
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.fmu", "b.fmu", "c.fmu"]


def test_members(tmp_path: Path) -> None:
    sea = Waves.from_table(SEA | {"points": POINTS} | ALL, name="storm 7")
    with zipfile.ZipFile(build_waves(sea, tmp_path / "x.fmu")) as archive:
        names = archive.namelist()
        module = archive.read("resources/slavemodule.txt").decode()
        assert archive.read(f"resources/{module}.py") == partner_script("waves")
        about = json.loads(archive.read("resources/waves.json"))
        with archive.open("resources/series.npy") as file:
            series = np.load(file, allow_pickle=False)
    assert {"binaries/linux64/storm_7.so", "documentation/licenses/license.txt"} < set(names)
    assert about["identifier"] == "storm_7" and about["period"] == 200.0
    assert series.shape == (6, 2, len(sea.train.k))  # acceleration is velocity's derivative
    assert not any("__pycache__" in name for name in names)


def test_the_package_carries_the_present_script() -> None:
    """If not: python fmu_src/toolchain.py."""
    script = Path(__file__).parents[2] / "fmu_src" / "partners" / "waves.py"
    assert partner_script("waves") == script.read_bytes()


def test_a_host_needs_numpy_alone(tmp_path: Path) -> None:
    """In a process whose Python refuses to import this package, scipy, and what found the waves."""
    path = build_waves(FENTON | {"outputs": ["elevation"]}, tmp_path / "x.fmu")
    program = (
        "import sys; sys.modules.update(dict.fromkeys(['cablefmu', 'scipy', 'raschii', 'wavespectra']))\n"
        "import fmpy; rows = fmpy.simulate_fmu(sys.argv[1], stop_time=16.0, output_interval=8.0)\n"
        "print(len(rows), abs(rows['elevation[1]'][2] - rows['elevation[1]'][0]) < 1e-12)"
    )
    environment = os.environ | {"PYTHONPATH": ""}
    command = [sys.executable, "-c", program, str(path)]
    ran = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "3 True\n", "")


def test_the_default_place_is_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert build_waves(Waves.from_table(AIRY, name="swell")) == Path("build/swell.fmu")
    assert Path("build/swell.fmu").is_file()


def test_mistakes_build_nothing(tmp_path: Path) -> None:
    with pytest.raises(WavesError, match="this key is missing"):
        build_waves({"kind": "airy"}, tmp_path / "x.fmu")
    for name in ("", "a\nb"):
        with pytest.raises(OptionError, match="a name of one line is expected for a sea"):
            build_waves(Waves.from_table(AIRY, name=name), tmp_path / "x.fmu")
    with pytest.raises(OptionError, match="is a folder"):
        build_waves(AIRY, tmp_path)
    assert list(tmp_path.iterdir()) == []
