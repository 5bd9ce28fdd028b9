"""FMPy runs an FMU for Windows alone on Linux: its remoting loads the library under Wine, and passes every call on.

FMI 2, which is all that FMPy's remoting knows.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu, supported_platforms
from fmpy.util import add_remoting

from cablefmu.cable import Floats
from cablefmu.fmu.archive import build_fmu
from tests.platforms.machines import MACHINES, wine

pytestmark = pytest.mark.system  # wine64

SCENES = ("free-12-water", "floaters-loose-80", "seabed-pin-60")
CO_SIMULATION = {"fmi_type": "CoSimulation", "stop_time": 5.0, "output_interval": 0.1}
MODEL_EXCHANGE = {"fmi_type": "ModelExchange", "stop_time": 0.5, "solver": "Euler", "step_size": 0.01}
PORT = 8080
"""The remoting's only one."""


@pytest.fixture
def with_wine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wine's own files, made before the remoting waits for them, and the program that it calls.

    It hands over the server, the library and a file that the client holds locked for as long as it lives. The server
    does not see that lock where it may write to every file, and would end after half a second: it is not told of it,
    and ends with its client or by the clock.
    """
    (loader,) = next(machine for machine in MACHINES if machine.platform.endswith("windows")).runner
    assert shutil.which(loader), f"{loader} is missing: apt-get install wine64"
    program = tmp_path / "bin" / "wine64"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec timeout --foreground 300 {loader} "$1" "$2"\n')
    program.chmod(0o755)
    for name, value in wine(tmp_path).items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("PATH", str(program.parent), prepend=os.pathsep)
    # not through pipes, which Wine's own server would hold open
    command = ["wine64", "wineboot", "--init"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def remoted(path: Path, folder: Path) -> Path:
    """The FMU for Windows in `folder`, with the remoting's client as its library for Linux."""
    extract(str(path), unzipdir=str(folder))
    assert {"win64", "linux64"}.intersection(supported_platforms(str(folder))) == {"win64"}
    add_remoting(str(folder), "linux64", "win64")
    (client,) = (folder / "binaries" / "linux64").iterdir()
    ctypes.CDLL(str(client))  # held: FMPy unloads it after a run, and a thread of the client's may still be in it
    return folder


def wait_for_the_port() -> None:
    for _ in range(100):
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", PORT)) != 0:
                return
        time.sleep(0.1)
    pytest.fail(f"something else listens on port {PORT}, which FMPy's remoting needs")


def columns(path: Path, how: dict[str, Any]) -> dict[str, Floats]:
    """Every output at every time, by name; the FMU's own start values are its inputs."""
    result = simulate_fmu(str(path), **how)
    return {name: np.ascontiguousarray(result[name]) for name in result.dtype.names}


@pytest.mark.usefixtures("with_wine")
def test_remoting_gives_the_native_bits(tmp_path: Path) -> None:
    """One run after the other, for there is one port."""
    for scene in SCENES:
        native = build_fmu(scene, tmp_path / "native.fmu", platforms=["x86_64-linux"])
        remote = remoted(build_fmu(scene, tmp_path / "remote.fmu", platforms=["x86_64-windows"]), tmp_path / scene)
        outputs = {v.name for v in read_model_description(str(native)).modelVariables if v.causality == "output"}
        for how in (CO_SIMULATION, MODEL_EXCHANGE):
            wait_for_the_port()  # or the server of another run would answer
            expected, found = columns(native, how), columns(remote, how)
            assert found.keys() == expected.keys() == outputs | {"time"}
            assert found["energy"][-1] != found["energy"][0]
            assert [name for name in outputs if found[name].tobytes() != expected[name].tobytes()] == [], scene
