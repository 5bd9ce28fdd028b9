"""The table of variables as Python reads it and as the C compiler read it."""

from __future__ import annotations

import ctypes
from itertools import count, takewhile

import pytest

from cablefmu.fmu.table import table

LISTS = {
    0: list(table().parameters),
    1: list(table().inputs),
    2: list(table().outputs),
    3: [name.removeprefix("solver.") for name in table().solver],
}


@pytest.mark.parametrize("which", LISTS)
def test_names_order_and_count_are_those_of_the_enumeration(library: ctypes.CDLL, which: int) -> None:
    names = takewhile(bool, (library.probe_name(which, slot) for slot in count()))
    assert [name.decode() for name in names] == LISTS[which]


def test_slots_count_from_zero() -> None:
    for rows in (table().parameters, table().inputs, table().outputs, table().solver):
        assert [row.slot for row in rows.values()] == list(range(len(rows)))
