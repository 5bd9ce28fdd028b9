"""The same bits on every machine: all outputs and the solver's counters, at every communication point.

Windows' library runs under Wine, aarch64's under qemu; sine, cosine and roots are the kernel's own; nothing is fused.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cablefmu.scene import Scene, load_scene
from tests.platforms.machines import MACHINES, Machine, run_of

pytestmark = pytest.mark.system  # wine64, qemu-user-static

SCENES = ("angles-12-water", "free-12-air", "heave-60-water", "floaters-loose-80", "load-diagonal-80", "seabed-pin-60",
          "seabed-spring-60", "timing-120")  # fmt: skip
"""Air and water, every kind of end; each moves its terminal or its floater by more than a metre."""
SOLVERS = {"automatic": 1, "explicit": 2, "implicit": 3}
STOP, STEP = 2.0, 0.1
"""[s]"""
OURS, *OTHERS = MACHINES


def from_equilibrium() -> Scene:
    """A start that is sought, with what the search says of itself."""
    scene = load_scene("heave-60-water")
    return Scene.from_text(scene.text.replace("[run]\n", '[run]\ninitial = "equilibrium"\n'), name="equilibrium")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of programs and of Wine's own files, which are made once."""
    return tmp_path_factory.mktemp("machines")


@pytest.mark.parametrize("machine", OTHERS, ids=lambda machine: machine.platform)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", [*SCENES, "equilibrium"])
def test_every_output_has_the_same_bits(name: str, solver: str, machine: Machine, folder: Path, tmp_path: Path) -> None:
    scene = from_equilibrium() if name == "equilibrium" else load_scene(name)
    run = run_of(scene, tmp_path, SOLVERS[solver], STOP, STEP)
    expected, found = OURS.run(run, folder), machine.run(run, folder)
    assert "solver.steps" in run.names and "tension_max" in run.names
    assert np.all(np.isfinite(expected)) and np.any(expected[-1] != expected[0])
    for k, output in enumerate(run.names):
        assert found[:, k].tobytes() == expected[:, k].tobytes(), output
