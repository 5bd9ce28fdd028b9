"""Elimination along the chain against the dense equation, and against 90 digits where that is no judge."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Drag, Floats
from cablefmu.reference import Reference
from cablefmu.reference.extended import extended_acceleration, long_double_acceleration
from tests.kernel.cases import Case, aligned_case, case, heavy_case
from tests.kernel.library import Kernel
from tests.random_cables import KINDS

DENSE = 1e-11
"""Largest error of an acceleration over the largest acceleration. The dense reference loses more than the
kernel: 16 digits less the condition of I(x), up to 1e5 at 120 links."""
DENSE_LONG = 1e-9
"""The same at 1,000 links: the condition grows like n^2."""
WIDE = 2e-12
"""The same against the dense equation in long double, up to 120 links. Measured: 5e-13 (n = 2), 2e-13 (n = 120)."""
HEAVY = (1e4, 1e6, 8e8, 1e12)
"""Anchor masses [kg]"""
EXACT = 1e-13
"""Largest error of the kernel against 90 digits, over the largest value: rounding. Measured: 2e-14, for any mass."""

HELD = 1e-11
"""The same where links line up behind an end that cannot give: what the shape alone costs. Measured: 4e-12 (3 links),
3e-13 (12)."""


def error(found: Floats, expected: Floats) -> float:
    """Largest difference over the largest expected value."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def exact_acceleration(example: Case) -> Floats:
    return extended_acceleration(example.cable, example.q, example.v, example.inputs, digits=90).astype(float)


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("n", [1, 2, 3, 12, 60, 120])
def test_accelerations_are_those_of_the_dense_equation(library: ctypes.CDLL, n: int, kind: int) -> None:
    for draw in range(3):
        c = case(library, n, kind, draw=draw)
        expected = long_double_acceleration(c.cable, c.q, c.v, c.inputs).astype(float)
        assert error(c.kernel.acceleration(c.q, c.v, c.inputs), expected) < WIDE


@pytest.mark.parametrize("kind", [k for k, (_, _, drag) in enumerate(KINDS) if drag is Drag.COEFFICIENT])
def test_accelerations_of_a_thousand_links(library: ctypes.CDLL, kind: int) -> None:
    c = case(library, 1000, kind)
    found, expected = (model.acceleration(c.q, c.v, c.inputs) for model in (c.kernel, c.reference))
    assert error(found, expected) < DENSE_LONG


def test_kernel_keeps_more_digits_than_the_dense_equation(library: ctypes.CDLL) -> None:
    """Which of the two is off: the elimination forms no ill-conditioned matrix, I(x) is one.

    Ends of up to 1e4 kg, 12 links of every kind. Measured over 320 draws: the kernel's median is 2e-15 and
    its worst 2e-13, the dense equation's 3e-14 and 2e-12.
    """
    cases = [case(library, 12, kind, draw=draw) for kind in range(len(KINDS)) for draw in range(3)]
    exact = [exact_acceleration(c) for c in cases]
    pairs = list(zip(cases, exact, strict=True))
    kernel = [error(c.kernel.acceleration(c.q, c.v, c.inputs), a) for c, a in pairs]
    dense = [error(c.reference.acceleration(c.q, c.v, c.inputs), a) for c, a in pairs]
    assert max(kernel) < 1e-12
    assert np.median(kernel) < min(1e-14, float(np.median(dense)))


@pytest.mark.parametrize("mass", HEAVY)
def test_heavy_end_costs_no_digits(library: ctypes.CDLL, mass: float) -> None:
    """In homogeneous coordinates nothing cancels, however much the end's mass outweighs the links behind it."""
    for draw in range(3):
        c = heavy_case(library, mass, draw)
        assert error(c.kernel.acceleration(c.q, c.v, c.inputs), exact_acceleration(c)) < EXACT


@pytest.mark.parametrize(
    ("bend", "bound"), [(0.0, 1e-12), (1e-6, 1e-10), (1e-4, 1e-7), (1e-3, 1e-8), (1e-2, 1e-10), (0.1, 1e-12)]
)
def test_mass_below_1e7_cables_of_an_almost_straight_cable(library: ctypes.CDLL, bend: float, bound: float) -> None:
    """Only where the links almost line up between two such ends are digits lost: docs/numerics.md."""
    for draw in range(3):
        c = aligned_case(library, 12, 8e8, bend, draw=draw)
        assert error(c.kernel.acceleration(c.q, c.v, c.inputs), exact_acceleration(c)) < bound


@pytest.mark.parametrize("end", [1e12, 1e20, None])
@pytest.mark.parametrize(("n", "draws"), [(3, 5), (12, 2), (30, 1)])
def test_links_in_line_behind_an_end_that_cannot_give(
    library: ctypes.CDLL, n: int, draws: int, end: float | None
) -> None:
    """Eliminated from the top alone, on a pin or behind more than 1e7 cables, whatever the shape."""
    for bend in (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 0.0):
        for draw in range(draws):
            c = aligned_case(library, n, end, bend, draw=draw)
            found = c.kernel.acceleration(c.q, c.v, c.inputs)
            assert error(found, exact_acceleration(c)) < HELD, (bend, draw)


@pytest.mark.parametrize("missing", ["joint_stiffness", "joint_damping", "drag"])
def test_what_a_scene_does_not_have_takes_nothing_else_with_it(library: ctypes.CDLL, missing: str) -> None:
    """The kernel skips joints' springs, joints' dampers and drag where they are zero, each by itself."""
    kind = next(k for k, (_, _, drag) in enumerate(KINDS) if drag is Drag.PER_LINK)
    c = case(library, 12, kind)
    bare = {name: value for name, value in c.cable.parameters.items() if name not in ("k_joint", "c_joint")}
    links = replace(c.cable.links, **{missing: np.zeros(12)})
    cable = replace(c.cable, links=links, parameters=bare)
    found, expected, whole = (
        model.acceleration(c.q, c.v, c.inputs) for model in (Kernel(library, cable), Reference(cable), c.reference)
    )
    assert error(found, expected) < DENSE
    assert error(found, whole) > 1e-6


@pytest.mark.parametrize("kind", [0, 2])
def test_mirror_image_moves_as_the_mirror_image(library: ctypes.CDLL, kind: int) -> None:
    """Left and right are alike, to the last bit: a hanging load with x -> -x."""
    c = case(library, 12, kind)
    mirror = np.array([1.0] + [-1.0] * c.cable.n)
    other = c.inputs | {"F_cx": -c.inputs["F_cx"]}
    found = c.kernel.acceleration(c.q * mirror, c.v * mirror, other)
    assert np.array_equal(found, c.kernel.acceleration(c.q, c.v, c.inputs) * mirror)


def test_no_gravity_no_forces_no_acceleration(library: ctypes.CDLL) -> None:
    """A straight cable at rest with nothing to move it stays, exactly."""
    c = case(library, 12, 0)
    quiet = dict.fromkeys(("g", "static_load", "k_m1", "c_m1", "k_joint", "c_joint"), 0.0)
    cable = replace(c.cable, parameters=c.cable.parameters | quiet)
    q, v = np.concatenate([[0.0], np.full(12, 0.7)]), np.zeros(13)
    assert np.array_equal(Kernel(library, cable).acceleration(q, v, {}), np.zeros(13))
