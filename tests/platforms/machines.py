"""A small host on every machine that can be run here, and what of a run it needs."""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description

from cablefmu.cable import Floats
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.platforms import library
from cablefmu.scene import Scene
from tests.kernel.library import ROOT, toolchain

__all__ = ["MACHINES", "Machine", "Run", "run_of"]

HOST = ROOT / "tests" / "platforms" / "host.c"


@dataclass(frozen=True)
class Machine:
    """A platform and how its programs are run here."""

    platform: str
    """FMI 3 platform tuple"""
    runner: tuple[str, ...]
    """In front of the program; empty for our own"""
    package: str
    """Debian's, where the runner is missing"""

    @property
    def library(self) -> Path:
        """The FMU's library, as the package carries it."""
        return Path(str(library("cable", self.platform)))

    def host(self, folder: Path) -> Path:
        """The host, compiled into `folder`."""
        path = folder / f"host-{self.platform}.exe"
        if not path.exists():
            toolchain().build_program(path, HOST, self.platform)
        return path

    def run(self, run: Run, folder: Path, library: Path | None = None) -> Floats:
        """All outputs at every communication point, shape (steps + 1, outputs); of another library if one is given."""
        for program in self.runner[:1]:
            assert shutil.which(program), f"{program} is missing: apt-get install {self.package}"
        script, result = folder / "script", folder / f"result-{self.platform}"
        script.write_bytes(run.script)
        named = {
            "HOST_LIBRARY": library or self.library, "HOST_RESOURCES": run.resources, "HOST_TOKEN": run.token,
            "HOST_SCRIPT": script, "HOST_RESULT": result,
        }  # fmt: skip
        quiet = {"WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml=", "WINEPREFIX": str(folder / "wine")}
        environment = {**os.environ, **quiet, **{name: str(value) for name, value in named.items()}}
        command = [*self.runner, str(self.host(folder))]
        done = subprocess.run(command, env=environment, capture_output=True, timeout=300)
        content = result.read_bytes() if result.exists() else b""
        assert done.returncode == 0, f"{self.platform}: {content!r} {done.stderr.decode(errors='replace')}"
        return np.frombuffer(content).reshape(run.steps + 1, -1)


MACHINES = (
    Machine("x86_64-linux", (), ""),
    Machine("x86_64-windows", ("/usr/lib/wine/wine64",), "wine64"),
    Machine(
        "aarch64-linux", ("qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"),
        "qemu-user-static libc6-arm64-cross",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Run:
    """What a host is told."""

    resources: Path
    token: str
    script: bytes
    steps: int
    names: tuple[str, ...]
    """Of the outputs"""


@cache
def run_of(scene: Scene, folder: Path, solver: int, stop: float, step: float) -> Run:
    """The scene's run with its own inputs, held over every communication step."""
    unpacked = Path(extract(str(build_fmu(scene, folder / "scene.fmu")), unzipdir=str(folder / "fmu")))
    description = read_model_description(str(unpacked))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    inputs = scene.cable.inputs
    outputs = tuple(v.name for v in description.modelVariables if v.causality == "output")
    steps = round(stop / step)
    forces = np.array([[scene.signals[name](k * step) for name in inputs] for k in range(steps)])
    numbers = [len(inputs), len(outputs), steps, solver, reference["solver"], 0]
    script = struct.pack("<6i2d", *numbers, step, 1e-6)
    script += np.array([reference[name] for name in (*inputs, *outputs)], dtype=np.uint32).tobytes() + forces.tobytes()
    return Run(unpacked / "resources", description.guid, script, steps, outputs)
