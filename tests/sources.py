"""Copies of the C sources with exact texts replaced: without a feature, or with a planted defect."""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Change", "changed_copy"]

_ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Change:
    """One text in place of another."""

    file: str
    """In fmu_src/kernel"""
    old: str
    """Stands there exactly once"""
    new: str


def changed_copy(folder: Path, changes: Iterable[Change]) -> Path:
    """fmu_src and the tests' own C files below `folder`, with the changes made in order; returns the folder.

    Raises
    ------
    ValueError
        Where a text does not stand exactly once: the sources have moved on, and the change has to follow them.
    """
    shutil.copytree(_ROOT / "fmu_src", folder / "fmu_src", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (*(_ROOT / "tests").glob("*/*.c"), *(_ROOT / "tests").glob("*/*.h")):
        copy = folder / path.relative_to(_ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, copy)
    for change in changes:
        path = folder / "fmu_src" / "kernel" / change.file
        text = path.read_text(encoding="utf-8")
        if (count := text.count(change.old)) != 1:
            raise ValueError(f"{change.file} has {count} times, and should have once:\n{change.old}")
        path.write_text(text.replace(change.old, change.new), encoding="utf-8")
    return folder
