"""Adjoint derivatives against the dense equation's by complex step: rows of the matrix whose columns are the changes.

One seed at a time is a row; the matrix is that of tests/kernel/changes.py, which shares nothing with the kernel. No row
is checked against the kernel's own directional derivatives but where a scalar product says more.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping

import numpy as np
import pytest

from cablefmu.cable import Cable, Drag, Floats, Terminal
from cablefmu.fmu.table import table
from tests.kernel.cases import Case, case
from tests.kernel.changes import expected_changes, random_directions, unit_directions
from tests.kernel.library import Kernel, inputs_of
from tests.random_cables import KINDS, random_cable

EXACT = 1e-10
"""Largest error of an entry over the largest of its row, angles, rates and forces each by themselves. Measured: 3e-11
where an end weighs a hundred cables or P_n is far from its pin, as of the columns."""
PULLS = ("tension_top", "tension_end", "tension_max")
Rows = tuple[Floats, dict[str, Floats]]


def expected_rows(c: Case) -> Rows:
    """Of every acceleration, shape (n + 1, columns), and of every output, shape (columns,), the columns as
    `unit_directions` has them: coordinate and rate by turns, then inputs."""
    columns = [expected_changes(c, along) for along in unit_directions(c.cable)]
    accelerations = np.array([column[0] for column in columns]).T
    return accelerations, {name: np.array([column[1][name] for column in columns]) for name in columns[0][1]}


def found_row(c: Case, derivative: Floats, outputs: Mapping[str, float]) -> Floats:
    """The kernel's, in the same order, for seeds of the derivatives, shape (2 (n + 1),), and of outputs."""
    x = np.concatenate([c.q, c.v])
    found = c.kernel.adjoint(x, inputs_of(c.inputs), derivative, outputs)
    assert found is not None
    to_state, to_input = found
    states = to_state.reshape(2, -1).T.ravel()
    return np.concatenate([states, [to_input[name] for name in c.cable.inputs]])


def groups(cable: Cable) -> list[slice]:
    """Of a row: coordinates, rates, inputs; their units differ."""
    states = 2 * (cable.n + 1)
    inputs = [slice(states, None)] if cable.inputs else []
    return [slice(0, states, 2), slice(1, states, 2), *inputs]


def assert_rows_agree(c: Case, found: Floats, expected: Floats, size: Floats, what: str) -> None:
    """Entry by entry; `size` is the row or rows that errors are measured by."""
    alone = 1.0 / c.cable.parameters["M_1"]  # what the floater alone would do: one link on a pin makes rows of zeros
    for group in groups(c.cable):
        largest = max(np.abs(size[..., group]).max(), alone)
        assert np.abs(found[group] - expected[group]).max() <= EXACT * largest, (what, group)


def assert_all_rows_agree(c: Case) -> None:
    """One acceleration, one output at a time; pulls are sums over the same links and are measured alike."""
    half = c.cable.n + 1
    accelerations, outputs = expected_rows(c)
    rows = np.eye(2 * half)
    for k in range(half):
        found = found_row(c, rows[half + k], {})
        assert_rows_agree(c, found, accelerations[k], accelerations, f"acceleration {k}")
        to_state = found_row(c, rows[k], {})
        assert to_state[2 * k + 1] == 1.0 and np.abs(to_state).sum() == 1.0, "q' = v"
    pulls = np.array([outputs[name] for name in PULLS])
    for name, expected in outputs.items():
        size = pulls if name in PULLS else expected
        assert_rows_agree(c, found_row(c, np.zeros(2 * half), {name: 1.0}), expected, size, name)


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("n", [1, 2, 3, 12])
def test_rows_of_every_derivative_and_output(library: ctypes.CDLL, n: int, kind: int) -> None:
    assert_all_rows_agree(case(library, n, kind))


@pytest.mark.parametrize("mass", [1e4, 1e6, 8e8, 1e12, 1e20])
@pytest.mark.parametrize("terminal", [Terminal.ANCHOR_MASS, Terminal.FLOATER])
def test_rows_at_heavy_ends(library: ctypes.CDLL, terminal: Terminal, mass: float) -> None:
    kind = KINDS.index((terminal, True, Drag.COEFFICIENT))
    assert_all_rows_agree(case(library, 12, kind, draw=0, **{"M_2" if terminal is Terminal.FLOATER else "m_c": mass}))


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_everything_at_once_at_sixty_links(library: ctypes.CDLL, kind: int) -> None:
    """seed . (J d) = (J^T seed) . d, the left side being the dense equation's: all seeds and directions are random."""
    c = case(library, 60, kind)
    half, rng = 61, np.random.default_rng(kind)
    for along in random_directions(c.cable, 5):
        acceleration, outputs = expected_changes(c, along)
        seed = rng.normal(size=2 * half) / np.abs(acceleration).max()
        size = {name: 1.0 + abs(change) for name, change in outputs.items()}
        size |= dict.fromkeys(PULLS, max(size[name] for name in PULLS))
        output_seed = {name: rng.normal() / size[name] for name in outputs}
        terms = [seed[:half] * along.v, seed[half:] * acceleration]
        terms += [np.array([output_seed[name] * change]) for name, change in outputs.items()]
        row = found_row(c, seed, output_seed)
        direction = np.stack([along.q, along.v]).T.ravel()
        found = row @ np.concatenate([direction, [along.inputs[name] for name in c.cable.inputs]])
        expected = np.concatenate(terms)
        assert abs(found - expected.sum()) <= EXACT * np.abs(expected).sum()


def test_an_adjoint_leaves_no_trace(library: ctypes.CDLL) -> None:
    """The same bits again, in whatever order directions and seeds come: nothing of one call is in the next."""
    c = case(library, 12, KINDS.index((Terminal.FLOATER, True, Drag.COEFFICIENT)))
    seed, outputs = np.linspace(-1.0, 1.0, 26), dict.fromkeys(table().outputs, 1.0)
    first = found_row(c, seed, outputs)
    x, none = np.concatenate([c.q, c.v]), inputs_of({})
    c.kernel.directional(x, inputs_of(c.inputs), np.ones(26), none)
    found_row(c, -seed, {})
    assert found_row(c, seed, outputs).tobytes() == first.tobytes()


def test_taut_level_cable_between_two_ends_that_cannot_give_has_no_adjoint(library: ctypes.CDLL) -> None:
    cable = random_cable(np.random.default_rng(1), 3, Terminal.PIN, water=False)
    level = np.concatenate([[0.0], np.full(3, np.pi / 2), np.zeros(4)])
    assert Kernel(library, cable).adjoint(level, inputs_of({}), np.ones(8), {}) is None
