"""modelDescription.xml for FMI 2.0 and FMI 3.0, of one list of variables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from .. import __version__
from .sources import compiled_files
from .units import UNITS
from .variables import Kind, Variable

__all__ = ["Experiment", "describe", "model_identifier"]

LOG_CATEGORIES = {
    "logStatusError": "What went wrong, where and when",
    "logStatusWarning": "What was accepted but may not be meant",
    "logStatusDiscard": "What was asked and cannot be told",
}


@dataclass(frozen=True, slots=True)
class Experiment:
    """DefaultExperiment: what a host proposes to its user."""

    stop_time: float
    """[s]"""
    step: float
    """Communication step and output interval [s]"""
    tolerance: float


def model_identifier(name: str) -> str:
    """A C identifier made of a scene's name: it names the binary in the archive."""
    identifier = re.sub(r"\W", "_", name, flags=re.ASCII)
    return identifier if identifier[0].isalpha() else f"cable_{identifier}"


def describe(
    version: int,
    *,
    name: str,
    description: str,
    token: str,
    variables: list[Variable],
    experiment: Experiment | None = None,
) -> bytes:
    """The XML text of modelDescription.xml.

    Parameters
    ----------
    version
        2 or 3, of FMI.
    name, description
        Of the scene.
    token
        guid or instantiationToken.
    variables
        In order of value references.
    experiment
        Defaults for hosts, if there are any.
    """
    common = {
        "modelName": name,
        "description": f"{description} SI units; x to the right, y down, angles from the downward vertical.",
        "author": "cablefmu developers",
        "version": __version__,
        "copyright": "cablefmu developers",
        "license": "BSD-3-Clause",
        "generationTool": f"cablefmu {__version__}",
        "variableNamingConvention": "structured",
    }
    writer = _fmi2 if version == 2 else _fmi3
    root = writer(common, model_identifier(name), token, variables, experiment)
    ET.indent(root, "  ")
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _number(value: float) -> str:
    """Shortest text that reads back to the same double."""
    return repr(float(value))


def _add_units(root: ET.Element, variables: list[Variable]) -> None:
    definitions = ET.SubElement(root, "UnitDefinitions")
    for name in sorted({variable.unit for variable in variables if variable.unit}):
        unit = UNITS[name]
        element = ET.SubElement(definitions, "Unit", name=name)
        ET.SubElement(element, "BaseUnit", {base: str(power) for base, power in unit.exponents.items()})
        for display, factor in unit.display.items():
            ET.SubElement(element, "DisplayUnit", name=display, factor=_number(factor))


def _add_types(
    root: ET.Element, variables: list[Variable], add: Callable[[ET.Element, dict[str, str]], ET.Element]
) -> None:
    enumerations = list(dict.fromkeys(variable.enumeration for variable in variables if variable.enumeration))
    if not enumerations:
        return
    definitions = ET.SubElement(root, "TypeDefinitions")
    for enumeration in enumerations:
        parent = add(definitions, {"name": enumeration.name, "description": enumeration.description})
        for item in enumeration.items:
            ET.SubElement(parent, "Item", name=item.name, value=str(item.value), description=item.description)


def _add_log_categories(root: ET.Element) -> None:
    categories = ET.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=description)


def _add_experiment(root: ET.Element, experiment: Experiment | None) -> None:
    if experiment is None:
        return
    ET.SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime=_number(experiment.stop_time),
        tolerance=_number(experiment.tolerance), stepSize=_number(experiment.step),
    )  # fmt: skip


def _value_attributes(variable: Variable) -> dict[str, str]:
    """What stands at the variable's type in FMI 2 and at the variable itself in FMI 3."""
    if variable.enumeration:
        assert variable.start is not None  # a parameter has one
        return {"declaredType": variable.enumeration.name, "start": str(int(variable.start))}
    if variable.kind is Kind.LINKS:
        given = {"start": variable.start, "min": variable.minimum, "max": variable.maximum}
        return {key: str(int(value)) for key, value in given.items() if value is not None}
    attributes = {"unit": variable.unit}
    display = next(iter(UNITS[variable.unit].display), None)
    if display:
        attributes["displayUnit"] = display
    given = {"min": variable.minimum, "max": variable.maximum, "nominal": variable.nominal, "start": variable.start}
    for key, value in given.items():
        if value is not None:
            attributes[key] = _number(value)
    return attributes


def _identity(variable: Variable) -> dict[str, str]:
    """What both versions say of the variable itself."""
    initial = {"initial": variable.initial} if variable.initial else {}
    return {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
        **initial,
    }


def _of_kind(variables: Iterable[Variable], kind: Kind) -> list[Variable]:
    return [variable for variable in variables if variable.kind is kind]


def _outputs(variables: list[Variable]) -> list[Variable]:
    return [variable for variable in variables if variable.causality == "output"]


def _initial_unknowns(variables: list[Variable]) -> list[Variable]:
    return [variable for variable in variables if variable.initial in ("calculated", "approx")]


def _dependencies(variable: Variable, at_start: bool) -> tuple[int, ...] | None:
    return None if at_start and variable.on_all_at_start else variable.depends_on


def _offers_model_exchange(variables: Iterable[Variable]) -> bool:
    """Not where a motion is given without its acceleration, which only steps can make up for."""
    names = {variable.name for variable in variables if variable.kind is Kind.INPUT}
    return all(f"ax_{end}" in names for end in (1, 2) if f"x_{end}" in names)


# --- FMI 2.0 ---


def _fmi2(
    common: dict[str, str],
    identifier: str,
    token: str,
    variables: list[Variable],
    experiment: Experiment | None,
) -> ET.Element:
    root = ET.Element(
        "fmiModelDescription", {"fmiVersion": "2.0", "guid": token, **common, "numberOfEventIndicators": "0"}
    )
    capabilities = {
        "modelIdentifier": identifier,
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    stepping = {
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "1",
    }
    interfaces = {"ModelExchange": {"completedIntegratorStepNotNeeded": "true"}, "CoSimulation": stepping}
    if not _offers_model_exchange(variables):
        del interfaces["ModelExchange"]
    for interface, own in interfaces.items():
        element = ET.SubElement(root, interface, {**capabilities, **own})
        listing = ET.SubElement(element, "SourceFiles")
        for file in compiled_files(identifier):
            ET.SubElement(listing, "File", name=file)
    # Time needs no variable in FMI 2.
    variables = [variable for variable in variables if variable.kind is not Kind.TIME]
    _add_units(root, variables)
    _add_types(root, variables, _fmi2_enumeration)
    _add_log_categories(root)
    _add_experiment(root, experiment)
    place = {variable.reference: str(k) for k, variable in enumerate(variables, start=1)}
    listing = ET.SubElement(root, "ModelVariables")
    for variable in variables:
        element = ET.SubElement(listing, "ScalarVariable", _identity(variable))
        attributes = _value_attributes(variable)
        if variable.derivative_of is not None:
            attributes["derivative"] = place[variable.derivative_of]
        ET.SubElement(element, "Enumeration" if variable.enumeration else "Real", attributes)
    _fmi2_structure(root, variables, place)
    return root


def _fmi2_enumeration(definitions: ET.Element, attributes: dict[str, str]) -> ET.Element:
    return ET.SubElement(ET.SubElement(definitions, "SimpleType", attributes), "Enumeration")


def _fmi2_structure(root: ET.Element, variables: list[Variable], place: dict[int, str]) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    sections = (
        ("Outputs", _outputs(variables), False),
        ("Derivatives", _of_kind(variables, Kind.DERIVATIVE), False),
        ("InitialUnknowns", _initial_unknowns(variables), True),
    )
    for section, unknowns, at_start in sections:
        if not unknowns:
            continue
        parent = ET.SubElement(structure, section)
        for unknown in sorted(unknowns, key=lambda variable: variable.reference):
            attributes = {"index": place[unknown.reference]}
            depends_on = _dependencies(unknown, at_start)
            if depends_on is not None:
                attributes["dependencies"] = " ".join(place[reference] for reference in depends_on)
            ET.SubElement(parent, "Unknown", attributes)


# --- FMI 3.0 ---


def _fmi3(
    common: dict[str, str],
    identifier: str,
    token: str,
    variables: list[Variable],
    experiment: Experiment | None,
) -> ET.Element:
    root = ET.Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token, **common})
    capabilities = {
        "modelIdentifier": identifier,
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
        "providesAdjointDerivatives": "true",
    }
    if _offers_model_exchange(variables):
        ET.SubElement(root, "ModelExchange", {**capabilities, "needsCompletedIntegratorStep": "false"})
    stepping = {
        "canHandleVariableCommunicationStepSize": "true",
        "providesIntermediateUpdate": "true",
        "mightReturnEarlyFromDoStep": "true",
        "canReturnEarlyAfterIntermediateUpdate": "true",
        "hasEventMode": "false",
        "maxOutputDerivativeOrder": "1",
    }
    ET.SubElement(root, "CoSimulation", {**capabilities, **stepping})
    _add_units(root, variables)
    _add_types(root, variables, _fmi3_enumeration)
    _add_log_categories(root)
    _add_experiment(root, experiment)
    listing = ET.SubElement(root, "ModelVariables")
    for variable in variables:
        attributes = _identity(variable)
        if variable.kind in (Kind.INPUT, Kind.OUTPUT):
            attributes["intermediateUpdate"] = "true"
        if variable.derivative_of is not None:
            attributes["derivative"] = str(variable.derivative_of)
        tag = {Kind.SOLVER_CHOICE: "Enumeration", Kind.LINKS: "UInt64"}.get(variable.kind, "Float64")
        element = ET.SubElement(listing, tag, {**attributes, **_value_attributes(variable)})
        if variable.dimension is not None:
            ET.SubElement(element, "Dimension", valueReference=str(variable.dimension))
    _fmi3_structure(root, variables)
    return root


def _fmi3_enumeration(definitions: ET.Element, attributes: dict[str, str]) -> ET.Element:
    return ET.SubElement(definitions, "EnumerationType", attributes)


def _fmi3_structure(root: ET.Element, variables: list[Variable]) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    sections = (
        ("Output", _outputs(variables), False),
        ("ContinuousStateDerivative", _of_kind(variables, Kind.DERIVATIVE), False),
        ("InitialUnknown", _initial_unknowns(variables), True),
    )
    for tag, unknowns, at_start in sections:
        for unknown in unknowns:
            attributes = {"valueReference": str(unknown.reference)}
            depends_on = _dependencies(unknown, at_start)
            if depends_on is not None:
                attributes["dependencies"] = " ".join(map(str, depends_on))
            ET.SubElement(structure, tag, attributes)
