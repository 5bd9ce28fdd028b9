"""Ends that are free both ways, and ends whose motion is given, against the dense equation: what no other end does.

The dense equation [cablefmu.reference] is that of a top with both coordinates, whose rows and columns are left out or
given; the kernel eliminates link by link [fmu_src/kernel/top.c, terminal.c].
"""

from __future__ import annotations

import ctypes
import math
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Cable, SolverChoice, Terminal, Top
from cablefmu.reference.extended import long_double_acceleration, long_double_outputs
from cablefmu.shapes import end_point
from tests.kernel.cases import port_case
from tests.kernel.changes import random_directions, unit_directions
from tests.kernel.library import Kernel, Wave, inputs_of
from tests.kernel.test_directional import assert_changes_agree, found_changes
from tests.random_cables import PORTS, random_cable

AMPLITUDE, PULSATION = 0.8, 1.3
"""Of every given coordinate [m], [rad/s]"""


def resting(cable: Cable) -> Cable:
    """The cable at rest, with an end that does not move freely where it belongs."""
    q = cable.position
    angles, (x, y) = cable.angles_in(q), replace(cable, input_start={}).start_of_top
    end = end_point(cable.links.length, angles)
    return replace(cable, velocity=np.zeros(len(q)), rest_position=(x + end[0], y + end[1]))


def waves_for(cable: Cable) -> dict[str, Wave]:
    """Forces that swing, motions that swing as one: x0 + A (1 - cos t w), its velocity, its acceleration."""
    waves: dict[str, Wave] = {}
    for name in cable.inputs:
        quarter = math.pi / 2
        at_rest = dict(zip(("x_2", "y_2"), cable.rest_position, strict=True)).get(name, 0.0)
        if name[-2:] not in ("_1", "_2"):
            waves[name] = (0.0, 300.0, PULSATION)
        elif name[0] == "v":
            waves[name] = (0.0, AMPLITUDE * PULSATION, PULSATION)
        elif name[0] == "a":
            waves[name] = (0.0, AMPLITUDE * PULSATION**2, PULSATION, quarter)
        else:
            waves[name] = (at_rest + AMPLITUDE, AMPLITUDE, PULSATION, -quarter)
    return waves


EVERY_KIND = pytest.mark.parametrize("kind", range(len(PORTS)))
ROUNDING = 2e-11
"""Of the largest acceleration, as at pins far from P_n [tests/kernel/test_chain.py]; outputs over the largest force."""


def links_of(kind: int, n: int) -> int:
    """Two ends that are given leave one link or two nothing to move, or too little."""
    top, terminal, *_ = PORTS[kind]
    held = (top is Top.MOTION) + (terminal in (Terminal.MOTION, Terminal.PIN))
    return max(n, 3) if held == 2 else n


@EVERY_KIND
@pytest.mark.parametrize("n", [1, 2, 5, 12, 60])
def test_accelerations_and_outputs(library: ctypes.CDLL, n: int, kind: int) -> None:
    c = port_case(library, links_of(kind, n), kind)
    expected = long_double_acceleration(c.cable, c.q, c.v, c.inputs).astype(float)
    found = c.kernel.acceleration(c.q, c.v, c.inputs)
    assert np.abs(found - expected).max() <= ROUNDING * max(np.abs(expected).max(), 1.0)
    wanted = {name: float(y) for name, y in long_double_outputs(c.cable, c.q, c.v, c.inputs).items()}
    outputs = c.kernel.outputs(c.q, c.v, c.inputs)
    force = max(abs(wanted[name]) for name in wanted if name.startswith(("tension", "F_")))
    for name, y in wanted.items():
        size = force if name.startswith(("tension", "F_", "m_")) else max(abs(y), 1.0)
        assert abs(outputs[name] - y) <= ROUNDING * size, name


@EVERY_KIND
@pytest.mark.parametrize("n", [1, 3, 12])
def test_changes_with_every_state_and_input(library: ctypes.CDLL, n: int, kind: int) -> None:
    c = port_case(library, links_of(kind, n), kind)
    assert_changes_agree(c, unit_directions(c.cable))


@EVERY_KIND
def test_changes_are_transposed(library: ctypes.CDLL, kind: int) -> None:
    """Adjoint and directional derivatives give one number, seed . (A d) = (A^T seed) . d: within 1e-11 of its terms."""
    c = port_case(library, links_of(kind, 12), kind)
    rng = np.random.default_rng(kind)
    x, u = np.concatenate([c.q, c.v]), inputs_of(c.inputs)
    outputs = list(long_double_outputs(c.cable, c.q, c.v, c.inputs))
    for along in random_directions(c.cable, 3):
        accelerations, y = found_changes(c, along)
        seed, output_seed = rng.normal(size=len(x)), dict(zip(outputs, rng.normal(size=len(outputs)), strict=True))
        adjoint = c.kernel.adjoint(x, u, seed, output_seed)
        assert adjoint is not None
        to_state, to_input = adjoint
        forward = np.concatenate(
            [seed * np.concatenate([along.v, accelerations]), [output_seed[k] * y[k] for k in outputs]]
        )
        back = np.concatenate(
            [to_state * np.concatenate([along.q, along.v]), [to_input[name] * du for name, du in along.inputs.items()]]
        )
        size = np.abs(forward).sum() + np.abs(back).sum()
        assert forward.sum() == pytest.approx(back.sum(), rel=0, abs=1e-11 * size)


@pytest.mark.parametrize("solver", [SolverChoice.EXPLICIT, SolverChoice.IMPLICIT])
@pytest.mark.parametrize("terminal", [Terminal.LOAD, Terminal.ANCHOR_SPRING, Terminal.PIN, Terminal.MOTION])
@pytest.mark.parametrize("top", list(Top))
def test_energy_that_comes_through_the_ends(
    library: ctypes.CDLL, top: Top, terminal: Terminal, solver: SolverChoice
) -> None:
    """Energy is that of the start with the work of every force and every given motion, less what dampers took.

    Within 1e-4 of what came and went: power through a given end goes both ways, and little of it stays. Measured: 2e-5.
    """
    rng = np.random.default_rng([3, list(Top).index(top), list(Terminal).index(terminal)])
    cable = resting(random_cable(rng, 6, terminal, True, top=top))
    kernel = Kernel(library, cable)
    runs = kernel.run(np.linspace(0.0, 3.0, 4), tolerance=1e-8, waves=waves_for(cable), solver=solver)
    assert [run.status for run in runs] == ["ok"] * 3
    turned_over = sum(map(abs, kernel.energy_parts()))
    assert abs(runs[-1].counters["energy_residual"]) <= 1e-4 * turned_over


@pytest.mark.parametrize("terminal", [Terminal.LOAD, Terminal.MOTION])
@pytest.mark.parametrize("top", [Top.FREE, Top.MOTION])
def test_explicit_and_implicit_find_the_same_motion(library: ctypes.CDLL, top: Top, terminal: Terminal) -> None:
    """At tolerance 1e-10 both are within 1e-7: what the inputs' slopes are to an implicit step is right."""
    rng = np.random.default_rng([4, list(Top).index(top), list(Terminal).index(terminal)])
    cable = resting(random_cable(rng, 6, terminal, True, top=top))
    ends = [
        Kernel(library, cable).run(np.array([0.0, 2.0]), tolerance=1e-10, waves=waves_for(cable), solver=solver)[-1]
        for solver in (SolverChoice.EXPLICIT, SolverChoice.IMPLICIT)
    ]
    assert np.abs(ends[0].q - ends[1].q).max() <= 1e-7
    assert np.abs(ends[0].q - cable.position).max() > 0.1
