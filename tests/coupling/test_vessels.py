"""Vessels in couplings: bodies take the slopes of their force, and converge as the other models do."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cablefmu.cable import Floats
from cablefmu.coupling import couple, load_coupling
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.run import run_system
from cablefmu.coupling.schema import ModelSpec
from cablefmu.coupling.system import System, opened, varied
from cablefmu.coupling_report_truth import Truth, find_truth
from cablefmu.reference import Reference
from cablefmu.scene import load_scene
from cablefmu.vessel import BodyTable, Vessel
from tests.coupling.ships import NAMES, SCENE, STOP, small

LARGEST = {"jacobi": 5e-4, "gauss-seidel": 2e-4, "iterated": 1e-5}
"""Distance from the whole system's motion [m] with inputs of order 2 and 20 ms steps: 3 times what was measured."""


def _hawser(algorithm: str, extrapolation: int, step: float, fmi: int = 2) -> Coupling:
    text = load_coupling("vessel-and-hawser").text
    for old, new in (
        ('"iterated"', f'"{algorithm}"'),
        ("extrapolation = 1", f"extrapolation = {extrapolation}"),
        ('"0.1 s"', str(step)),
        ('"20 s"', "8"),
        ('scene = "free-12-water"', f'scene = "free-12-water"\nfmi = {fmi}'),
    ):
        assert old in text
        text = text.replace(old, new)
    return Coupling.from_text(text, name="hawser")


@pytest.mark.parametrize(
    ("algorithm", "extrapolation", "fmi", "order"),
    [("gauss-seidel", 0, 2, 1), ("gauss-seidel", 1, 2, 2), ("iterated", 1, 3, 2), ("iterated", 2, 2, 3)],
)
def test_a_vessel_a_hawser_and_a_cable_converge_to_one_motion(
    algorithm: str, extrapolation: int, fmi: int, order: int
) -> None:
    """Distances between runs with h, h/2 and h/4: their ratio says the order, and needs no other truth."""
    motions = [
        couple(_hawser(algorithm, extrapolation, 0.2 / 2**k, fmi))["cable.y_m1"].values[:: 2**k] for k in range(3)
    ]
    first, second = (float(np.abs(a - b).max()) for a, b in pairwise(motions))
    assert np.log2(first / second) == pytest.approx(order, abs=0.35)


def whole_system(times: Floats) -> Floats:
    """Displacements of vessel and floater and the load's position across [m], by one integration of everything.

    The dense reference model, the vessel and the hawser in one right-hand side: no code of the FMUs, and no coupling.
    """
    model = Reference(load_scene("free-12-water").cable)
    size = model.cable.n + 1
    hawser = model_of("hawser").parameters
    stiffness, damping = float(hawser["stiffness"]), float(hawser["damping"])
    body = Vessel.from_table(model_of("vessel").vessel).table
    assert isinstance(body, BodyTable)

    def right_side(t: float, state: Floats) -> Floats:
        q, v, y, vy = state[:size], state[size : 2 * size], state[-2], state[-1]
        force = stiffness * (y - q[0]) + damping * (vy - v[0])
        vessel = (-force - body.k_y * y - body.c_y * vy) / body.m_y
        return np.concatenate([v, model.acceleration(q, v, {"u_m1": force}), [vy, vessel]])

    start = np.concatenate([model.cable.position, model.cable.velocity, [body.y_0, 0.0]])
    states = solve_ivp(right_side, (0.0, times[-1]), start, "DOP853", times, rtol=1e-10, atol=1e-12).y.T
    across = [model.outputs(s[:size], s[size : 2 * size], {"u_m1": 0.0})["x_c"] for s in states]
    return np.column_stack([states[:, -2], states[:, 0], across])


def model_of(name: str) -> ModelSpec:
    return next(model for model in load_coupling("vessel-and-hawser").spec.model if model.name == name)


@pytest.mark.parametrize(("algorithm", "fmi"), [("jacobi", 2), ("gauss-seidel", 3), ("iterated", 2), ("iterated", 3)])
def test_the_limit_is_the_motion_of_the_whole(algorithm: str, fmi: int, whole: Floats) -> None:
    result = couple(_hawser(algorithm, 2, 0.02, fmi)).isel(time=slice(None, None, 10))
    found = np.column_stack([result[name].values for name in ("vessel.y", "cable.y_m1", "cable.x_c")])
    assert np.all(np.ptp(whole, axis=0) > [2.0, 1.0, 10.0])  # m: there is something to agree on
    assert np.abs(found - whole).max(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=LARGEST[algorithm])


@pytest.fixture(scope="module")
def whole() -> Floats:
    return whole_system(np.arange(41) * 0.2)


# --- the vessel's mass inside, its springs outside; the vessel outside; all in one ---

_FORCE_DRIVEN = """
[coupling]
stop_time = {stop}
step = 0.1
[[model]]
name = "cable"
scene = "floater.toml"
parameters = {{ x_m1 = {body.x_0}, y_m1 = {body.y_0}, vx_m1 = {body.vx_0}, v_m1 = {body.vy_0} }}
inputs = {{ F_cx = 0, F_cy = 0 }}
"""
_FLOATER = """
kind = "floater"
mass = {body.m_y}
stiffness = 0
damping = 0
static_load = {body.static_load_y}
stiffness_horizontal = 0
damping_horizontal = 0
static_pull = {pull}
"""
"""The vessel's mass and what pulls at it all the time, without springs."""
_MOORING = """
[[model]]
name = "mooring_{axis}"
partner = "spring"
parameters = {{ stiffness = {stiffness}, damping = {damping} }}
inputs = {{ y_b = 0, v_b = 0 }}
[[connection]]
from = "cable.{axis}_m1"
to = "mooring_{axis}.y_a"
[[connection]]
from = "cable.{velocity}"
to = "mooring_{axis}.v_a"
[[connection]]
from = "mooring_{axis}.F_a"
to = "cable.{force}"
"""


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[System, System, Truth]]:
    """Motion-driven, force-driven, and vessel and cable in one FMU, checked by the dense model."""
    folder = tmp_path_factory.mktemp("driven")
    with opened(small(folder)) as motion:
        body = Vessel.from_table(motion.models["vessel"].spec.vessel).table
        assert isinstance(body, BodyTable)
        top = _FLOATER.format(body=body, pull=body.static_load_x - body.external_x)
        (folder / "floater.toml").write_text(SCENE.replace('kind = "motion"', top), encoding="utf-8")
        text = _FORCE_DRIVEN.format(stop=STOP, body=body)
        text += _MOORING.format(axis="x", stiffness=body.k_x, damping=body.c_x, velocity="vx_m1", force="u_m1x")
        text += _MOORING.format(axis="y", stiffness=body.k_y, damping=body.c_y, velocity="v_m1", force="u_m1")
        with opened(Coupling.from_text(text, name="force", folder=folder)) as force:
            yield motion, force, find_truth(motion)


@pytest.mark.parametrize(
    ("algorithm", "extrapolation", "order"), [("jacobi", 0, 1), ("gauss-seidel", 1, 2), ("jacobi", 2, 3)]
)
def test_mass_inside_and_mass_outside_tend_to_the_whole(
    algorithm: str, extrapolation: int, order: int, driven: tuple[System, System, Truth]
) -> None:
    """Force-driven: springs pull at a floater that has the vessel's mass. Motion-driven: the vessel moves the cable."""
    motion, force, truth = driven
    names = {"vessel.x": "cable.x_m1", "vessel.y": "cable.y_m1", "cable.x_c": "cable.x_c", "cable.y_c": "cable.y_c"}
    assert names.keys() == set(NAMES)
    errors, apart = [], []
    for step in (0.05, 0.025, 0.0125):
        outside, inside = (
            run_system(varied(system, algorithm=algorithm, extrapolation=extrapolation, step=step))
            for system in (motion, force)
        )
        right = truth.at(outside["time"].values)
        both = np.array([[outside[a].values - right[a], inside[b].values - right[a]] for a, b in names.items()])
        errors.append(np.abs(both).max(axis=(0, 2)))
        apart.append(np.abs(both[:, 0] - both[:, 1]).max())
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    assert observed == pytest.approx(np.full((2, 2), float(order)), abs=0.3), errors
    assert np.log2(apart[0] / apart[-1]) == pytest.approx(2.0 * order, abs=0.6)
    assert errors[-1].min() > 10.0 * truth.good_to  # what was measured is the coupling


def test_a_bodys_force_follows_slopes_unless_its_table_says_otherwise() -> None:
    with opened(_hawser("jacobi", 1, 0.1)) as system:
        assert system.models["vessel"].slopes("F_y") == ["der(F_y)", "der(F_y,2)"]
        assert "vessel.F_y" not in [str(v) for v in system.holding]
    text = _hawser("jacobi", 1, 0.1).text.replace('kind = "body"', 'kind = "body", extrapolation = 0')
    with opened(Coupling.from_text(text, name="held")) as system:
        assert "vessel.F_y" in [str(v) for v in system.holding]
