"""modelDescription.xml: valid, complete, and true of what the instance does."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.model_description import ScalarVariable
from lxml import etree

from cablefmu import __version__
from cablefmu.fmu.description import model_identifier
from cablefmu.fmu.table import table
from cablefmu.fmu.units import UNITS
from cablefmu.fmu.variables import variables_of
from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS, Host, small_scene

both = pytest.mark.parametrize("fmi", [2, 3])
every = pytest.mark.parametrize("kind", KINDS)


def xml(folder: Path) -> etree._Element:
    return etree.parse(folder / "modelDescription.xml").getroot()


@both
@every
def test_the_schema_is_met(kind: str, fmi: int, unpacked: Unpacked) -> None:
    path = Path(fmpy.__file__).parent / "schema" / f"fmi{fmi}" / f"fmi{fmi}ModelDescription.xsd"
    schema = etree.XMLSchema(etree.parse(path))
    schema.validate(xml(unpacked(kind, fmi)))
    assert [str(error) for error in schema.error_log] == []


@both
def test_who_and_what(fmi: int, unpacked: Unpacked) -> None:
    root = xml(unpacked("load", fmi))
    assert root.get("fmiVersion") == f"{fmi}.0"
    assert root.get("modelName") == "load"
    assert root.get("generationTool") == f"cablefmu {__version__}"
    assert root.get("license") == "BSD-3-Clause"
    assert (root.get("description") or "").startswith("Five links, small and quick SI units; x to the right")
    experiment = root.find("DefaultExperiment")
    assert experiment is not None
    assert [float(experiment.get(key) or "nan") for key in ("startTime", "stopTime", "stepSize", "tolerance")] == [
        0.0, 2.0, 0.1, 1e-6
    ]  # fmt: skip


@both
@every
def test_variables_carry_name_unit_and_description_of_the_table(kind: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked(kind, fmi)) as host:
        described = {v.name: v for v in host.description.modelVariables}
    expected = {v.name: v for v in variables_of(small_scene(kind).cable) if fmi == 3 or v.name != "time"}
    assert list(described) == list(expected)
    rows = table()
    for name, variable in described.items():
        assert variable.valueReference == expected[name].reference
        row = {**rows.parameters, **rows.inputs, **rows.outputs, **rows.solver}.get(name)
        assert variable.unit == (row.unit if row else expected[name].unit or None)
        assert (variable.description or "").startswith(row.description if row else expected[name].description)


@both
@every
def test_units_are_defined_as_used(kind: str, fmi: int, unpacked: Unpacked) -> None:
    root = xml(unpacked(kind, fmi))
    defined = {unit.get("name"): unit for unit in root.iter("Unit")}
    used = {element.get("unit") for element in root.iter("Real", "Float64")}
    assert set(defined) == used
    for name, unit in defined.items():
        base = unit.find("BaseUnit")
        assert base is not None
        assert {key: int(value) for key, value in base.attrib.items()} == UNITS[str(name)].exponents
    for element in root.iter("Real", "Float64"):
        shown = {display.get("name") for display in defined[element.get("unit")].iter("DisplayUnit")}
        assert element.get("displayUnit") in (shown or {None})


@both
@every
def test_derivatives_are_linked_to_their_states(kind: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked(kind, fmi)) as host:
        linked = {v.name: v.derivative.name for v in host.description.modelVariables if v.derivative is not None}
        listed = [unknown.variable.name for unknown in host.description.derivatives]
    assert linked == {f"der({state})": state for state in linked.values()}
    # Their order is that of the state vector.
    assert listed == list(linked)
    assert len(linked) == 2 * small_scene(kind).cable.coordinates


@both
@every
def test_the_lists_of_unknowns_are_complete(kind: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked(kind, fmi)) as host:
        description = host.description
        variables = description.modelVariables
        assert [u.variable.name for u in description.outputs] == host.names("output")
        calculated = {v.name for v in variables if v.initial == "calculated"}
        assert {u.variable.name for u in description.initialUnknowns} == calculated
        unknowns = [*description.outputs, *description.derivatives, *description.initialUnknowns]
        for unknown in unknowns:
            assert all(isinstance(known, ScalarVariable) for known in unknown.dependencies or ())


def known_now(host: Host) -> list[str]:
    """Inputs and states: what outputs and derivatives may depend on in continuous time."""
    states = [v.derivative.name for v in host.description.modelVariables if v.derivative is not None]
    return [*states, *host.names("input")]


@both
@every
def test_dependencies_are_true(kind: str, fmi: int, unpacked: Unpacked) -> None:
    """Move each input and state a little: exactly what is listed as dependent moves."""
    with Host(unpacked(kind, fmi), interface="me") as host:
        host.initialize()
        states, known = host.states(), known_now(host)
        rng = np.random.default_rng(1)
        states += rng.uniform(0.1, 0.3, len(states))  # away from symmetry, where slopes vanish
        host.set_states(states)
        # Below a vessel a load swings the same wherever that is; "on everything" is said nonetheless.
        everything = set(known) - ({"x_1", "y_1"} if kind == "moved" else set())
        listed = {
            u.variable.name: {d.name for d in u.dependencies} if u.dependencies is not None else everything
            for u in [*host.description.outputs, *host.description.derivatives]
        }
        before = dict(zip(listed, host.get(*listed), strict=True))
        found: dict[str, set[str]] = {name: set() for name in listed}
        for k, name in enumerate(known):
            moved, is_state = states.copy(), k < len(states)
            if is_state:
                moved[k] += 1e-3
            else:
                (given,) = host.get(name)
                host.set_all({name: given + 1.0})
            host.set_states(moved)
            for unknown, value in zip(listed, host.get(*listed), strict=True):
                if value != before[unknown]:
                    found[unknown].add(name)
            if not is_state:
                host.set_all({name: given})
    assert found == listed


@both
@every
def test_at_the_start_nothing_hangs_on_what_is_not_listed(kind: str, fmi: int, unpacked: Unpacked) -> None:
    """Before the run, parameters are known as well."""
    with Host(unpacked(kind, fmi)) as host:
        host.enter_initialization()
        unknowns = host.description.initialUnknowns
        names = [u.variable.name for u in unknowns]
        before = host.get(*names)
        reals = [name for name in host.names("parameter", "input") if name not in host.enumerations]
        for known in [*reals, *known_now(host)]:
            (value,) = host.get(known)
            host.set_all({known: 1.1 * value + 0.01})
            for unknown, old, new in zip(unknowns, before, host.get(*names), strict=True):
                listed = unknown.dependencies
                assert new == old or listed is None or known in {d.name for d in listed}
            host.set_all({known: value})
        assert host.get(*names) == before


@both
def test_the_solver_is_an_enumeration_of_names(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        (solver,) = [v for v in host.description.modelVariables if v.type == "Enumeration"]
        types = host.description.typeDefinitions
    assert (solver.name, solver.start) == ("solver", "1")
    assert [t.name for t in types] == [solver.declaredType.name] == ["SolverChoice"]
    assert [(item.name, int(item.value)) for item in solver.declaredType.items] == [
        ("automatic", 1), ("explicit", 2), ("implicit", 3)
    ]  # fmt: skip
    assert all(item.description for item in solver.declaredType.items)


# --- runs that start from equilibrium ---


@both
@every
def test_start_values_of_an_equilibrium_are_a_guess(kind: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """The states are unknown at the start: of everything but the solver's health nothing else is said of them."""
    with Host(unpacked_from_equilibrium(kind, fmi)) as host:
        description, health = host.description, ("solver.",)
        states = [v.derivative for v in description.modelVariables if v.derivative is not None]
        outputs = host.names("output")
    assert {(state.initial, state.start is not None) for state in states} == {("approx", True)}
    unknown = {u.variable.name: u.dependencies for u in description.initialUnknowns}
    derivatives = [u.variable.name for u in description.derivatives]
    assert set(unknown) == {*(state.name for state in states), *derivatives, *outputs}
    for name, dependencies in unknown.items():
        assert dependencies == ([] if name.startswith(health) else None)


@both
@every
def test_the_schema_is_met_from_equilibrium_as_well(kind: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    path = Path(fmpy.__file__).parent / "schema" / f"fmi{fmi}" / f"fmi{fmi}ModelDescription.xsd"
    schema = etree.XMLSchema(etree.parse(path))
    schema.validate(xml(unpacked_from_equilibrium(kind, fmi)))
    assert [str(error) for error in schema.error_log] == []


@pytest.mark.parametrize(
    ("name", "identifier"),
    [("free-12-air", "free_12_air"), ("60-links", "cable_60_links"), ("_x", "cable__x"), ("-", "cable__")],
)
def test_identifiers_are_those_of_c(name: str, identifier: str) -> None:
    assert model_identifier(name) == identifier
    assert identifier.isidentifier()


@both
def test_the_state_is_offered_by_both_interfaces(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        for interface in (host.description.coSimulation, host.description.modelExchange):
            assert interface.canGetAndSetFMUstate and interface.canSerializeFMUstate
