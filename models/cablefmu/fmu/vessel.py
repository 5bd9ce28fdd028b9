"""The FMU of a vessel, built by pythonfmu: FMI 2, Co-Simulation.

The slave itself is fmu_src/partners/vessel.py, with bodies.py for what forces move; both travel in the package's
binaries/partners. It reads what it is to do from resources/vessel.json, so that all vessels share one script.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..errors import OptionError
from ..files import check_writable, replacing
from ..vessel import BodyTable, CsvTable, ExcitationTable, FloatingTable, SinesTable, Vessel
from .archive import write_zip
from .description import model_identifier
from .python_slave import described, partner_module, slave_members
from .variables import FRAME, Kind, Variable
from .vessel_waves import in_waves, mass_of, places_of

__all__ = ["build_vessel", "vessel_variables"]

_RESOURCE = "vessel.json"
_REMARK = "The host's Python must have scipy installed."


def build_vessel(vessel: Vessel | Mapping[str, Any], output: str | Path | None = None) -> Path:
    """Build a vessel's FMU: FMI 2, Co-Simulation, with a state that can be taken, put back and serialized.

    Parameters
    ----------
    vessel
        A vessel, or a table of one (see `Vessel.from_table`); its files are then looked for from the present folder.
    output
        File to write; by default ./build/NAME.fmu. An existing file is replaced.

    Returns
    -------
    Path
        Of the archive. Its host must offer a Python with scipy; `cablefmu` need not be installed there.

    Raises
    ------
    VesselError
        If the table is not in order.
    OptionError
        If the vessel's name is empty, or the file cannot be written.
    """
    if not isinstance(vessel, Vessel):
        vessel = Vessel.from_table(vessel)
    if not vessel.name or not vessel.name.isprintable():
        raise OptionError(f"name = {vessel.name!r}: a name of one line is expected for a vessel")
    path = Path(output) if output is not None else Path("build") / f"{vessel.name}.fmu"
    check_writable(path)
    members = _members(vessel)
    with replacing(path) as temporary:
        write_zip(temporary, members)
    return path


def _members(vessel: Vessel) -> dict[str, bytes]:
    script, module = partner_module("vessel")
    variables = vessel_variables(vessel)
    about, beside = _about(vessel, variables), {}
    if not isinstance(vessel.table, SinesTable | CsvTable):
        bodies, about["module"] = partner_module("bodies")
        beside[f"{about['module']}.py"] = bodies
    beside[_RESOURCE] = json.dumps(about, indent=1).encode()
    members = slave_members(script, module=module, beside=beside)
    description = f"{_WHAT[vessel.table.kind]} {_REMARK}"
    return described(members, name=vessel.name, description=description, variables=variables)


_WHAT = {
    "body": "A vessel on springs and dampers that a cable pulls at; its fairlead moves in the plane.",
    "sines": "A vessel that follows sines; its fairlead moves in the plane.",
    "csv": "A vessel that follows samples by cubic splines; its fairlead moves in the plane.",
    "floating": "A vessel that floats in waves, in surge and heave, and that a cable pulls at.",
    "excitation": "The force of waves on a vessel that is held.",
}


def _about(vessel: Vessel, variables: list[Variable]) -> dict[str, Any]:
    """What the slave reads."""
    table = vessel.table
    about: dict[str, Any] = {
        "kind": table.kind,
        "identifier": model_identifier(vessel.name),
        "variables": [
            {"name": v.name, "causality": v.causality, "start": v.start, "least": _least(v)} for v in variables
        ],
    }
    match table:
        case BodyTable():
            about["extrapolation"] = table.extrapolation
        case SinesTable():
            about["sines"] = {"x": len(table.x or ()), "y": len(table.y or ())}
        case FloatingTable() | ExcitationTable():
            about["extrapolation"] = table.extrapolation
            about |= in_waves(vessel)
        case CsvTable():
            about |= {"file": Path(table.file).name, "samples": vessel.samples}
    return about


def _least(variable: Variable) -> str:
    """Lower bound: above 0 for what is divided by or must pass, 0 for what must not drive, none for the rest."""
    if variable.minimum is None:
        return "-inf"
    return "+0" if variable.unit in ("kg", "Hz") else "0"


# --- variables: a vessel has those of its kind alone ---

_AXES = {"x": "to the right", "y": "down"}
_OUTPUTS = {"": ("m", "Displacement of the fairlead from its rest position"),
            "v": ("m/s", "Velocity of the fairlead"), "a": ("m/s2", "Acceleration of the fairlead")}  # fmt: skip
_BODY = {
    "m": ("kg", 0.0, "Mass that moves along {axis}, with the water that goes along"),
    "c": ("N.s/m", 0.0, "Damping along {axis}"),
    "k": ("N/m", 0.0, "Stiffness about the rest position along {axis}"),
    "external": ("N", None, "Constant force from outside along {axis}, positive {way}"),
    "static_load": ("N", None, "Pull of the cable along {axis} that is carried at rest, positive {way}"),
}
_START = {
    "": ("m", "Displacement along {axis} at the start, positive {way}"),
    "v": ("m/s", "Velocity along {axis} at the start, positive {way}"),
}
_SINE = {
    "amplitude": ("m", None, "Amplitude of sine {k} along {axis}, positive {way}"),
    "frequency": ("Hz", 0.0, "Frequency of sine {k} along {axis}"),
    "phase": ("rad", None, "Phase of sine {k} along {axis} at time 0"),
}


def vessel_variables(vessel: Vessel) -> list[Variable]:
    """All variables of a vessel's FMU, the value reference being the place in the list."""
    variables: list[Variable] = []
    table = vessel.table

    def add(name: str, kind: Kind, unit: str, description: str, **more: Any) -> int:
        reference = len(variables)
        variables.append(Variable(reference, name, kind, 0, unit, f"{description}; {FRAME}", **more))
        return reference

    for name, unit, start, minimum, text in _parameters(vessel):
        add(
            name, Kind.PARAMETER, unit, text, causality="parameter", variability="fixed", initial="exact",
            start=start, minimum=minimum,
        )  # fmt: skip
    force: dict[str, tuple[int, ...]] = dict.fromkeys(_AXES, ())
    continuous = {"causality": "input", "variability": "continuous", "start": 0.0}

    def add_input(name: str, unit: str, text: str, given: bool, **more: Any) -> int:
        place = add(name, Kind.INPUT, unit, text, **more, **continuous)
        if given:
            what = f"time derivative of {name} at the beginning of a step"
            rate = add(f"der({name})", Kind.INPUT, f"{unit}/s", f"First {what}", derivative_of=place, **continuous)
            add(f"der({name},2)", Kind.INPUT, f"{unit}/s2", f"Second {what}", derivative_of=rate, **continuous)
        return place

    if isinstance(table, BodyTable | FloatingTable):
        for axis, way in _AXES.items():
            text = f"Force that the cable exerts on the vessel along {axis}, positive {way}"
            force[axis] = (add_input(f"F_{axis}", "N", text, table.extrapolation == "given", nominal=1000.0),)
    if isinstance(table, FloatingTable | ExcitationTable):
        for k, x in enumerate(places_of(vessel), start=1):
            text = f"Elevation of the water {x:g} m to the right of the vessel's rest position, positive up"
            add_input(f"elevation[{k}]", "m", text, table.extrapolation == "given", nominal=1.0)
    for prefix, (unit, text) in ({} if isinstance(table, ExcitationTable) else _OUTPUTS).items():
        for axis, way in _AXES.items():
            add(
                f"{prefix}{axis}", Kind.OUTPUT, unit, f"{text} along {axis}, positive {way}", causality="output",
                variability="continuous", initial="calculated", nominal=1.0,
                depends_on=force[axis] if prefix == "a" else (), on_all_at_start=True,
            )  # fmt: skip
    if isinstance(table, FloatingTable | ExcitationTable):
        for axis, way in _AXES.items():
            add(
                f"F_wave_{axis}", Kind.OUTPUT, "N", f"Force of the waves on the vessel at its rest position along "
                f"{axis}, positive {way}", causality="output", variability="continuous", initial="calculated",
                nominal=1000.0, depends_on=(), on_all_at_start=True,
            )  # fmt: skip
    return variables


def _parameters(vessel: Vessel) -> Iterator[tuple[str, str, float, float | None, str]]:
    """Name, unit, value, lower bound, description."""
    table = vessel.table
    if isinstance(table, FloatingTable):
        yield "mass", "kg", mass_of(vessel), 0.0, "Mass that moves, without water"
    for axis, way in _AXES.items():
        if isinstance(table, BodyTable | FloatingTable):
            for name, (unit, least, text) in _BODY.items():
                if name == "m" and isinstance(table, FloatingTable):
                    continue
                value = getattr(table, f"{name}_{axis}")
                yield f"{name}_{axis}", unit, value, least, text.format(axis=axis, way=way)
            for prefix, (unit, text) in _START.items():
                value = getattr(table, f"{prefix}{axis}_0")
                yield f"{prefix}{axis}_0", unit, value, None, text.format(axis=axis, way=way)
        if isinstance(table, SinesTable):
            for k, sine in enumerate(getattr(table, axis) or (), start=1):
                values = {"amplitude": sine.amplitude, "frequency": sine.hertz, "phase": sine.phase}
                for name, (unit, least, text) in _SINE.items():
                    described = text.format(axis=axis, way=way, k=k)
                    yield f"sine_{axis}[{k}].{name}", unit, values[name], least, described
    if isinstance(table, SinesTable):
        yield "ramp", "s", table.ramp, 0.0, "Time from 0 in which the motion grows from nothing; 0: at once"
