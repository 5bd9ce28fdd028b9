"""What several tests of the kernel share."""

from __future__ import annotations

import ctypes

import pytest

from tests.kernel.rosenbrock import NAMES, Method, read


@pytest.fixture(params=NAMES)
def method(library: ctypes.CDLL, request: pytest.FixtureRequest) -> Method:
    """Each Rosenbrock method in turn."""
    method = read(library, NAMES.index(request.param))
    assert method.name == request.param
    return method
