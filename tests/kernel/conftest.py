"""The kernel, compiled once a session (once a worker: each has a temporary folder of its own)."""

from __future__ import annotations

import ctypes

import pytest

from tests.kernel.library import compile_kernel, load


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """Kernel and probe with the release's flags."""
    return load(compile_kernel(tmp_path_factory.mktemp("kernel")))
