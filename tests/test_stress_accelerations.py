"""The FMU's accelerations beside the dense equation: they agree, and whatever is changed in one of the two is found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from cablefmu.fmu.archive import build_fmu
from cablefmu.scene import Scene
from cablefmu.stress_accelerations import acceleration_share
from cablefmu.stress_grid import grid
from tests.test_stress_run import case_of

HARD = (
    "load-1e12-hanging",
    "unequal-short-first",
    "unequal-heavy-and-light",
    "equilibrium-spring-k-1e10",
    "mooring-k-1e10",
    "unequal-pinned",
)
"""The heaviest end, a link of 4 mm above 240 m, masses of 1 : 1,000,000, rest against the stiffest springs."""


def share(scene: Scene, folder: Path, *, fmi: int = 2, model: Scene | None = None) -> float:
    """Of a scene's FMU, compared with the dense equation of the same scene, or of another."""
    fmu = build_fmu(scene, folder / f"{scene.name}-{fmi}.fmu", fmi=fmi)
    return acceleration_share(model or scene, fmu)


@pytest.mark.parametrize("fmi", [2, 3])
def test_they_agree(fmi: int, tmp_path: Path) -> None:
    scene = case_of("cable.links = 5").scene()
    # measured: 1.5e-4
    assert share(scene, tmp_path, fmi=fmi) < 1e-2


@pytest.mark.parametrize("name", HARD)
def test_they_agree_where_it_is_hard(name: str, tmp_path: Path) -> None:
    (case,) = [case for case in grid() if case.name == name]
    assert share(case.scene(), tmp_path, fmi=case.fmi) < 0.5


@pytest.mark.parametrize(
    "change",
    ["water.Cd = 1.000001", "cable.joint_damping = 2.801", "top.damping = 237.601", "terminal.mass = 60.0001"],
)
def test_a_small_change_is_found(change: str, tmp_path: Path) -> None:
    """Millionths of drag, floater and load; of the joints' damping, which does little here, thousandths."""
    fixed = "cable.links = 5, water.Cd = 1, cable.joint_damping = 2.8, top.damping = 237.6, terminal.mass = 60"
    scene = case_of(fixed).scene()
    name = change.partition(" = ")[0]
    kept = ", ".join(part for part in fixed.split(", ") if not part.startswith(name))
    other = replace(case_of(f"{kept}, {change}").scene(), name="other")
    assert share(scene, tmp_path) < 1e-2
    assert share(other, tmp_path, model=scene) > 100.0  # measured: 200 to 24,000
