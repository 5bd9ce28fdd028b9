"""Vessels in couplings: bodies take the slopes of their force, and converge as the other models do."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cablefmu.cable import Floats
from cablefmu.coupling import couple, load_coupling
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.schema import ModelSpec
from cablefmu.coupling.system import opened
from cablefmu.reference import Reference
from cablefmu.scene import load_scene
from cablefmu.vessel import BodyTable, Vessel

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


def test_a_bodys_force_follows_slopes_unless_its_table_says_otherwise() -> None:
    with opened(_hawser("jacobi", 1, 0.1)) as system:
        assert system.models["vessel"].slopes("F_y") == ["der(F_y)", "der(F_y,2)"]
        assert "vessel.F_y" not in [str(v) for v in system.holding]
    text = _hawser("jacobi", 1, 0.1).text.replace('kind = "body"', 'kind = "body", extrapolation = 0')
    with opened(Coupling.from_text(text, name="held")) as system:
        assert "vessel.F_y" in [str(v) for v in system.holding]
