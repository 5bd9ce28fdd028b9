"""FMUs in folders whose names are not ASCII: FMI 2 gives a URI, FMI 3 a path in UTF-8; Windows wants UTF-16."""

from __future__ import annotations

from pathlib import Path, PureWindowsPath

import pytest

from cablefmu.scene import load_scene
from tests.platforms.machines import MACHINES, Machine, run_of

pytestmark = pytest.mark.system  # wine64, qemu-user-static

NAME = "Kabel ä %20 кабель 海底 \U0001d11e"
"""Characters of one to four bytes, the last two units in UTF-16; a blank, and what a URI must not decode twice."""
SCENE, EXPLICIT, STOP, STEP = "angles-12-water", 2, 0.5, 0.1


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of programs and of Wine's own files, which are made once."""
    return tmp_path_factory.mktemp("machines")


def location_of(resources: Path, fmi: int, machine: Machine) -> str:
    """As a host on that machine writes it; Wine has our files on drive Z."""
    if not machine.platform.endswith("windows"):
        return resources.as_uri() if fmi == 2 else f"{resources}/"
    path = PureWindowsPath("Z:" + str(resources))
    return path.as_uri() if fmi == 2 else f"{path}\\"


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.platform)
def test_a_name_in_any_script(machine: Machine, fmi: int, folder: Path, tmp_path: Path) -> None:
    run = run_of(load_scene(SCENE), tmp_path / NAME, EXPLICIT, STOP, STEP, fmi)
    plain = run_of(load_scene(SCENE), tmp_path / "plain", EXPLICIT, STOP, STEP, 2)
    location = location_of(run.resources, fmi, machine)
    assert location.isascii() == (fmi == 2)
    assert NAME in str(run.resources) and NAME not in str(plain.resources)
    expected, found = MACHINES[0].run(plain, folder), machine.run(run, folder, location=location)
    assert run.names == plain.names and found[-1, 0] != found[0, 0]
    assert found.tobytes() == expected.tobytes()


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.platform)
def test_a_folder_that_is_not_there_is_named_in_the_refusal(machine: Machine, folder: Path, tmp_path: Path) -> None:
    run = run_of(load_scene(SCENE), tmp_path, EXPLICIT, STOP, STEP, 3)
    gone = location_of(tmp_path / NAME, 3, machine)
    with pytest.raises(AssertionError, match=r"resource file .*Kabel ä %20 кабель 海底 \U0001d11e"):
        machine.run(run, folder, location=gone)
