"""The trusted reference: what it is compared with, and where it ends because nothing can be known any more."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.errors import RunError
from cablefmu.report_reference import NUDGE, trusted
from cablefmu.report_runs import FmuRuns, fmu_runs, output_times, whole
from cablefmu.scene import Scene
from tests.fmu_helpers import SCENES, small_scene

CHAOTIC = (
    SCENES["air"]
    .replace("joint_damping = 2.8", "joint_damping = 0")
    .replace("young_modulus = 8e10", "joint_stiffness = 0")
    .replace("angle = 0.5", "angle = 3.0")
    .replace("rotary_inertia = 50\n", "")
    .replace("stop_time = 2", "stop_time = 30")
)
"""Five loose links let go almost upside down: a quintuple pendulum."""


@pytest.mark.parametrize("kind", ["load", "pin", "floater"])
def test_two_solvers_on_two_right_hand_sides_agree(kind: str) -> None:
    """2 s of a 20 m cable; measured 3e-13 to 4e-11 m."""
    with fmu_runs(small_scene(kind)) as runs:
        found = trusted(runs, 1e-4, 60.0)
    assert found.is_independent
    assert "dense NumPy model" in found.checked_by
    assert found.tolerance == 1e-11
    assert 0.0 < found.difference.position < 1e-9
    assert found.difference.tension_relative < 1e-9
    assert (found.horizon.time, found.horizon.is_chaotic) == (2.0, False)


def test_a_wrong_right_hand_side_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The dense model with a thousandth more drag; whoever asks for less is told what the reference is good to."""
    from cablefmu.reference import model
    from cablefmu.reference.drag import drag_vector

    with fmu_runs(small_scene("load")) as runs:
        good = trusted(runs, 1e-4, 60.0).difference.position
        monkeypatch.setattr(model, "drag_vector", lambda *given: 1.001 * drag_vector(*given))
        with pytest.raises(
            RunError, match=r"no reference is to be trusted: the FMU at 1e-11 and the dense NumPy model"
        ):
            trusted(runs, 1e-4, 60.0)
        bad = trusted(runs, 1.0, 60.0).difference.position
    assert bad > 1e-5 > 1e5 * good


def test_beyond_the_dense_models_reach_the_two_methods_are_compared_and_the_report_says_so() -> None:
    many = Scene.from_text(SCENES["load"].replace("links = 5", "links = 121"), name="many")
    with fmu_runs(many) as runs:
        found = trusted(runs, 1e-4, 60.0)
    assert not found.is_independent
    assert found.checked_by.startswith("own solver only (121 links are more than 120)")
    assert 0.0 < found.difference.position < 1e-7


def test_a_dense_model_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    from cablefmu import report_reference
    from cablefmu.report_peers import dense_course

    monkeypatch.setattr(report_reference, "dense_course", lambda scene, limit: dense_course(scene, 1e-9))
    with fmu_runs(small_scene("load")) as runs:
        found = trusted(runs, 1e-4, 60.0)
    assert not found.is_independent
    assert "the dense NumPy model took more than 1e-09 s of CPU time" in found.checked_by


def test_no_reference_without_a_run() -> None:
    with fmu_runs(small_scene("load")) as runs, pytest.raises(RunError, match="load: no reference"):
        trusted(runs, 1e-4, 1e-9)


# --- horizon ---


@pytest.mark.slow
def test_chaotic_motion_has_a_horizon() -> None:
    scene = Scene.from_text(CHAOTIC, name="chaotic")
    with fmu_runs(scene) as runs:
        found = trusted(runs, 1e-4, 60.0)
    horizon, times = found.horizon, output_times(scene)
    assert horizon.is_chaotic
    assert 1.0 < horizon.time < 29.0
    before = times <= horizon.time
    assert np.all(horizon.growth[before] <= 1e-4)
    assert horizon.growth[np.argmin(before)] > 1e-4, "it is the last time at which they agree"
    assert np.max(horizon.growth) > 1.0, "at the end they have nothing in common"
    assert found.difference.position < 1e-4, "what the reference is good to counts up to the horizon only"


@pytest.mark.slow
def test_who_asks_for_less_sees_further() -> None:
    scene = Scene.from_text(CHAOTIC, name="chaotic")
    with fmu_runs(scene) as runs:
        near, far = (trusted(runs, accuracy, 60.0).horizon.time for accuracy in (1e-6, 1e-3))
    assert near < far


def test_the_two_starts_differ_by_what_is_said() -> None:
    """Positions at the start: no more than all angles off by some 4e-9 rad make, and not nothing."""
    scene = small_scene("load")
    with fmu_runs(scene) as runs:
        growth = trusted(runs, 1e-4, 60.0).horizon.growth
    assert 0.0 < growth[0] < 5.0 * NUDGE * 20.0


def test_a_horizon_within_the_first_interval_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    run = FmuRuns.run

    def far_off(self: FmuRuns, **given: object) -> object:
        found = run(self, **given)  # type: ignore[arg-type]
        if given.get("start"):
            found.outputs["x_c"][1:] += 1.0
        return found

    monkeypatch.setattr(FmuRuns, "run", far_off)
    with (
        fmu_runs(whole(small_scene("load"))) as runs,
        pytest.raises(RunError, match="within the first output"),
    ):
        trusted(runs, 1e-4, 60.0)
