"""Seas as tables: regular waves (linear, Stokes', Fenton's) and irregular ones (JONSWAP, Pierson-Moskowitz).

The table is one of a coupling's or of a user's own TOML file, with values in SI or as texts with units. Whatever is
wrong with it is said at once, in one `WavesError`. SI, x to the right, y down from the still water level; elevations
are positive up, as everybody has them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BeforeValidator, ValidationError

from cablefmu import units as u
from cablefmu.errors import WavesError
from cablefmu.scene_mistakes import Mistake, MistakeFoundError, mistakes_of, nearest
from cablefmu.scene_table import Table
from cablefmu.wave_trains import Train, airy, irregular, nonlinear

__all__ = ["LARGEST_SEED", "OUTPUTS", "IrregularTable", "PointTable", "RegularTable", "Waves", "WavesTable"]

OUTPUTS = ("elevation", "velocity", "acceleration")
"""What an FMU can tell at a point."""

LARGEST_SEED = 2**53 - 1
"""Up to here a double holds every whole number, and the FMU's seed is one."""

_MOST_POINTS = 100

Ramp = Annotated[float, u.Measure("a time", "s", '60 or "1 min"', 0.0)]
Gravity = Annotated[float, u.Measure("an acceleration", "m/s^2", '9.81 or "9.81 m/s^2"', 0.0, positive=True)]
Gamma = Annotated[float, u.Measure("a peakedness (a plain number)", "", "3.3", 1.0, 10.0)]


def _whole(least: int, most: int) -> BeforeValidator:
    def read(value: object) -> object:
        if type(value) is not int or not least <= value <= most:
            raise u.refusal(f"a whole number from {least} to {most} is expected")
        return value

    return BeforeValidator(read)


def _one_way(value: object) -> float:
    angle = u.Measure("an angle", "rad", '0 or "180 deg"').read(value)
    if min(abs(angle), abs(angle - math.pi)) > 1e-6:
        raise u.refusal('waves travel along x: 0 (to the right) or "180 deg" is expected')
    return 0.0 if abs(angle) < 1.0 else math.pi


def _chosen(value: object) -> object:
    """Each at most once, in the one order that there is."""
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list | tuple) or not names or any(name not in OUTPUTS for name in names):
        raise u.refusal(f"a list of some of these is expected: {', '.join(OUTPUTS)}")
    return tuple(name for name in OUTPUTS if name in names)


def _some(value: object) -> object:
    if isinstance(value, list | tuple) and not 1 <= len(value) <= _MOST_POINTS:
        raise u.refusal(f"a list with 1 to {_MOST_POINTS} points is expected")
    return value


class PointTable(Table):
    """Where the sea is asked for."""

    x: u.Coordinate = 0.0
    """To the right."""
    y: u.Coordinate = 0.0
    """Down from the still water level."""


class _SeaTable(Table):
    """What all seas have."""

    points: Annotated[tuple[PointTable, ...], BeforeValidator(_some)] = (PointTable(),)
    outputs: Annotated[tuple[str, ...], BeforeValidator(_chosen)] = ("elevation",)
    """What the FMU tells at every point."""
    depth: u.Length | None = None
    """Of the still water; deep where it is not said."""
    direction: Annotated[float, BeforeValidator(_one_way)] = 0.0
    """0: the waves travel to +x; 180 degrees: to -x."""
    ramp: Ramp = 0.0
    """Time from 0 in which the sea grows from nothing to its size; 0: at once."""
    gravity: Gravity = 9.81

    @property
    def bottom(self) -> float:
        """Depth [m], infinite in deep water."""
        return math.inf if self.depth is None else self.depth

    def train(self) -> Train:
        """The waves that this sea is made of."""
        raise NotImplementedError


class RegularTable(_SeaTable):
    """One wave that comes again and again."""

    one_of = (("period", "frequency", "length"),)

    height: u.Length
    """From trough to crest."""
    period: u.Duration | None = None
    frequency: u.Frequency | None = None
    length: u.Length | None = None
    """From crest to crest."""
    phase: u.Angle = 0.0
    """0: a crest is at x = 0 at time 0."""

    @property
    def seconds(self) -> float | None:
        """Period [s], if that or the frequency is given."""
        return 1.0 / u.hertz(self.frequency, self.period) if self.length is None else None


class AiryTable(RegularTable):
    """Linear theory."""

    kind: Literal["airy"]

    def train(self) -> Train:
        return airy(self.height, self.seconds, self.length, self.bottom, self.gravity)


class StokesTable(RegularTable):
    """Stokes' expansion in the steepness."""

    kind: Literal["stokes"]
    order: Annotated[int, _whole(1, 5)] = 5

    def train(self) -> Train:
        return nonlinear("Stokes", self.height, self.seconds, self.length, self.bottom, self.gravity, self.order)


class FentonTable(RegularTable):
    """The stream function of Rienecker and Fenton."""

    kind: Literal["fenton"]
    order: Annotated[int, _whole(1, 20)] = 10
    """Number of harmonics."""

    def train(self) -> Train:
        return nonlinear("Fenton", self.height, self.seconds, self.length, self.bottom, self.gravity, self.order)


class IrregularTable(_SeaTable):
    """Many waves of random phases under a spectrum."""

    significant_height: u.Length
    """Four times the standard deviation of the elevation."""
    peak_period: u.Duration
    """Of the waves that carry most energy."""
    seed: Annotated[int, _whole(0, LARGEST_SEED)] = 1
    """Of the phases: another number, another sea of the same spectrum."""
    duration: u.Duration = 10_800.0
    """Time after which the sea begins again."""

    @property
    def peakedness(self) -> float | None:
        """gamma of the JONSWAP spectrum; None for Pierson and Moskowitz'."""
        return None

    def train(self) -> Train:
        return irregular(
            self.significant_height, self.peak_period, self.peakedness, self.duration, self.bottom, self.gravity
        )


class JonswapTable(IrregularTable):
    """A sea that still grows under the wind."""

    kind: Literal["jonswap"]
    gamma: Gamma = 3.3
    """By how much the peak is higher than Pierson and Moskowitz have it."""

    @property
    def peakedness(self) -> float | None:
        return self.gamma


class PiersonMoskowitzTable(IrregularTable):
    """A fully developed sea."""

    kind: Literal["pierson-moskowitz"]


WavesTable = AiryTable | StokesTable | FentonTable | JonswapTable | PiersonMoskowitzTable
_KINDS: dict[str, type[WavesTable]] = {
    "airy": AiryTable, "stokes": StokesTable, "fenton": FentonTable, "jonswap": JonswapTable,
    "pierson-moskowitz": PiersonMoskowitzTable,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Waves:
    """One sea: what its table says, and the waves that it is made of."""

    name: str
    """Names its FMU."""
    table: WavesTable
    train: Train

    @classmethod
    def from_table(cls, table: object, *, name: str = "sea", source: str = "waves") -> Waves:
        """Make a sea of a table as a TOML file has it.

        Parameters
        ----------
        table
            With `kind` ("airy", "stokes", "fenton", "jonswap" or "pierson-moskowitz") and the keys of that kind.
        name
            Of the sea; its FMU is called so.
        source
            What messages call the table, for example "buoy.toml: sea.waves".

        Raises
        ------
        WavesError
            With one line for every mistake: source, key, value, what is allowed. Waves that would break are refused
            once the table is in order.
        OptionError
            If a library that this kind needs is not installed.
        """
        made = _validated(table, source)
        try:
            train = made.train()
            _check_points(made)
        except MistakeFoundError as found:
            raise _error(source, [found.mistake]) from None
        return cls(name, made, train)


def _validated(table: object, source: str) -> WavesTable:
    if not isinstance(table, Mapping):
        raise _error(source, [Mistake("", "a table is expected")])
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in _KINDS:
        text = nearest(kind, _KINDS) if isinstance(kind, str) else f"allowed: {', '.join(_KINDS)}"
        mistake = Mistake("kind", text, kind) if "kind" in table else Mistake("kind", f"this key is missing; {text}")
        raise _error(source, [mistake])
    try:
        return _KINDS[kind].model_validate(dict(table))
    except ValidationError as error:
        raise _error(source, mistakes_of(error, _KINDS[kind])) from None


def _check_points(table: WavesTable) -> None:
    for k, point in enumerate(table.points, start=1):
        if point.y > table.bottom:
            raise MistakeFoundError(
                Mistake(f"points, entry {k}.y", f"this is below the seabed at {table.bottom:g} m", point.y)
            )


def _error(source: str, mistakes: list[Mistake]) -> WavesError:
    return WavesError("\n".join(f"{source}.{m.line()}" if m.key else f"{source}: {m.line()}" for m in mistakes))
