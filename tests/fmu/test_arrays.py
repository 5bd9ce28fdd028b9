"""Descriptions with arrays: valid, and true of what the instance does."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from cablefmu.errors import OptionError
from cablefmu.fmu.archive import build_fmu, default_path, open_fmu
from cablefmu.fmu.resource import resource_bytes
from cablefmu.fmu.table import table
from cablefmu.fmu.variables import STATE_OUTPUTS, Kind, Variable, elements_of, variables_of
from cablefmu.whole import whole_of
from tests.fmu_helpers import KINDS, Host, from_equilibrium, small_scene, unpack

Arrays = Callable[[str], Path]
every = pytest.mark.parametrize("kind", KINDS)
LOADS = ("air", "load", "load-volume", "moved")
HEADER = struct.Struct("<8sIIIIQIIIIIIIIII")


@every
@pytest.mark.parametrize("sought", [False, True])
def test_the_schema_is_met(kind: str, sought: bool, tmp_path: Path) -> None:
    scene = from_equilibrium(small_scene(kind)) if sought else small_scene(kind)
    folder = unpack(scene, tmp_path, 3, arrays=True)
    path = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3ModelDescription.xsd"
    schema = etree.XMLSchema(etree.parse(path))
    schema.validate(etree.parse(folder / "modelDescription.xml"))
    assert [str(error) for error in schema.error_log] == []
    assert validate_fmu(str(tmp_path / f"{kind}-3.fmu")) == []


@every
def test_arrays_stand_in_for_what_every_link_has(kind: str, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays(kind)) as host:
        described = {v.name: v for v in host.description.modelVariables}
        n = described["n"]
        assert (n.type, n.causality, n.variability, n.start) == ("UInt64", "structuralParameter", "fixed", "5")
        root = etree.parse(unpacked_arrays(kind) / "modelDescription.xml").getroot()
        (element,) = root.iter("UInt64")
        assert (element.get("min"), element.get("max")) == ("1", "10000")
        arrays = [v for v in described.values() if v.dimensions]
        assert [v.name for v in arrays] == ["theta", "omega", "der(theta)", "der(omega)"]
        for variable in arrays:
            assert [d.valueReference for d in variable.dimensions] == [n.valueReference]
            assert (variable.initial, variable.start, variable.shape) == ("calculated", None, (5,))
        derivatives = [u.variable for u in host.description.derivatives]
        top = {"moved": 0, "between": 0, "surge": 2}.get(kind, 1)
        heave, surge = ["y_m1"][:top], ["x_m1"][: top - 1 if top else 0]
        half = [*heave, "theta", *surge]
        rate = {"y_m1": "v_m1", "theta": "omega", "x_m1": "vx_m1"}
        assert [v.derivative.name for v in derivatives] == [*half, *(rate[name] for name in half)]
        assert host.description.numberOfContinuousStates == 2 * (5 + top)
        assert not [name for name in described if "[" in name]


@every
def test_variables_are_those_of_scalars_but_for_what_follows_from_n(kind: str) -> None:
    scene = small_scene(kind)
    scalars = {v.name: v for v in variables_of(scene.cable)}
    arrays = {v.name: v for v in elements_of(variables_of(scene.cable, (), whole_of(scene)), 5)}
    start = {"theta_start"} if kind in LOADS else set()
    assert arrays.keys() - scalars.keys() == {"n", "L", "D", "rho_cable", "EI"} | start
    assert scalars.keys() - arrays.keys() == {"k_joint"}
    for name in arrays.keys() & scalars.keys():
        one, other = arrays[name], scalars[name]
        assert (one.unit, one.nominal, one.minimum) == (other.unit, other.nominal, other.minimum)
        if one.kind is not Kind.PRELOAD:
            assert (one.description, one.causality) == (other.description, other.causality)
    ordered = [v.name for v in arrays.values() if v.name in scalars and v.kind is not Kind.PRELOAD]
    assert ordered == [name for name in scalars if name in ordered]


@every
def test_start_values_are_those_of_the_description(kind: str, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays(kind)) as host:
        reals = {
            v.name: float(v.start)
            for v in host.description.modelVariables
            if v.start is not None and v.type in ("Float64", "Enumeration")
        }
        assert host.get(*reals) == list(reals.values())
        assert host.fmu.getUInt64([host.reference["n"]]) == [5]


@every
def test_the_lists_of_unknowns_are_complete(kind: str, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays(kind)) as host:
        description = host.description
        assert [u.variable.name for u in description.outputs] == host.names("output")
        calculated = {v.name for v in description.modelVariables if v.initial == "calculated"}
        assert {u.variable.name for u in description.initialUnknowns} == calculated


@every
def test_dependencies_are_those_of_scalars(kind: str, unpacked_arrays: Arrays) -> None:
    """In continuous time; `theta` in place of theta[1] ... theta[5]."""
    scene = small_scene(kind)

    def listed(variables: list[Variable]) -> dict[str, set[str] | None]:
        names = {v.reference: v.name.partition("[")[0] for v in variables}
        unknowns = [v for v in variables if v.causality == "output" or v.kind is Kind.DERIVATIVE]
        return {
            v.name.replace("[1]", ""): None if v.depends_on is None else {names[r] for r in v.depends_on}
            for v in unknowns
            if "[" not in v.name or "[1]" in v.name
        }

    arrays = listed(variables_of(scene.cable, (), whole_of(scene)))
    scalars = listed(variables_of(scene.cable))
    assert arrays == scalars
    with Host(unpacked_arrays(kind)) as host:
        described = {
            u.variable.name: None if u.dependencies is None else {d.name for d in u.dependencies}
            for u in [*host.description.outputs, *host.description.derivatives]
        }
    assert described == arrays


@every
def test_at_the_start_nothing_hangs_on_what_is_not_listed(kind: str, unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays(kind)) as host:
        host.enter_initialization()
        listed = {
            u.variable.name: None if u.dependencies is None else {d.name for d in u.dependencies}
            for u in host.description.initialUnknowns
        }
        sizes = {v.name: 5 if v.dimensions else 1 for v in host.description.modelVariables}
        values = lambda name: host.fmu.getFloat64([host.reference[name]], sizes[name])  # noqa: E731
        before = {name: values(name) for name in listed}
        tops = [name for name in STATE_OUTPUTS if name in host.reference]
        known = [n for n in [*host.names("parameter", "input"), *tops] if n not in host.enumerations]
        for name in known:
            (value,) = host.get(name)
            host.set_all({name: 1.01 * value + 0.01})
            for unknown, dependencies in listed.items():
                assert values(unknown) == before[unknown] or dependencies is None or name in dependencies
            host.set_all({name: value})
        assert {name: values(name) for name in listed} == before


@every
def test_layout_of_the_resource(kind: str) -> None:
    """The cable as a whole in place of its links: 10,000 of them would take no byte more."""
    scene, rows = small_scene(kind), table()
    whole = whole_of(scene)
    variables = variables_of(scene.cable, (), whole)
    data = resource_bytes(scene.cable, variables, whole)
    _, version, n, _, _, present, *counts, _, _, shape, numbers, _, _ = HEADER.unpack_from(data)
    assert (version, n, shape, numbers) == (4, 5, 1 if kind in LOADS else 2, len(rows.whole))
    parameters = {v.name for v in variables if v.kind is Kind.PARAMETER}
    assert {name for name, row in rows.parameters.items() if present >> row.slot & 1} == parameters
    first = HEADER.size + 8 * (counts[0] + counts[1])
    doubles = struct.unpack_from(f"<{2 + len(rows.whole)}d", data, first)
    assert doubles[:2] == (scene.spec.terminal.position if kind not in LOADS else (0.0, 0.0))  # type: ignore[union-attr]
    assert dict(zip(rows.whole, doubles[2:], strict=True)) == {"theta_start": 0.0, **whole.parameters}
    assert len(data) == first + 8 * len(doubles) + 8 * len(variables)


def test_files_have_names_of_their_own() -> None:
    scene = small_scene("load")
    assert str(default_path(scene, 3, arrays=True)) == "build/load-fmi3-arrays.fmu"
    assert str(default_path(scene, 3)) == "build/load-fmi3.fmu"


def test_arrays_make_it_version_3(tmp_path: Path) -> None:
    archive = open_fmu(build_fmu(small_scene("load"), tmp_path / "x.fmu", arrays=True))
    assert (archive.fmi, archive.has_arrays) == (3, True)
    assert [v.name for v in archive.variables()] == [v.name for v in archive.description.modelVariables]
    assert not open_fmu(build_fmu(small_scene("load"), tmp_path / "y.fmu", fmi=3)).has_arrays
    with pytest.raises(OptionError, match="fmi = 2: FMI 2 has no arrays; version 3 is expected"):
        build_fmu(small_scene("load"), tmp_path / "z.fmu", fmi=2, arrays=True)
    assert not (tmp_path / "z.fmu").exists()
