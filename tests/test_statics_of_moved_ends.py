"""Statics of cables whose top surges or whose ends vessels hold: against the dense equation and differences."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cablefmu
from cablefmu.cable import Floats
from cablefmu.errors import OptionError
from cablefmu.kernel import KernelModel
from cablefmu.reference import Reference
from cablefmu.scene import Scene, load_scene
from cablefmu.statics import Equilibrium, end_stiffness, equilibrium, modes
from cablefmu.statics_results import statics_dataset, write_statics
from tests.fmu_helpers import small_scene

KINDS = ("surge", "moved", "between")
LED_BACK = 100.0
"""[1/s^2] Square of the rate at which a held end is led back: no frequency, and twice in the dense equation."""


def slopes(found: Equilibrium) -> Floats:
    """-da/dq at rest by the dense equation, whose eigenvalues are squared pulsations [1/s^2]."""
    reference, q = Reference(found.cable), found.q
    still = np.zeros_like(q)
    columns = [reference.acceleration(q + 1e-30j * one, still, found.inputs).imag / 1e-30 for one in np.eye(len(q))]
    return -np.array(columns).T


@pytest.mark.parametrize("kind", KINDS)
def test_frequencies_are_those_of_the_dense_equation(kind: str) -> None:
    found = equilibrium(small_scene(kind))
    assert np.max(np.abs(Reference(found.cable).acceleration(found.q, 0.0 * found.q, found.inputs))) < 1e-7
    squares = np.sort(np.linalg.eigvals(slopes(found)).real)
    led = np.argsort(np.abs(squares - LED_BACK))[: 0 if kind == "moved" else 2]
    np.testing.assert_allclose(squares[led], LED_BACK, rtol=1e-6)  # a double one
    expected = np.delete(squares, led)
    calculated = modes(found, count=20)
    np.testing.assert_allclose(calculated.pulsation**2, expected, rtol=1e-8)
    for square, shape in zip(calculated.pulsation**2, calculated.shapes, strict=True):
        size = np.max(np.abs(square * shape))
        np.testing.assert_allclose(slopes(found) @ shape, square * shape, rtol=0, atol=1e-7 * size)


@pytest.mark.parametrize("name", ["lifted-40", "moored-40", "towed-40"])
def test_long_cables_have_the_same_slowest_modes(name: str) -> None:
    """Above 200 coordinates the modes are found one by one; four times the links change the slowest by their n^-2."""
    scene = load_scene(name)
    fine = Scene.from_text(scene.text.replace("links = 40", "links = 240"), name=name)
    coarse, refined = (modes(one, count=3).frequency for one in (scene, fine))
    np.testing.assert_allclose(coarse, refined, rtol=4e-3)


def test_a_vessel_takes_the_cable_along() -> None:
    """Put elsewhere it hangs there as it did before."""
    here, there = (equilibrium(small_scene("moved"), {"x_1": x, "y_1": y}) for x, y in ((0.0, 0.0), (3.0, -1.0)))
    assert there.top == (3.0, -1.0)
    assert there.heave == -1.0
    np.testing.assert_allclose(there.points - here.points, [[3.0, -1.0]] * 6, rtol=0, atol=1e-9)
    np.testing.assert_allclose(there.angles, here.angles, rtol=0, atol=1e-9)


def test_between_vessels_it_reaches_from_one_to_the_other() -> None:
    found = equilibrium(small_scene("between"), {"x_1": 1.0, "x_2": 11.0, "y_2": 14.0})
    assert found.top == (1.0, 0.0)
    assert found.terminal == pytest.approx((11.0, 14.0), abs=1e-7)
    assert found.inputs["ay_1"] == 0.0, "though the scene sets out with an acceleration"


def test_the_surge_is_part_of_the_equilibrium() -> None:
    """Pushed by u_m1x the floater goes until spring and cable hold it."""
    found = equilibrium(small_scene("surge"), {"u_m1x": 500.0, "u_m1": 0.0})
    p, surge = found.cable.parameters, found.top[0]
    assert surge == found.q[-1] > 0.1
    assert 500.0 - p["static_pull"] - p["k_m1H"] * surge == pytest.approx(found.forces[0, 0], abs=1e-5)


def test_a_vessel_that_moves_is_no_state_of_rest() -> None:
    with pytest.raises(OptionError, match=r"input vx_1 = 2\.0: at rest a vessel stands still; x_1 says where"):
        equilibrium(small_scene("moved"), {"vx_1": 2.0})


def test_end_stiffness_is_the_slope_of_what_vessels_feel() -> None:
    """The outputs' own F by differences of 1 mm, each at its equilibrium; forces on the cable are their negatives."""
    rest, h = equilibrium(small_scene("between")), 1e-3
    columns = []
    for name in ("x_1", "y_1", "x_2", "y_2"):
        felt = []
        for moved in (rest.inputs[name] - h, rest.inputs[name] + h):
            there = equilibrium(rest, {name: moved})
            model = KernelModel(there.cable)
            outputs = model.outputs(np.concatenate([there.q, 0.0 * there.q]), model.forces(there.inputs))
            felt.append([-outputs[force] for force in ("F_1x", "F_1y", "F_2x", "F_2y")])
        columns.append((np.array(felt[1]) - felt[0]) / (2.0 * h))
    stiffness = end_stiffness(rest)
    # Second order in h over the cable's sag, and the residuals of the equilibria over h.
    np.testing.assert_allclose(np.array(columns).T, stiffness, rtol=0, atol=1e-4 * np.max(np.abs(stiffness)))


@pytest.mark.parametrize(
    ("kind", "ends"), [("surge", {"mode_heave", "mode_surge"}), ("moved", set()), ("between", set())]
)
def test_results_hold_what_floaters_there_are(kind: str, ends: set[str], tmp_path: Path) -> None:
    scene = small_scene(kind)
    given = {"F_cx": 200.0} if kind == "moved" else {}  # straight down there is no stiffness along the cable
    result = statics_dataset(scene, given, ["modes", "stiffness"])
    assert set(result.data_vars) == {"frequency", "mode_shape", "end_stiffness"} | ends
    assert result["mode_shape"].shape[1] == 5
    if ends:
        np.testing.assert_array_equal(result["mode_surge"], modes(scene).shapes[:, -1])
    (path, _) = write_statics(result, tmp_path / "x.csv")
    names = [name for name, column in (("y_m1", "mode_heave"), ("x_m1", "mode_surge")) if column in ends]
    head = ["mode", "frequency", *names, *(f"theta[{i}]" for i in range(1, 6))]
    assert path.read_text().splitlines()[0] == ",".join(head)


def test_an_equilibrium_starts_a_run() -> None:
    """The first row of a run from equilibrium shows the forces that statics found, of resting vessels."""
    scene = small_scene("between")
    text = "\n".join(line for line in scene.text.splitlines() if not line.startswith(("x_1", "y_1", "y_2")))
    still = Scene.from_text(text.replace("[run]\n", '[run]\ninitial = "equilibrium"\n'), name="between")
    first = cablefmu.simulate(still, stop_time=0.2)
    found = equilibrium(still)
    assert [float(first[name][0]) for name in ("F_1x", "F_1y")] == pytest.approx((-found.forces[0]).tolist(), rel=1e-9)
    assert [float(first[name][-1]) for name in ("F_2x", "F_2y")] == pytest.approx(found.forces[-1].tolist(), rel=1e-6)
