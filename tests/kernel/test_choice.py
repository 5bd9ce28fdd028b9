"""The automatic choice costs little more than the cheaper method, whatever the scene.

Costs are counted, not timed (`motions.work`), so that they are the same on every machine; `tests.benchmarks.automatic`
has the times.
"""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from cablefmu.cable import Cable, SolverChoice, Terminal
from cablefmu.scene import load_scene, shipped_scenes
from tests.kernel.library import Kernel, Run, Wave
from tests.kernel.motions import SOLVERS, make_scene, waves_of, work
from tests.kernel.random_scenes import COUNT, random_scene

AUTOMATIC, EXPLICIT, IMPLICIT = SOLVERS
Works = dict[SolverChoice, float]


def last(
    library: ctypes.CDLL, cable: Cable, solver: SolverChoice, waves: dict[str, Wave], *, span: float, tolerance: float
) -> Run:
    """The end of a run in communication steps of 0.1 s."""
    times = 0.1 * np.arange(round(10.0 * span) + 1.0)
    run = Kernel(library, cable).run(times, tolerance=tolerance, waves=waves, solver=solver)[-1]
    assert run.status == "ok" and run.time == times[-1]
    return run


@pytest.fixture(scope="module")
def random_works(library: ctypes.CDLL) -> list[Works]:
    """What ten seconds of each random scene cost."""
    scenes = (random_scene(number) for number in range(COUNT))
    return [
        {s: work(last(library, scene.cable, s, waves, span=10.0, tolerance=1e-6)) for s in SOLVERS}
        for scene, waves in scenes
    ]


@pytest.mark.parametrize("number", range(COUNT))
def test_a_scene_that_nobody_looked_at_before(random_works: list[Works], number: int) -> None:
    """Measured: 1.16 times the cheaper method at worst, 0.53 at best."""
    works = random_works[number]
    assert works[AUTOMATIC] < 1.5 * min(works[EXPLICIT], works[IMPLICIT])


def test_each_method_is_the_cheaper_one_of_some_random_scenes(random_works: list[Works]) -> None:
    """So that neither of them alone would pass."""
    ratios = np.array([works[EXPLICIT] / works[IMPLICIT] for works in random_works])
    assert np.sum(ratios > 1.5) >= 3 and np.sum(ratios < 1 / 1.5) >= 3
    assert ratios.max() > 10.0  # and the dearer one by far


@pytest.mark.parametrize("name", shipped_scenes())
def test_shipped_scenes_cost_what_they_did(library: ctypes.CDLL, name: str) -> None:
    """None is stiff, so that the explicit method is the cheaper one: looks and trials cost up to 9 per cent."""
    scene = load_scene(name)
    works = {
        s: work(last(library, scene.cable, s, waves_of(scene), span=scene.stop_time, tolerance=scene.tolerance))
        for s in SOLVERS
    }
    assert works[EXPLICIT] < works[IMPLICIT]
    assert works[AUTOMATIC] < 1.12 * works[EXPLICIT]


def share_of_implicit(run: Run) -> float:
    return run.counters["jacobians"] / (run.counters["steps"] + run.counters["rejected"])


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize(("links", "bending"), [(60, 1e7), (120, 1e6), (240, 1e5), (240, 1e7)])
def test_a_stiff_cable_is_pulled_aside(library: ctypes.CDLL, links: int, bending: float, tolerance: float) -> None:
    """Explicit steps would be 0.1 to 2 ms, for a motion that takes seconds; at 1e-6 some must follow the vibrations.

    Measured: 1.56 times the cheaper method at worst (60 links, 1e-4), 2 to 50 times cheaper than the explicit one
    where the implicit one is.
    """
    cable, pull = make_scene(Terminal.LOAD, links, bending=bending, angle=0.0).cable, {"F_cx": (200.0, 0.0, 0.0)}
    works = {s: work(last(library, cable, s, pull, span=5.0, tolerance=tolerance)) for s in SOLVERS}
    assert works[AUTOMATIC] < 1.7 * min(works[EXPLICIT], works[IMPLICIT])
    if works[IMPLICIT] < 0.5 * works[EXPLICIT]:
        assert works[AUTOMATIC] < 0.5 * works[EXPLICIT]


def test_a_fast_motion_is_followed_by_the_cheaper_method(library: ctypes.CDLL) -> None:
    """Bending of 1e7 N m^2 released at 30 degrees against the root's spring: what is fast is the motion itself.

    Joints hardly damp it, so both methods must follow it, and the explicit one does so at a third of the work.
    """
    cable = make_scene(Terminal.LOAD, 60, bending=1e7, angle=np.pi / 6).cable
    runs = {s: last(library, cable, s, {}, span=2.0, tolerance=1e-6) for s in SOLVERS}
    works = {s: work(run) for s, run in runs.items()}
    assert works[EXPLICIT] < 0.5 * works[IMPLICIT]
    assert works[AUTOMATIC] < 1.1 * works[EXPLICIT]
    assert runs[AUTOMATIC].counters["stiff"] == 0.0


def test_the_choice_follows_the_motion(library: ctypes.CDLL) -> None:
    """A chain as light as a thread that falls from 60 degrees, fast at first, until water has brought it to rest."""
    cable = make_scene(Terminal.LOAD, 120, diameter=0.01, angle=1.0).cable
    kernel = Kernel(library, cable)
    kernel.start(0.0, cable.position, cable.velocity, tolerance=1e-6, solver=AUTOMATIC)
    falling = kernel.advance(5.0, {})
    assert falling.status == "ok" and share_of_implicit(falling) < 0.1
    hanging = kernel.advance(200.0, {})
    assert hanging.status == "ok" and hanging.counters["stiff"] == 1.0
