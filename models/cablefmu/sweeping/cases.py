"""The cases of a sweep: every scene with every line of the list, every point of the grid, every point of the sample."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ..scene_mistakes import Mistake
from .schema import MOST_CASES, FileSpec, SampleSpec

__all__ = ["Axes", "Case", "Given", "axes_of"]

Given = Mapping[str, float | str]
"""What a case sets, by name, in SI"""

_LARGEST_LIST = 100_000_000


@dataclass(frozen=True, slots=True)
class Case:
    """One run."""

    number: int
    """From 1 on, in the order of the table."""
    subject: str
    """Its scene (or coupling)"""
    given: Given


@dataclass(frozen=True, slots=True)
class Axes:
    """What varies; each a list of points, and a case has one of every list."""

    subjects: Sequence[str]
    listed: Sequence[Given] = field(default=({},))
    grid: Mapping[str, Sequence[float | str]] = field(default_factory=dict)
    sampled: Sequence[Given] = field(default=({},))

    @property
    def names(self) -> list[str]:
        """Of all values that vary, each once."""
        rows = itertools.chain(self.listed, [self.grid], self.sampled[:1])
        return list(dict.fromkeys(name for row in rows for name in row))

    def __len__(self) -> int:
        grid = math.prod(len(values) for values in self.grid.values())
        return len(self.subjects) * len(self.listed) * grid * len(self.sampled)

    def cases(self) -> Iterator[Case]:
        """All of them, scenes slowest, then list, grid (its last name fastest) and sample."""
        grid = [dict(zip(self.grid, values, strict=True)) for values in itertools.product(*self.grid.values())]
        products = itertools.product(self.subjects, self.listed, grid, self.sampled)
        for number, (subject, listed, point, sampled) in enumerate(products, start=1):
            yield Case(number, subject, {**listed, **point, **sampled})

    def settings(self) -> Iterator[tuple[str, float | str]]:
        """Every name with every value that matters to whether it is allowed: of a sample its least and largest."""
        yield from dict.fromkeys((name, value) for row in self.listed for name, value in row.items())
        for name, values in self.grid.items():
            yield from dict.fromkeys((name, value) for value in values)
        for name in self.sampled[0]:
            values = [row[name] for row in self.sampled]
            yield from ((name, pick(values)) for pick in (min, max))


def axes_of(spec: FileSpec, folder: Path) -> tuple[Axes, list[Mistake]]:
    """What a file asks for, and what is wrong with it: names twice, an unreadable list, no cases or too many."""
    mistakes: list[Mistake] = []
    listed: Sequence[Given] = ({},)
    if spec.list is not None:
        try:
            listed = _read_list(folder / spec.list.file)
        except (OSError, ValueError) as error:
            mistakes.append(Mistake("list.file", str(error), spec.list.file))
    sampled = _sampled(spec.sample) if spec.sample else ({},)
    axes = Axes(spec.scenes or (spec.coupling or "",), listed, spec.grid, sampled)
    in_list = {name for row in listed for name in row}
    places = {"set": spec.set, "list": in_list, "grid": spec.grid, "sample.ranges": sampled[0]}
    for name in dict.fromkeys([*axes.names, *spec.set]):
        found = [key for key, names in places.items() if name in names]
        if len(found) > 1:
            mistakes.append(Mistake(f"{found[1]}.{name}", f"it is in {found[0]} as well; one of them is expected"))
    for k, scene in enumerate(axes.subjects):
        if scene in axes.subjects[:k]:
            mistakes.append(Mistake("scenes", "this scene was named before; once is allowed", scene))
    if not axes.names and len(axes.subjects) == 1 and not mistakes:
        text = "nothing varies: grid, list or sample is expected, or several scenes"
        mistakes.append(Mistake("", text))
    if len(axes) > MOST_CASES:
        mistakes.append(Mistake("", f"{len(axes):,} cases; at most {MOST_CASES:,} are allowed"))
    return axes, mistakes


def _sampled(spec: SampleSpec) -> list[Given]:
    """Points of a Latin hypercube: in every direction one in each of `count` equal intervals."""
    from scipy.stats import qmc  # takes long to load, and most commands need none

    low, high = zip(*spec.ranges.values(), strict=True)
    points = qmc.scale(qmc.LatinHypercube(len(low), rng=spec.seed).random(spec.count), low, high)
    return [dict(zip(spec.ranges, point, strict=True)) for point in points.tolist()]


def _read_list(path: Path) -> list[Given]:
    """Rows of a CSV file; numbers where they are some, else words."""
    if not path.is_file():
        raise ValueError("there is no such file")
    if path.stat().st_size > _LARGEST_LIST:
        raise ValueError(f"is larger than {_LARGEST_LIST // 1_000_000} MB")
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = [[field.strip() for field in row] for row in csv.reader(file, strict=True) if row]
    head = rows[0] if rows else []
    if not head or not all(head) or len(set(head)) < len(head):
        raise ValueError("its first line must name what is set, each name once, for example M_1,Cd")
    if len(rows) < 2:
        raise ValueError("it has no cases; a line with values is expected below the names")
    for k, row in enumerate(rows, start=1):
        if len(row) != len(head):
            raise ValueError(f"line {k} has {len(row)} fields; {len(head)} are expected")
    return [{name: _number_or_word(text) for name, text in zip(head, row, strict=True) if text} for row in rows[1:]]


def _number_or_word(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
