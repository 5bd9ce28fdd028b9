"""Input signals: forces and motions as functions of time [N or m over s].

Every signal is right-continuous: at a jump it has the value that it keeps afterwards. Integrators need
more than values: implicit ones the time derivative, the co-simulation master exact derivatives for FMI's
input derivatives, and both the times at which they must end a step.
"""

from __future__ import annotations

import csv
import io
import math
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import ClassVar, Protocol

from scipy.interpolate import CubicSpline

__all__ = ["Constant", "CsvError", "Derivative", "Sampled", "Signal", "Sine", "Spline", "Steps", "read_csv"]


class Signal(Protocol):
    """A force [N], or a coordinate [m], over time [s]."""

    @property
    def degree(self) -> int | None:
        """Of the polynomial that it is between two breaks; None if it is none."""
        ...

    def __call__(self, t: float) -> float:
        """Value at `t`; at a jump the value after it."""
        ...

    def derivatives(self, t: float, order: int) -> list[float]:
        """Right-hand time derivatives of order 1 ... `order` at `t` [N/s, N/s^2, ...]."""
        ...

    def breaks(self, t0: float, t1: float) -> list[float]:
        """Times inside the open interval (t0, t1) where the signal or its slope jumps, ascending."""
        ...


@dataclass(frozen=True, slots=True)
class Constant:
    """The same force at all times."""

    value: float
    degree: ClassVar[int] = 0

    def __call__(self, t: float) -> float:
        return self.value

    def derivatives(self, t: float, order: int) -> list[float]:
        return [0.0] * order

    def breaks(self, t0: float, t1: float) -> list[float]:
        return []


@dataclass(frozen=True, slots=True)
class Sine:
    """offset + amplitude sin(2 pi frequency (t - start) + phase); only `offset` before `start`.

    Without a start (None) the sine has always been there, with its phase counted from t = 0.
    """

    amplitude: float
    frequency: float
    """[Hz]"""
    phase: float = 0.0
    """[rad]"""
    offset: float = 0.0
    start: float | None = None
    degree: ClassVar[None] = None

    def _angle(self, t: float) -> float:
        return 2.0 * math.pi * self.frequency * (t - (self.start or 0.0)) + self.phase

    def __call__(self, t: float) -> float:
        if self.start is not None and t < self.start:
            return self.offset
        return self.offset + self.amplitude * math.sin(self._angle(t))

    def derivatives(self, t: float, order: int) -> list[float]:
        if self.start is not None and t < self.start:
            return [0.0] * order
        angle, rate = self._angle(t), 2.0 * math.pi * self.frequency
        # d^k sin/dx^k repeats after four: cos, -sin, -cos, sin
        cycle = (math.cos(angle), -math.sin(angle), -math.cos(angle), math.sin(angle))
        return [self.amplitude * rate**k * cycle[(k - 1) % 4] for k in range(1, order + 1)]

    def breaks(self, t0: float, t1: float) -> list[float]:
        return [self.start] if self.start is not None and t0 < self.start < t1 else []


@dataclass(frozen=True, slots=True)
class Steps:
    """Piecewise constant: 0 before the first time, then values[k] from times[k] on."""

    times: tuple[float, ...]
    values: tuple[float, ...]
    degree: ClassVar[int] = 0

    def __call__(self, t: float) -> float:
        k = bisect_right(self.times, t)
        return self.values[k - 1] if k else 0.0

    def derivatives(self, t: float, order: int) -> list[float]:
        return [0.0] * order

    def breaks(self, t0: float, t1: float) -> list[float]:
        return _inside(self.times, t0, t1)


@dataclass(frozen=True, slots=True)
class Sampled:
    """Linear between samples; before the first and after the last sample it keeps their values."""

    times: tuple[float, ...]
    values: tuple[float, ...]
    degree: ClassVar[int] = 1

    def _slope(self, k: int) -> float:
        """Slope after sample k - 1, that is from there to sample k [N/s]."""
        if k == 0 or k == len(self.times):
            return 0.0
        return (self.values[k] - self.values[k - 1]) / (self.times[k] - self.times[k - 1])

    def __call__(self, t: float) -> float:
        k = bisect_right(self.times, t)
        if k == 0:
            return self.values[0]
        return self.values[k - 1] + self._slope(k) * (t - self.times[k - 1]) if k < len(self.times) else self.values[-1]

    def derivatives(self, t: float, order: int) -> list[float]:
        slope = self._slope(bisect_right(self.times, t))
        return [slope if k == 1 else 0.0 for k in range(1, order + 1)]

    def breaks(self, t0: float, t1: float) -> list[float]:
        return _inside(self.times, t0, t1)


class Spline:
    """The cubic spline through samples, at rest before the first and after the last: a motion with an acceleration.

    Parameters
    ----------
    times, values
        Two or more; times rise.
    """

    degree = 3

    def __init__(self, times: tuple[float, ...], values: tuple[float, ...]) -> None:
        self.times, self.values = times, values
        # One cell at a time, 40 times as fast as scipy's own evaluation, which is made for arrays.
        self._cells: list[list[float]] = CubicSpline(times, values, bc_type="clamped").c.T.tolist()

    def __call__(self, t: float) -> float:
        t = min(max(t, self.times[0]), self.times[-1])
        since, (a, b, c, d) = self._cell(t)
        return ((a * since + b) * since + c) * since + d

    def derivatives(self, t: float, order: int) -> list[float]:
        if not self.times[0] <= t < self.times[-1]:
            return [0.0] * order
        since, (a, b, c, _) = self._cell(t)
        first = (3.0 * a * since + 2.0 * b) * since + c
        return [first, 6.0 * a * since + 2.0 * b, 6.0 * a, *[0.0] * (order - 3)][:order]

    def breaks(self, t0: float, t1: float) -> list[float]:
        return _inside(self.times, t0, t1)

    def _cell(self, t: float) -> tuple[float, list[float]]:
        """Time since the sample before [s], and the cubic's coefficients from there, highest power first."""
        k = min(bisect_right(self.times, t), len(self._cells)) - 1
        return t - self.times[k], self._cells[k]


@dataclass(frozen=True, slots=True)
class Derivative:
    """A time derivative of another signal: what a motion's velocity and acceleration are to its place."""

    of: Signal
    order: int
    """1 for the velocity, 2 for the acceleration"""

    @property
    def degree(self) -> int | None:
        return None if self.of.degree is None else max(0, self.of.degree - self.order)

    def __call__(self, t: float) -> float:
        return self.of.derivatives(t, self.order)[-1]

    def derivatives(self, t: float, order: int) -> list[float]:
        return self.of.derivatives(t, self.order + order)[self.order :]

    def breaks(self, t0: float, t1: float) -> list[float]:
        return self.of.breaks(t0, t1)


def _inside(times: tuple[float, ...], t0: float, t1: float) -> list[float]:
    return list(times[bisect_right(times, t0) : bisect_left(times, t1)])


class CsvError(ValueError):
    """What is wrong with a CSV file, with its line."""


Column = str | int


def read_csv(data: bytes, *, time: Column = 1, value: Column = 2) -> Sampled:
    """Read a signal from comma-separated text: times [s], rising, and forces [N].

    Parameters
    ----------
    data
        Content of the file, UTF-8. The first line may be a header (no number in it); empty lines are passed over.
    time, value
        Columns, by name in the header or by number from 1.

    Raises
    ------
    CsvError
        If the text is no table of finite numbers, has no such column, or its times do not rise.
    """
    try:
        rows = [(k, row) for k, row in enumerate(csv.reader(io.StringIO(data.decode("utf-8-sig"))), 1) if any(row)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise CsvError(f"this is not a comma-separated text in UTF-8: {error}") from None
    header = [cell.strip() for cell in rows[0][1]] if rows and not any(map(_is_number, rows[0][1])) else None
    if header is not None:
        rows = rows[1:]
    if not rows:
        raise CsvError("there is no line with numbers in it")
    columns = [_column(header, time, len(rows[0][1])), _column(header, value, len(rows[0][1]))]
    times, values = (tuple(_cell(row, line, column) for line, row in rows) for column in columns)
    for k in range(1, len(times)):
        if times[k] <= times[k - 1]:
            raise CsvError(f"row {rows[k][0]}: time {times[k]:g} s does not come after {times[k - 1]:g} s")
    return Sampled(times, values)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _column(header: list[str] | None, wanted: Column, width: int) -> int:
    """Index of a column that is given by name or by number from 1."""
    if isinstance(wanted, int):
        if 1 <= wanted <= width:
            return wanted - 1
        raise CsvError(f"there is no column {wanted}; columns, set off by commas, are numbered 1 to {width}")
    if header is None:
        raise CsvError(f'there is no column "{wanted}", as the first line has no names')
    if wanted not in header:
        raise CsvError(f'there is no column "{wanted}"; the columns are {", ".join(header)}')
    return header.index(wanted)


# Same bound as for quantities in a scene, and beyond any force or time that means something.
_LARGEST = 1e15


def _cell(row: list[str], line: int, column: int) -> float:
    text = row[column].strip() if column < len(row) else ""
    number = float(text) if _is_number(text) else math.nan
    if not abs(number) <= _LARGEST:
        raise CsvError(f'row {line}, column {column + 1}: a finite number is expected, there is "{text[:40]}"')
    return number
