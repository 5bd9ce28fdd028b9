"""Vessels as tables: what moves a cable's fairlead in the plane, in one of several kinds.

A vessel follows sines, or samples from a CSV file, or is a rigid body on springs and dampers that the cable pulls at,
or floats in waves; of one that is held the force of waves alone is told. The table is one of a coupling's or of a
user's own TOML file, with values in SI or as texts with units. Whatever is wrong with it is said at once, in one
`VesselError`. SI, x to the right, y down, both from the rest position.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BeforeValidator, StrictStr, ValidationError, ValidationInfo, field_validator

from cablefmu import units as u
from cablefmu.errors import VesselError
from cablefmu.hydrodynamics.database import SHIPPED, DatabaseError, Hydrodynamics, read_database, shipped_database
from cablefmu.scene_mistakes import Mistake, mistakes_of, nearest
from cablefmu.scene_table import Context, Table, context_of
from cablefmu.signals import CsvError, Sampled, read_csv

__all__ = ["BodyTable", "CsvTable", "ExcitationTable", "FloatingTable", "SineTable", "SinesTable", "Vessel"]

FEWEST_SAMPLES = 4
"""Of a cubic spline that needs no condition at its ends (not-a-knot)."""

_LARGEST_FILE = 100_000_000

Displacement = Annotated[float, u.Measure("a displacement", "m", '1.5 or "1.5 m"')]
Velocity = Annotated[float, u.Measure("a velocity", "m/s", '0.5 or "0.5 m/s"')]
Ramp = Annotated[float, u.Measure("a time", "s", '10 or "10 s"', 0.0)]


class SineTable(Table):
    """amplitude sin(2 pi frequency t + phase)."""

    one_of = (("frequency", "period"),)

    amplitude: Displacement
    frequency: u.Frequency | None = None
    period: u.Duration | None = None
    phase: u.AngleOffset = 0.0
    """At time 0."""

    @property
    def hertz(self) -> float:
        """Frequency [Hz], whichever way it was given."""
        return u.hertz(self.frequency, self.period)


def _listed(value: object) -> object:
    """One sine may stand without the brackets of a list."""
    if value == []:
        raise u.refusal("a list with at least one sine is expected")
    return [value] if isinstance(value, dict) else value


Sines = Annotated[tuple[SineTable, ...], BeforeValidator(_listed)]


class SinesTable(Table):
    """Motion that is given: a sum of sines along each axis."""

    kind: Literal["sines"]
    x: Sines | None = None
    """Along x, to the right; it stays at rest where there is none."""
    y: Sines | None = None
    """Along y, down."""
    ramp: Ramp = 0.0
    """Time from 0 in which the motion grows from nothing to its size, smooth to its acceleration; 0: at once."""

    @classmethod
    def contradictions(cls, data: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], str]]:
        if "x" not in data and "y" not in data:
            yield (
                (),
                "nothing moves: x, y or both are needed, each a table with amplitude and frequency, or a list of such",
            )


class CsvTable(Table):
    """Motion that is given: samples from a file, with a cubic spline through them."""

    kind: Literal["csv"]
    file: StrictStr
    """Comma-separated, UTF-8, in s and m; the first line names its columns time, x and y."""

    @field_validator("file")
    @classmethod
    def _readable(cls, file: str, info: ValidationInfo) -> str:
        context = context_of(info)
        if context is not None:
            try:
                read_samples(context.read(file))
            except CsvError as mistake:
                raise u.refusal(str(mistake)) from None
        return file


def _extrapolation(value: object) -> object:
    if type(value) not in (int, str) or value not in get_args(Extrapolation):
        raise u.refusal('allowed: 0 (held), 1 (linear), 2 (quadratic), or "given" (by inputs der(F_x) ...)')
    return value


Extrapolation = Literal[0, 1, 2, "given"]


class _MovedTable(Table):
    """What all bodies that forces move have in common."""

    c_x: u.Damping = 0.0
    c_y: u.Damping = 0.0
    k_x: u.Stiffness = 0.0
    """Of the spring about the rest position."""
    k_y: u.Stiffness = 0.0
    external_x: u.Force = 0.0
    """Constant force from outside, to the right."""
    external_y: u.Force = 0.0
    """Constant force from outside, down."""
    static_load_x: u.Force = 0.0
    """The pull of the cable to the right that the mooring carries at rest."""
    static_load_y: u.Force = 0.0
    """The pull of the cable downward that buoyancy carries at rest."""
    x_0: Displacement = 0.0
    """At the start, from the rest position."""
    y_0: Displacement = 0.0
    vx_0: Velocity = 0.0
    """At the start."""
    vy_0: Velocity = 0.0
    extrapolation: Annotated[Extrapolation, BeforeValidator(_extrapolation)] = 0
    """How inputs go on within a communication step: order of a polynomial through their last values."""


class BodyTable(_MovedTable):
    """m q'' + c q' + k q = F + external - static_load along each axis; F is the force that the cable exerts."""

    kind: Literal["body"]
    m_x: u.Mass
    """What has to be moved along x, with the water that goes along (added mass)."""
    m_y: u.Mass


def _known_body(body: str, info: ValidationInfo) -> str:
    """Body that ships, or a file of coefficients that can be read."""
    context = context_of(info)
    if context is not None:
        try:
            database_of(body, context.read)
        except (CsvError, DatabaseError) as mistake:
            raise u.refusal(str(mistake)) from None
    return body


def _symmetric(points: tuple[float, ...]) -> tuple[float, ...]:
    rising = all(a < b for a, b in pairwise(points))
    if not points or not rising or any(a != -b for a, b in zip(points, reversed(points), strict=True)):
        raise u.refusal("places that rise and lie alike on both sides of 0 are expected, for example [-1.0, 0.0, 1.0]")
    return points


Body = Annotated[StrictStr, AfterValidator(_known_body)]
Points = Annotated[tuple[Displacement, ...], AfterValidator(_symmetric)]


class FloatingTable(_MovedTable):
    """A body that floats in waves and radiates them, in surge and heave, by the coefficients of a database."""

    kind: Literal["floating"]
    body: Body
    """"buoy", "barge", or a NetCDF file."""
    mass: u.Mass | None = None
    """What moves, without water; as much as is displaced where it is not given."""
    points: Points | None = None
    """Places along x where the elevation is an input; those that the database names where they are not given."""


class ExcitationTable(Table):
    """The same body held at its rest position: the force of waves on it, and no motion."""

    kind: Literal["excitation"]
    body: Body
    points: Points | None = None
    extrapolation: Annotated[Extrapolation, BeforeValidator(_extrapolation)] = 0
    """How elevations go on within a communication step."""


def database_of(body: str, read: Callable[[str], bytes]) -> Hydrodynamics:
    """Coefficients of a body that ships, or of the file that `body` names."""
    if body not in SHIPPED and not body.endswith(".nc"):
        raise DatabaseError(f"{nearest(body, SHIPPED)}, or a NetCDF file NAME.nc")
    return read_database(shipped_database(body) if body in SHIPPED else read(body))


VesselTable = BodyTable | SinesTable | CsvTable | FloatingTable | ExcitationTable
_KINDS: dict[str, type[VesselTable]] = {
    "body": BodyTable, "sines": SinesTable, "csv": CsvTable, "floating": FloatingTable, "excitation": ExcitationTable
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Vessel:
    """One vessel: what its table says, and the samples that it names."""

    name: str
    """Names its FMU."""
    table: VesselTable
    samples: Mapping[str, tuple[float, ...]]
    """Of kind "csv": time [s], x and y [m], of equal length; else none."""
    hydrodynamics: Hydrodynamics | None = None
    """Of kinds "floating" and "excitation"."""

    @classmethod
    def from_table(
        cls, table: object, *, name: str = "vessel", folder: str | Path = ".", source: str = "vessel"
    ) -> Vessel:
        """Make a vessel of a table as a TOML file has it.

        Parameters
        ----------
        table
            With `kind` ("body", "sines", "csv", "floating" or "excitation") and the keys of that kind.
        name
            Of the vessel; its FMU is called so.
        folder
            Where paths of files begin.
        source
            What messages call the table, for example "towing.toml: model.vessel".

        Raises
        ------
        VesselError
            With one line for every mistake: source, key, value, what is allowed.
        """
        files: dict[str, bytes] = {}

        def read(file: str) -> bytes:
            if file not in files:
                files[file] = _read(Path(folder) / file)
            return files[file]

        made = _validated(table, Context(None, read), source)
        samples = read_samples(read(made.file)) if isinstance(made, CsvTable) else {}
        body = made.body if isinstance(made, FloatingTable | ExcitationTable) else None
        return cls(name, made, samples, None if body is None else database_of(body, read))


def _validated(table: object, context: Context, source: str) -> VesselTable:
    if not isinstance(table, dict):
        raise _error(source, [Mistake("", "a table is expected")])
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in _KINDS:
        text = nearest(kind, _KINDS) if isinstance(kind, str) else f"allowed: {', '.join(_KINDS)}"
        mistake = Mistake("kind", text, kind) if "kind" in table else Mistake("kind", f"this key is missing; {text}")
        raise _error(source, [mistake])
    try:
        return _KINDS[kind].model_validate(table, context=context)
    except ValidationError as error:
        raise _error(source, mistakes_of(error, _KINDS[kind])) from None


def _error(source: str, mistakes: list[Mistake]) -> VesselError:
    return VesselError("\n".join(f"{source}.{m.line()}" if m.key else f"{source}: {m.line()}" for m in mistakes))


def _read(path: Path) -> bytes:
    """Content of a regular file of sensible size."""
    try:
        if not path.is_file():
            raise CsvError("there is no such file")
        if path.stat().st_size > _LARGEST_FILE:
            raise CsvError(f"the file is larger than {_LARGEST_FILE // 1_000_000} MB")
        return path.read_bytes()
    except (OSError, ValueError) as error:
        raise error if isinstance(error, CsvError) else CsvError(f"cannot be read: {error}") from None


def read_samples(data: bytes) -> dict[str, tuple[float, ...]]:
    """Times [s] and displacements x, y [m] out of comma-separated text.

    Raises
    ------
    CsvError
        If it is no table of finite numbers with the columns time, x and y, has fewer than four lines of them, or its
        times do not rise.
    """
    columns: dict[str, Sampled] = {axis: read_csv(data, time="time", value=axis) for axis in ("x", "y")}
    times = columns["x"].times
    if len(times) < FEWEST_SAMPLES:
        raise CsvError(f"a curve needs at least {FEWEST_SAMPLES} lines of numbers; there are {len(times)}")
    return {"time": times, **{axis: column.values for axis, column in columns.items()}}
