"""scipy's integrators on the kernel's right-hand side, against the dense reference, which shares no code with it."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.cable import Cable
from cablefmu.errors import OptionError
from cablefmu.kernel import KernelModel
from cablefmu.reference import Reference
from cablefmu.report_peers import SCIPY, breaks_of, dense_course, scipy_course
from cablefmu.report_runs import TooSlowError, apart, is_measured
from cablefmu.scene import Scene
from tests.fmu_helpers import KINDS, SCENES, small_scene

STEPPED = SCENES["load"].replace(
    "u_m1 = { signal", 'F_cx = { signal = "steps", times = [0, 0.35, 1.2], values = [0, 90, -40] }\nu_m1 = { signal'
)
"""A force that jumps between output times and on one."""


@pytest.mark.parametrize("kind", [kind for kind in KINDS if is_measured(small_scene(kind))])
def test_the_kernel_under_scipy_moves_as_the_dense_matrices_do(kind: str) -> None:
    """Both DOP853 at 1e-10; a pin's drift, which the kernel lets decay and the dense model forbids, is below 1e-9 m."""
    scene = small_scene(kind)
    off = apart(scipy_course(scene, "DOP853", 1e-10), dense_course(scene), scene.stop_time)
    assert off.position < 1e-8
    assert off.tension_relative < 1e-7
    assert off.energy < 1e-5


@pytest.mark.parametrize("method", SCIPY)
def test_jumps_of_a_force_are_no_business_of_the_tolerance(method: str) -> None:
    """A jump that a step goes over costs centimetres; so many at 1e-8 is what the method itself is off by."""
    scene = Scene.from_text(STEPPED, name="stepped")
    assert breaks_of(scene) == [0.35, 1.2]
    found = scipy_course(scene, method, 1e-8)
    assert apart(found, dense_course(scene), scene.stop_time).position < 1e-6
    assert found.rhs > 100


@pytest.mark.parametrize("method", SCIPY)
def test_scipy_stops_when_its_time_is_up(method: str) -> None:
    with pytest.raises(TooSlowError, match="of CPU time"):
        scipy_course(small_scene("load"), method, 1e-6, limit=1e-9)


def test_the_dense_model_stops_when_its_time_is_up() -> None:
    with pytest.raises(TooSlowError, match="of CPU time"):
        dense_course(small_scene("load"), limit=1e-9)


# --- the kernel's right-hand side and outputs for Python ---


def moving(cable: Cable, seed: int) -> tuple[np.ndarray, dict[str, float]]:
    random = np.random.default_rng(seed)
    x = np.concatenate([cable.position, cable.velocity]) + 0.2 * random.standard_normal(2 * cable.coordinates)
    return x, {name: 100.0 * random.standard_normal() for name in cable.inputs}


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("pin", "surge", "between")])
def test_right_hand_side_and_outputs_are_those_of_the_dense_matrices(kind: str) -> None:
    """At any state; of a pinned cable only on its pin, which the courses above cover."""
    cable = small_scene(kind).cable
    model, reference = KernelModel(cable), Reference(cable)
    for seed in range(5):
        x, inputs = moving(cable, seed)
        q, v = np.split(x, 2)
        found = model.derivatives(x, model.forces(inputs))
        np.testing.assert_array_equal(found[: len(q)], v)
        np.testing.assert_allclose(found[len(q) :], reference.acceleration(q, v, inputs), rtol=1e-9, atol=1e-9)
        expected = reference.outputs(q, v, inputs)
        outputs = model.outputs(x, model.forces(inputs))
        assert outputs == {name: pytest.approx(expected[name], rel=1e-8, abs=1e-8) for name in expected}


def test_a_trial_step_that_went_too_far_is_not_a_number() -> None:
    model = KernelModel(small_scene("load").cable)
    forces = model.forces({})
    for wrong in (np.full(12, np.nan), np.full(12, 1e9)):
        assert np.all(np.isnan(model.derivatives(wrong, forces)[6:]))


def test_what_the_kernel_refuses() -> None:
    model = KernelModel(small_scene("load").cable)
    forces = model.forces({})
    with pytest.raises(OptionError, match=r"shape \(12,\) is expected"):
        model.derivatives(np.zeros(11), forces)
    with pytest.raises(OptionError, match="12 finite numbers"):
        model.outputs(np.full(12, np.inf), forces)
    with pytest.raises(OptionError, match=r"1\.6e6"):
        model.outputs(np.full(12, 1e9), forces)
    with pytest.raises(OptionError, match="no such input"):
        model.forces({"u_m2": 1.0})
