"""resources/cable.bin, the numbers that the generic binary reads; its layout stands in resource.h."""

from __future__ import annotations

import hashlib
import struct

import numpy as np

from ..cable import Cable, Drag, Floats, Initial, SolverChoice, Terminal, Top, Whole
from .table import table
from .variables import Variable

__all__ = ["RESOURCE_NAME", "resource_bytes", "token_of"]

RESOURCE_NAME = "cable.bin"
_MAGIC = b"CABLEFMU"
_VERSION = 4


def resource_bytes(cable: Cable, variables: list[Variable], whole: Whole | None = None) -> bytes:
    """The file's content, little-endian.

    Parameters
    ----------
    cable
        The scene's numbers.
    variables
        The variable table, in order of value references.
    whole
        The cable before it is divided, in place of links and start, which the FMU works out then.
    """
    if whole:
        cable = whole.rest_of(cable)
    rows = table()
    present = sum(1 << rows.parameters[name].slot for name in cable.parameters)
    header = _MAGIC + struct.pack(
        "<IIIIQIIIIIIIIII",
        _VERSION, cable.n, list(Terminal).index(cable.terminal), list(Drag).index(cable.drag), present,
        len(rows.parameters), len(rows.inputs), len(rows.outputs), len(variables),
        list(SolverChoice).index(cable.solver), list(Initial).index(cable.initial),
        _shape(whole), len(rows.whole) if whole else 0,
        list(Top).index(cable.top), 0,
    )  # fmt: skip
    doubles = [
        [cable.parameters.get(name, 0.0) for name in rows.parameters],
        [cable.input_start.get(name, 0.0) for name in rows.inputs],
        cable.rest_position,
        *([[whole.parameters.get(name, 0.0) for name in rows.whole]] if whole else _listed(cable)),
    ]
    body = b"".join(np.asarray(values, dtype="<f8").tobytes() for values in doubles)
    accessors = b"".join(struct.pack("<II", variable.kind, variable.index) for variable in variables)
    return header + body + accessors


def _shape(whole: Whole | None) -> int:
    """Shape in resource.h: listed, straight or the catenary."""
    if whole is None:
        return 0
    return 1 if "theta_start" in whole.parameters else 2


def _listed(cable: Cable) -> list[Floats]:
    links = cable.links
    return [
        links.length, links.mass, links.inertia, links.volume,
        links.joint_stiffness, links.joint_damping, links.drag_area, links.drag,
        cable.padded(cable.position), cable.padded(cable.velocity),
    ]  # fmt: skip


def token_of(resource: bytes) -> str:
    """guid and instantiationToken: "{8-4-4-4-12}" of the first 16 bytes of the file's SHA-256."""
    digits = hashlib.sha256(resource).hexdigest()[:32]
    return "{" + "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:])) + "}"
