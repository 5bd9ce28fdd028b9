"""The progress bar: only where somebody watches, and only if it takes long."""

from __future__ import annotations

import io
import sys

import pytest

from cablefmu import progress
from cablefmu.progress import showing_progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_nobody_watches_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with showing_progress("swing") as update:
        assert update is None


@pytest.mark.parametrize(("patience", "shown"), [(-1.0, True), (1e9, False)])
def test_a_bar_appears_when_patience_is_over(patience: float, shown: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(progress, "_PATIENCE", patience)
    with showing_progress("swing") as update:
        assert update is not None
        update(2.5, 10.0)
        update(5.0, 10.0)
    assert ("swing" in terminal.getvalue()) == shown
    assert ("t = 5.0 s" in terminal.getvalue()) == shown
