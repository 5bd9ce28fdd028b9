"""A progress bar for runs that take long enough to wonder, at a terminal only."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

__all__ = ["showing_progress"]

_PATIENCE = 1.0  # seconds before a bar appears


@contextmanager
def showing_progress(name: str) -> Iterator[Callable[[float, float], None] | None]:
    """A call-back for `simulate`: simulated time and stop time [s]. None where nobody watches."""
    if not sys.stderr.isatty():
        yield None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("t = {task.completed:.1f} s"),
        TimeRemainingColumn(),
    )
    bar = Progress(*columns, console=Console(stderr=True), transient=True)
    task = bar.add_task(name, total=None)
    begun, shown = time.monotonic(), False

    def update(simulated: float, stop_time: float) -> None:
        nonlocal shown
        if not shown and time.monotonic() - begun > _PATIENCE:
            bar.start()
            shown = True
        if shown:
            bar.update(task, completed=simulated, total=stop_time)

    try:
        yield update
    finally:
        if shown:
            bar.stop()
