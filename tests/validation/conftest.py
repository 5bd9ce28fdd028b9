"""All checks, worked out once a session, for the tests and the page."""

from __future__ import annotations

import ctypes

import pytest

from tests.validation.checks import Section
from tests.validation.page import all_sections


@pytest.fixture(scope="session")
def sections(library: ctypes.CDLL) -> dict[str, Section]:
    """Every section of the page by its title."""
    return {section.title: section for section in all_sections(library)}
