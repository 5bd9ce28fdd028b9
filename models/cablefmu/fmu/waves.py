"""The FMU of a sea, built by pythonfmu: FMI 2, Co-Simulation.

The slave itself is fmu_src/partners/waves.py, which travels in the package's binaries/partners. It adds up Fourier
series whose coefficients are found here: resources/series.npy, and resources/waves.json on what they are of.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..cable import Floats
from ..errors import OptionError
from ..files import check_writable, replacing
from ..wave_trains import Train, profiles
from ..waves import LARGEST_SEED, AiryTable, IrregularTable, RegularTable, Waves
from .archive import write_zip
from .description import model_identifier
from .python_slave import described, partner_module, slave_members
from .variables import FRAME, Kind, Variable

__all__ = ["build_waves", "waves_variables"]

_REMARK = "The host's Python must have numpy installed."


def build_waves(waves: Waves | Mapping[str, Any], output: str | Path | None = None) -> Path:
    """Build a sea's FMU: FMI 2, Co-Simulation, with a state that can be taken, put back and serialized.

    Parameters
    ----------
    waves
        A sea, or a table of one (see `Waves.from_table`).
    output
        File to write; by default ./build/NAME.fmu. An existing file is replaced.

    Returns
    -------
    Path
        Of the archive. Its host must offer a Python with numpy; neither `cablefmu` nor the libraries that found the
        waves need be installed there.

    Raises
    ------
    WavesError
        If the table is not in order.
    OptionError
        If the sea's name is empty, the file cannot be written, or a library that the sea needs is not installed.
    """
    if not isinstance(waves, Waves):
        waves = Waves.from_table(waves)
    if not waves.name or not waves.name.isprintable():
        raise OptionError(f"name = {waves.name!r}: a name of one line is expected for a sea")
    path = Path(output) if output is not None else Path("build") / f"{waves.name}.fmu"
    check_writable(path)
    members = _members(waves)
    with replacing(path) as temporary:
        write_zip(temporary, members)
    return path


def _members(waves: Waves) -> dict[str, bytes]:
    script, module = partner_module("waves")
    variables = waves_variables(waves)
    beside = {
        "waves.json": json.dumps(_about(waves, variables), indent=1).encode(), "series.npy": _bytes_of(_series(waves))
    }  # fmt: skip
    members = slave_members(script, module=module, beside=beside)
    description = f"{_WHAT[waves.table.kind]} {_REMARK}"
    return described(members, name=waves.name, description=description, variables=variables)


_WHAT = {
    "airy": "A regular sea of linear theory.",
    "stokes": "A regular sea of Stokes' theory.",
    "fenton": "A regular sea of the stream function theory.",
    "jonswap": "An irregular sea under a JONSWAP spectrum.",
    "pierson-moskowitz": "An irregular sea under a Pierson-Moskowitz spectrum.",
}


def _about(waves: Waves, variables: list[Variable]) -> dict[str, Any]:
    """What the slave reads."""
    height = next((name for name in ("height", "significant_height") if name in {v.name for v in variables}), None)
    parameters = [
        {"name": v.name, "causality": v.causality, "start": v.start, "least": v.minimum, "most": v.maximum}
        for v in variables if v.causality == "parameter"
    ]  # fmt: skip
    outputs = [
        {"name": v.name, "causality": v.causality, "series": v.index, "rate": v.name.startswith("a")}
        for v in variables if v.causality == "output"
    ]  # fmt: skip
    return {
        "identifier": model_identifier(waves.name),
        "period": waves.train.period,
        "first": waves.train.first,
        "height": height,
        "variables": [*parameters, *outputs],
    }


def _bytes_of(array: Floats) -> bytes:
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    return file.getvalue()


# --- series: of each point elevation, and velocity along x and along y; acceleration is velocity's derivative ---


def _kinds(waves: Waves) -> tuple[str, ...]:
    moves = {"velocity", "acceleration"} & set(waves.table.outputs)
    return (*(("elevation",) if "elevation" in waves.table.outputs else ()), *(("vx", "vy") if moves else ()))


def _series(waves: Waves) -> Floats:
    """Coefficients of cosines and sines at phase 0, of shape (series, 2, waves), points in order."""
    return np.array([pair[kind] for pair in _of_points(waves) for kind in _kinds(waves)])


def _of_points(waves: Waves) -> list[dict[str, Floats]]:
    way = -1.0 if waves.table.direction else 1.0
    return [_of_point(waves.train, point.x, point.y, way) for point in waves.table.points]


def _of_point(train: Train, x: float, y: float, way: float) -> dict[str, Floats]:
    """With theta = way k x - omega t: cos(theta) = p cos(omega t) + q sin(omega t), sin(theta) = q cos - p sin."""
    p, q = np.cos(way * train.k * x), np.sin(way * train.k * x)
    along, down = profiles(train.k, max(y, -train.reach), train.depth)  # above that as there
    u, w = way * train.speed * along, train.speed * down
    return {
        "elevation": np.array([train.elevation * p, train.elevation * q]),
        "vx": np.array([u * p, u * q]),
        "vy": np.array([-w * q, w * p]),  # sin(theta) is up
    }


# --- variables ---


def waves_variables(waves: Waves) -> list[Variable]:
    """All variables of a sea's FMU, the value reference being the place in the list."""
    variables: list[Variable] = []
    for name, unit, start, least, most, text in _parameters(waves):
        variables.append(Variable(
            len(variables), name, Kind.PARAMETER, 0, unit, f"{text}; {FRAME}", causality="parameter",
            variability="fixed", initial="exact", start=start, minimum=least, maximum=most,
        ))  # fmt: skip
    kinds = _kinds(waves)
    for k, point in enumerate(waves.table.points):
        where = f"at x = {point.x:g} m, y = {point.y:g} m"
        for name, place, unit, text in _outputs(waves):
            series = k * len(kinds) + kinds.index(place)
            variables.append(Variable(
                len(variables), f"{name}[{k + 1}]", Kind.OUTPUT, series, unit, f"{text} {where}; {FRAME}",
                causality="output", variability="continuous", initial="calculated", nominal=1.0, depends_on=(),
                on_all_at_start=True,
            ))  # fmt: skip
    return variables


def _outputs(waves: Waves) -> list[tuple[str, str, str, str]]:
    """Name, its series, unit and description."""
    velocity, acceleration = "Orbital velocity of the water", "Time derivative of the water's orbital velocity"
    every = {
        "elevation": [("elevation", "elevation", "m", "Elevation of the surface, positive UP,")],
        "velocity": [
            ("vx", "vx", "m/s", f"{velocity} along x, positive to the right,"),
            ("vy", "vy", "m/s", f"{velocity} along y, positive down,"),
        ],
        "acceleration": [
            ("ax", "vx", "m/s2", f"{acceleration} along x, positive to the right,"),
            ("ay", "vy", "m/s2", f"{acceleration} along y, positive down,"),
        ],
    }
    return [entry for name in waves.table.outputs for entry in every[name]]


def _parameters(waves: Waves) -> list[tuple[str, str, float, float, float, str]]:
    """Name, unit, value, least, most, description."""
    table, limit = waves.table, waves.train.limit
    listed = [("ramp", "s", table.ramp, 0.0, 1e15, "Time from 0 in which the sea grows from nothing; 0: at once")]
    if isinstance(table, IrregularTable):
        height, seed = table.significant_height, float(table.seed)
        text = "Four times the standard deviation of the elevation"
        listed.append(("significant_height", "m", height, 0.0, limit, text))
        text = "Whole number that the phases are made of; another one is another sea of the same spectrum"
        listed.append(("seed", "1", seed, 0.0, float(LARGEST_SEED), text))
    if isinstance(table, RegularTable):
        if isinstance(table, AiryTable):
            listed.append(("height", "m", table.height, 0.0, limit, "From trough to crest"))
        text = "Phase of the wave at x = 0 at time 0; 0: a crest"
        listed.append(("phase", "rad", table.phase, -2.0 * math.pi, 2.0 * math.pi, text))
    return listed
