"""The table of variables: what a scene's FMU has, and nothing that the scene does not have."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cablefmu import scene_schema
from cablefmu.cable import SolverChoice
from cablefmu.fmu.table import table
from cablefmu.fmu.units import UNITS
from cablefmu.fmu.variables import STATE_OUTPUTS, Kind, variables_of
from tests.fmu_helpers import KINDS, from_equilibrium, small_scene

FORCES = {
    "air": ["u_m1", "F_cx", "F_cy"],
    "load": ["u_m1", "F_cx", "F_cy"],
    "load-volume": ["u_m1", "F_cx", "F_cy"],
    "anchor-mass": ["u_m1"],
    "anchor-spring": ["u_m1"],
    "pin": ["u_m1"],
    "floater": ["u_m1", "u_m2", "F_cx"],
    "surge": ["u_m1", "u_m1x"],
    "moved": ["F_cx", "F_cy", "x_1", "y_1", "vx_1", "vy_1", "ax_1", "ay_1"],
    "between": [f"{kind}{axis}_{end}" for end in (1, 2) for kind in ("", "v", "a") for axis in "xy"],
}
COMMON = {"g", "k_joint", "c_joint"}
FLOATER = {"M_1", "k_m1", "c_m1", "static_load"}
SPRING = {"static_load_2", "static_pull_2"}
PARAMETERS = {
    "air": {"m_c", "I_Rc"},
    "load": {"rho_w", "Cd", "m_c", "I_Rc", "rho_c"},
    "load-volume": {"rho_w", "Cd", "m_c", "I_Rc", "V_c"},
    "anchor-mass": {"rho_w", "Cd", "m_c"},
    "anchor-spring": {"rho_w", "Cd", "m_c", "rho_c", "k_cH", "c_cH", "k_cV", "c_cV", *SPRING},
    "pin": {"rho_w", "Cd"},
    "floater": {"rho_w", "Cd", "M_2", "k_m2H", "c_m2H", "k_m2V", "c_m2V", *SPRING},
    "surge": {"rho_w", "Cd", "k_m1H", "c_m1H", "static_pull"},
    "moved": {"rho_w", "Cd", "m_c", "I_Rc", "rho_c"},
    "between": {"rho_w", "Cd"},
}
OUTPUTS = ["x_c", "y_c", "vx_c", "vy_c", "tension_top", "tension_end", "tension_max", "energy"]
OF_PORT = {end: [f"F_{end}x", f"F_{end}y", f"m_{end}xx", f"m_{end}xy", f"m_{end}yy"] for end in (1, 2)}
TOP = {
    "surge": ["y_m1", "v_m1", "x_m1", "vx_m1"], "moved": OF_PORT[1], "between": [*OF_PORT[1], *OF_PORT[2]],
}  # fmt: skip
"""Outputs of the ends, where these are not y_m1 and v_m1."""
HEALTH = {
    "solver.steps": "1", "solver.rejected": "1", "solver.rhs": "1", "solver.jacobians": "1", "solver.step_size": "s",
    "solver.stiff": "1", "solver.error_estimate": "1", "solver.energy_residual": "J",
}  # fmt: skip
"""With their units."""


def names(kind: str, causality: str, dropped: tuple[str, ...] = ()) -> list[str]:
    return [v.name for v in variables_of(small_scene(kind).cable, dropped) if v.causality == causality]


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_has_its_own_variables_and_no_other(kind: str) -> None:
    assert names(kind, "input") == FORCES[kind]
    floater = FLOATER if kind not in ("moved", "between") else set()
    assert set(names(kind, "parameter")) == {"solver"} | COMMON | floater | PARAMETERS[kind]
    assert set(names(kind, "output")) == {*OUTPUTS, *TOP.get(kind, ("y_m1", "v_m1")), *HEALTH}
    assert names(kind, "independent") == ["time"]


def test_states_are_heave_and_angles_then_their_rates() -> None:
    variables = variables_of(small_scene("load").cable)
    links = range(1, 6)
    states = [v.name for v in variables if v.kind is Kind.STATE]
    assert states == ["y_m1", *(f"theta[{i}]" for i in links), "v_m1", *(f"omega[{i}]" for i in links)]
    assert [v.name for v in variables if v.kind is Kind.DERIVATIVE] == [f"der({name})" for name in states]


def test_the_surge_stands_behind_the_angles() -> None:
    states = [v.name for v in variables_of(small_scene("surge").cable) if v.kind is Kind.STATE]
    links = range(1, 6)
    q, v = ["y_m1", *(f"theta[{i}]" for i in links), "x_m1"], ["v_m1", *(f"omega[{i}]" for i in links), "vx_m1"]
    assert states == [*q, *v]


def test_value_references_are_places_in_the_list() -> None:
    variables = variables_of(small_scene("floater").cable)
    assert [v.reference for v in variables] == list(range(len(variables)))
    assert len({v.name for v in variables}) == len(variables)


@pytest.mark.parametrize("kind", ["load", "surge", "between"])
@pytest.mark.parametrize("name", scene_schema.OUTPUTS)
def test_any_output_can_be_dropped(name: str, kind: str) -> None:
    """A dropped state stays, as a local variable; everything else goes."""
    whole, rest = names(kind, "output"), names(kind, "output", (name,))
    assert rest == [other for other in whole if other != name]
    assert (name in names(kind, "local", (name,))) == (name in whole and name in STATE_OUTPUTS)


@pytest.mark.parametrize("kind", KINDS)
def test_units_and_directions_are_said(kind: str) -> None:
    plain = (Kind.TIME, Kind.PARAMETER, Kind.SOLVER, Kind.SOLVER_CHOICE, Kind.STATICS)
    for variable in variables_of(from_equilibrium(small_scene(kind)).cable):
        assert variable.enumeration or variable.unit in UNITS
        if variable.kind not in plain:
            assert variable.description.endswith("; x right, y down")


def test_health_outputs_say_where_they_are_kept() -> None:
    health = [v for v in variables_of(small_scene("load").cable) if v.name in HEALTH]
    assert {v.name: v.unit for v in health} == HEALTH
    assert all(v.description.endswith("; Co-Simulation only: stays 0 in Model Exchange") for v in health)


@pytest.mark.parametrize("choice", SolverChoice)
def test_the_solver_is_an_enumeration(choice: SolverChoice) -> None:
    cable = replace(small_scene("load").cable, solver=choice)
    (solver,) = [v for v in variables_of(cable) if v.name == "solver"]
    assert (solver.causality, solver.variability, solver.initial) == ("parameter", "fixed", "exact")
    assert solver.enumeration is not None
    assert [(item.name, item.value) for item in solver.enumeration.items] == [
        ("automatic", 1), ("explicit", 2), ("implicit", 3)
    ]  # fmt: skip
    assert all(item.description for item in solver.enumeration.items)
    assert solver.start == solver.enumeration.value_of(choice)
    assert solver.description.endswith("Model Exchange does not use it")


def test_a_start_from_equilibrium_is_told() -> None:
    """The start values are a guess then, and how good the equilibrium is comes as outputs that stay."""
    shape = small_scene("load").cable
    sought = from_equilibrium(small_scene("load")).cable
    more = [v for v in variables_of(sought) if v.name not in {v.name for v in variables_of(shape)}]
    assert [(v.name, v.unit) for v in more] == [("statics.residual", "1"), ("statics.iterations", "1")]
    assert {(v.causality, v.variability, v.initial) for v in more} == {("output", "discrete", "calculated")}
    assert {v.initial for v in variables_of(sought) if v.kind is Kind.STATE} == {"approx"}
    assert {v.initial for v in variables_of(shape) if v.kind is Kind.STATE} == {"exact"}
    without = variables_of(sought, ("statics.residual",))
    assert [v.name for v in without if v.kind is Kind.STATICS] == ["statics.iterations"]


def test_the_table_is_read_whole() -> None:
    """As many rows as the file has lines of each kind: a row that the pattern misses would shift all slots."""
    from importlib.resources import files

    text = (files("cablefmu") / "binaries" / "variables.def").read_text(encoding="utf-8")
    rows = table()
    for kind, found in (
        ("PARAMETER", rows.parameters), ("INPUT", rows.inputs), ("OUTPUT", rows.outputs), ("SOLVER", rows.solver),
        ("STATICS", rows.statics), ("WHOLE", rows.whole),
    ):  # fmt: skip
        assert len(found) == sum(line.startswith(f"{kind}(") for line in text.splitlines())
        assert [row.slot for row in found.values()] == list(range(len(found)))
