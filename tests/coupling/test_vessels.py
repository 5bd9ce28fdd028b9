"""Vessels in couplings: bodies take the slopes of their force, and converge as the other models do."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from cablefmu.coupling import couple, load_coupling
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.system import opened


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


def test_both_algorithms_have_the_same_limit() -> None:
    explicit, iterated = (couple(_hawser(a, 2, 0.025))["vessel.y"].values for a in ("gauss-seidel", "iterated"))
    assert np.abs(explicit - iterated).max() < 1e-3 * np.ptp(iterated)


def test_a_bodys_force_follows_slopes_unless_its_table_says_otherwise() -> None:
    with opened(_hawser("jacobi", 1, 0.1)) as system:
        assert system.models["vessel"].slopes("F_y") == ["der(F_y)", "der(F_y,2)"]
        assert "vessel.F_y" not in [str(v) for v in system.holding]
    text = _hawser("jacobi", 1, 0.1).text.replace('kind = "body"', 'kind = "body", extrapolation = 0')
    with opened(Coupling.from_text(text, name="held")) as system:
        assert "vessel.F_y" in [str(v) for v in system.holding]
