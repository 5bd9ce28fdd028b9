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

__all__ = ["MACHINES", "Machine", "Run", "run_of", "wine"]

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

    def run(self, run: Run, folder: Path, *, location: str | None = None, library: Path | None = None) -> Floats:
        """All outputs at every communication point, shape (steps + 1, outputs).

        Parameters
        ----------
        folder
            Of the host and its files.
        location
            What the FMU is told of its resources, in place of their path.
        library
            In place of the one that the package carries.
        """
        for program in self.runner[:1]:
            assert shutil.which(program), f"{program} is missing: apt-get install {self.package}"
        script, result = folder / "script", folder / f"result-{self.platform}"
        script.write_bytes(run.script(location or str(run.resources)))
        named = {
            "HOST_LIBRARY": library or self.library, "HOST_TOKEN": run.token, "HOST_SCRIPT": script,
            "HOST_RESULT": result,
        }  # fmt: skip
        environment = {**os.environ, **wine(folder), **{name: str(value) for name, value in named.items()}}
        command = [*self.runner, str(self.host(folder))]
        done = subprocess.run(command, env=environment, capture_output=True, timeout=300)
        content = result.read_bytes() if result.exists() else b""
        said = content.decode(errors="replace")[:1000] + done.stderr.decode(errors="replace")
        assert done.returncode == 0, f"{self.platform}: {said}"
        return np.frombuffer(content).reshape(run.steps + 1, -1)


def wine(folder: Path) -> dict[str, str]:
    """Wine's environment: silent, without windows, its own files in `folder`, and file names in UTF-8."""
    return {
        "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml=", "WINEPREFIX": str(folder / "wine"),
        "LC_ALL": "C.UTF-8",
    }  # fmt: skip


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

    fmi: int
    resources: Path
    token: str
    names: tuple[str, ...]
    """Of the outputs"""
    references: tuple[int, ...]
    """Of inputs, then outputs"""
    solver: tuple[int, int]
    """Its value, and its reference"""
    step: float
    """[s]"""
    forces: Floats
    """Held over each communication step, shape (steps, inputs) [N]"""

    @property
    def steps(self) -> int:
        """How many communication steps."""
        return len(self.forces)

    def script(self, location: str) -> bytes:
        """What host.c reads."""
        numbers = (self.fmi, self.forces.shape[1], len(self.names), self.steps, *self.solver)
        header = struct.pack("<6i2d1024s", *numbers, self.step, 1e-6, location.encode())
        return header + np.array(self.references, dtype=np.uint32).tobytes() + self.forces.tobytes()


@cache
def run_of(scene: Scene, folder: Path, solver: int, stop: float, step: float, fmi: int = 2) -> Run:
    """The scene's run with its own inputs, held over every communication step, its FMU unpacked in `folder`."""
    unpacked = Path(extract(str(build_fmu(scene, folder / "scene.fmu", fmi=fmi)), unzipdir=str(folder / "fmu")))
    description = read_model_description(str(unpacked))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    inputs = scene.cable.inputs
    outputs = tuple(v.name for v in description.modelVariables if v.causality == "output")
    forces = np.array([[scene.signals[name](k * step) for name in inputs] for k in range(round(stop / step))])
    token = description.guid or description.instantiationToken
    references = tuple(reference[name] for name in (*inputs, *outputs))
    return Run(fmi, unpacked / "resources", token, outputs, references, (solver, reference["solver"]), step, forces)
