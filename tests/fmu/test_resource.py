"""The resource file: its layout, read here once more by hand."""

from __future__ import annotations

import struct
import uuid
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Initial, SolverChoice
from cablefmu.fmu.resource import resource_bytes, token_of
from cablefmu.fmu.table import table
from cablefmu.fmu.variables import variables_of
from tests.fmu_helpers import KINDS, small_scene

ENDS = {
    "air": (0, 0), "load": (0, 0), "load-volume": (0, 0), "anchor-mass": (0, 1), "anchor-spring": (0, 2),
    "floater": (0, 3), "pin": (0, 4), "surge": (1, 4), "moved": (2, 0), "between": (2, 5),
}  # fmt: skip
"""Top and terminal, as model.h counts them."""

HEADER = struct.Struct("<8sIIIIQIIIIIIIIII")


@pytest.mark.parametrize("kind", KINDS)
def test_layout(kind: str) -> None:
    cable, rows = small_scene(kind).cable, table()
    variables = variables_of(cable)
    data = resource_bytes(cable, variables)
    magic, version, n, terminal, drag, present, *counts, solver, initial, shape, whole, top, more = HEADER.unpack_from(
        data
    )
    assert (magic, version, n, (top, terminal)) == (b"CABLEFMU", 4, 5, ENDS[kind])
    assert (solver, initial, shape, whole, more) == (0, 0, 0, 0, 0)
    assert drag == (0 if kind == "air" else 1)
    assert counts == [len(rows.parameters), len(rows.inputs), len(rows.outputs), len(variables)]
    assert {name for name, row in rows.parameters.items() if present >> row.slot & 1} == set(cable.parameters)

    # The heave has its place, and a zero, also where the top has none.
    state_of_kernel = np.concatenate([cable.padded(cable.position), cable.padded(cable.velocity)])
    before = counts[0] + counts[1] + 2 + 8 * n
    doubles = np.frombuffer(data, "<f8", count=before + len(state_of_kernel), offset=HEADER.size)
    parameters, inputs, rest, links, state = np.split(doubles, np.cumsum([counts[0], counts[1], 2, 8 * n]))
    assert {name: parameters[rows.parameters[name].slot] for name in cable.parameters} == cable.parameters
    assert tuple(rest) == cable.rest_position
    assert {name: inputs[rows.inputs[name].slot] for name in cable.input_start} == cable.input_start
    assert np.count_nonzero(inputs) == np.count_nonzero(list(cable.input_start.values()))
    columns = ("length", "mass", "inertia", "volume", "joint_stiffness", "joint_damping", "drag_area", "drag")
    for name, column in zip(columns, links.reshape(8, n), strict=True):
        np.testing.assert_array_equal(column, getattr(cable.links, name))
    np.testing.assert_array_equal(state, state_of_kernel)
    accessors = list(struct.iter_unpack("<II", data[HEADER.size + doubles.nbytes :]))
    assert accessors == [(v.kind, v.index) for v in variables]


@pytest.mark.parametrize(("choice", "number"), [("automatic", 0), ("explicit", 1), ("implicit", 2)])
@pytest.mark.parametrize(("initial", "start"), [("shape", 0), ("equilibrium", 1)])
def test_choices_stand_behind_the_counts(choice: str, number: int, initial: str, start: int) -> None:
    cable = replace(small_scene("load").cable, solver=SolverChoice(choice), initial=Initial(initial))
    assert struct.unpack_from("<II", resource_bytes(cable, variables_of(cable)), 48) == (number, start)


def test_the_token_is_a_uuid_of_the_content() -> None:
    tokens = {token_of(content) for content in (b"", b"a", b"b", b"a" * 1000)}
    assert len(tokens) == 4
    assert all(str(uuid.UUID(token)) == token.strip("{}") for token in tokens)
    # SHA-256 of "abc", FIPS 180-4: ba7816bf 8f01cfea 414140de 5dae2223 ...
    assert token_of(b"abc") == "{ba7816bf-8f01-cfea-4141-40de5dae2223}"
