"""The binding table, the probe's source and the compiled library name the same functions."""

from __future__ import annotations

import ctypes
import re

from tests.kernel.library import BINDINGS, PROBE


def test_every_bound_name_is_exported(library: ctypes.CDLL) -> None:
    assert [name for name in BINDINGS if not hasattr(library, name)] == []


def test_every_function_of_the_probe_is_bound_with_all_its_arguments() -> None:
    """ctypes takes a call with a wrong number of arguments to an untyped function without a word."""
    found = re.findall(r"^(?!static)[\w ]+[ *](probe_\w+)\(([^)]*)\)$", PROBE.read_text(), re.MULTILINE)
    counts = {name: arguments.count(",") + 1 for name, arguments in found}
    assert counts == {name: len(types) - 1 for name, types in BINDINGS.items() if name.startswith("probe_")}
