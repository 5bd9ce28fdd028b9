"""What `import cablefmu` offers: every error that can be raised, all of it described on a page."""

from __future__ import annotations

import re
from pathlib import Path

import cablefmu
from cablefmu import errors

API = Path(__file__).parents[1] / "docs" / "site" / "api.md"


def test_every_error_can_be_caught_by_its_name() -> None:
    assert set(errors.__all__) <= set(cablefmu.__all__)
    assert all(getattr(cablefmu, name) is getattr(errors, name) for name in errors.__all__)


def test_all_of_it_is_on_the_page() -> None:
    described = re.findall(r"^\.\. auto(?:function|class|exception):: (\w+)$", API.read_text("utf-8"), re.MULTILINE)
    assert sorted([*described, "__version__"]) == sorted(cablefmu.__all__)
