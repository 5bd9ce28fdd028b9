"""The promise of the default setting, on every scene that ships."""

from __future__ import annotations

import pytest

from cablefmu.report import ACCURACY
from cablefmu.report_ladder import DEFAULT
from cablefmu.report_reference import trusted
from cablefmu.report_runs import apart, fmu_runs, is_measured, whole
from cablefmu.scene import load_scene, shipped_scenes

QUICK = ("timing-20", "free-12-water")
"""Seconds; the dense reference of the others takes up to half a minute."""

CHAOTIC = ("load-lift-80",)

MEASURED = [name for name in shipped_scenes() if is_measured(load_scene(name))]

BUDGET, SMALL = 30.0, 60
"""CPU time [s] that the dense reference may take; up to so many links it must be there, beyond it may be too slow."""


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in MEASURED]
)
def test_the_default_setting_is_within_a_tenth_of_a_millimetre_up_to_the_horizon(name: str) -> None:
    """Of a reference that two solvers on two right-hand sides agree on a thousand times better (chaos: ten times)."""
    solver, tolerance = DEFAULT
    scene = load_scene(name)
    with fmu_runs(whole(scene)) as runs:
        reference = trusted(runs, ACCURACY, BUDGET)
        default = runs.run(tolerance=tolerance, solver=solver)
    assert reference.is_independent or scene.cable.n > SMALL
    assert reference.horizon.is_chaotic == (name in CHAOTIC)
    assert reference.difference.position < (0.1 if name in CHAOTIC else 1e-3) * ACCURACY
    assert apart(default, reference.course, reference.horizon.time).position < ACCURACY
