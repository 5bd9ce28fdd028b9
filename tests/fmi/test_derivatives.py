"""Partial derivatives through FMI, against the dense equation's by complex step, and what they are not offered for.

The matrix is that of tests/kernel/changes.py, long doubles that share no code with the kernel; what the FMU adds is
which variable is which, when they may be asked for, and that asking leaves no trace.
"""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from cablefmu.cable import Floats
from cablefmu.fmu.variables import Kind, variables_of
from cablefmu.reference.extended import long_double_acceleration, long_double_outputs
from cablefmu.scene import Scene
from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS, Host, small_scene

both = pytest.mark.parametrize("fmi", [2, 3])
interfaces = pytest.mark.parametrize("interface", ["cs", "me"])

EXACT = 1e-10
"""Largest error of an entry over the largest of its kind of unknown and known. Measured: 4e-14."""
STEP = np.longdouble(1e-30)
AT_EQUILIBRIUM = 1e-8
"""The same of an equilibrium, which is known to 1e-8 of gravity over a stiffness. Measured: 6e-14."""


def states_of(scene: Scene) -> list[str]:
    return [variable.name for variable in variables_of(scene.cable) if variable.kind is Kind.STATE]


def moving(host: Host) -> Host:
    """Somewhere in the middle of a motion, both ends driven: by some 300 N, or 0.3 m, m/s and m/s^2 from the start."""
    names = host.names("input")
    driven = {name: 300.0 + 100.0 * k for k, name in enumerate(names)}
    driven |= {n: 1e-3 * driven[n] + host.get(n)[0] for n in names if n.endswith(("_1", "_2"))}
    rates = {f"omega[{i}]": 0.3 * (-1) ** i + 0.1 * i for i in range(1, 6)}
    top = {name: 0.4 for name in ("v_m1", "vx_m1") if name in host.reference}
    host.initialize(**top, **driven, **rates)
    if not hasattr(host.fmu, "setTime"):
        host.step(0.0, 0.3)
    return host


def knowns_of(host: Host, scene: Scene) -> list[str]:
    return [*states_of(scene), *host.names("input")]


def unknowns_of(host: Host, scene: Scene) -> list[str]:
    return [f"der({name})" for name in states_of(scene)] + host.names("output")


def directional(host: Host, unknowns: list[str], knowns: list[str], seed: Floats) -> Floats:
    references = ([host.reference[name] for name in names] for names in (unknowns, knowns))
    return np.array(host.fmu.getDirectionalDerivative(*references, list(seed)))


def adjoint(host: Host, unknowns: list[str], knowns: list[str], seed: Floats) -> Floats:
    references = ([host.reference[name] for name in names] for names in (unknowns, knowns))
    return np.array(host.fmu.getAdjointDerivative(*references, list(seed), len(knowns)))


def evaluate(scene: Scene, x: Floats, inputs: dict[str, Floats]) -> dict[str, np.clongdouble]:
    """State derivatives and outputs of the dense equation, for complex states and inputs."""
    q, v = np.split(x, 2)
    states = states_of(scene)
    derivative = np.concatenate([v, long_double_acceleration(scene.cable, q, v, inputs)])
    values = {f"der({name})": value for name, value in zip(states, derivative, strict=True)}
    return values | long_double_outputs(scene.cable, q, v, inputs)


def expected_matrix(host: Host, scene: Scene, unknowns: list[str]) -> Floats:
    """Shape (unknowns, states and inputs), by complex step at the host's state; health follows nothing."""
    x = np.array(host.get(*states_of(scene)), dtype=np.clongdouble)
    names = host.names("input")
    u = np.array(host.get(*names), dtype=np.clongdouble)
    columns = []
    for one in np.eye(len(x) + len(u)):
        dx, du = np.split(1j * STEP * one, [len(x)])
        values = evaluate(scene, x + dx, dict(zip(names, u + du, strict=True)))
        columns.append([float(np.imag(values.get(name, 0.0)) / STEP) for name in unknowns])
    return np.array(columns).T


def assert_matrices_agree(found: Floats, expected: Floats, half: int, unknowns: list[str], tolerance: float) -> None:
    """Coordinates, rates and inputs by themselves; accelerations alike, and pulls, being sums over the same links."""
    alike = {"tension": "pull", "F_": "pull", "der(v": "acceleration", "der(omega": "acceleration"}
    kinds = {name: next((alike[start] for start in alike if name.startswith(start)), name) for name in unknowns}
    for group in (slice(0, half), slice(half, 2 * half), slice(2 * half, None)):
        for kind in set(kinds.values()):
            rows = [k for k, name in enumerate(unknowns) if kinds[name] == kind]
            size = np.abs(expected[rows, group]).max(initial=0.0)
            error = np.abs(found[rows, group] - expected[rows, group]).max(initial=0.0)
            assert error <= tolerance * size, (kind, group)


@both
@interfaces
@pytest.mark.parametrize("kind", KINDS)
def test_every_unknown_by_every_known(kind: str, interface: str, fmi: int, unpacked: Unpacked) -> None:
    scene = small_scene(kind)
    with Host(unpacked(kind, fmi), interface=interface) as host:
        moving(host)
        unknowns, knowns = unknowns_of(host, scene), knowns_of(host, scene)
        expected = expected_matrix(host, scene, unknowns)
        eye = np.eye(len(knowns))
        columns = [directional(host, unknowns, knowns, one) for one in eye]
        assert_matrices_agree(np.array(columns).T, expected, scene.cable.coordinates, unknowns, EXACT)
        if fmi == 3:
            rows = [adjoint(host, unknowns, knowns, one) for one in np.eye(len(unknowns))]
            assert_matrices_agree(np.array(rows), expected, scene.cable.coordinates, unknowns, EXACT)


@both
@interfaces
def test_seeds_add_up_and_time_moves_nothing(interface: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi), interface=interface) as host:
        moving(host)
        one = directional(host, ["der(v_m1)", "energy"], ["theta[2]"], np.array([3.0]))
        twice = directional(host, ["der(v_m1)", "energy"], ["theta[2]", "theta[2]"], np.array([1.0, 2.0]))
        assert one.tolist() == twice.tolist() and np.all(one != 0.0)
        if fmi == 3:
            assert directional(host, ["der(v_m1)", "energy"], ["time"], np.array([1.0])).tolist() == [0.0, 0.0]
        assert directional(host, [], ["theta[2]"], np.array([1.0])).tolist() == []


@both
@pytest.mark.parametrize("solver", [1, 2, 3])
@pytest.mark.parametrize("kind", ["load", "pin"])
def test_asking_leaves_no_trace(kind: str, solver: int, fmi: int, unpacked: Unpacked) -> None:
    """Every later output and counter has the bits of a run in which nobody asked, the linearised chain of the implicit
    method being where derivatives are taken as well."""

    def run(asks: bool) -> list[list[float]]:
        with Host(unpacked(kind, fmi)) as host:
            host.set_choices(("solver", solver))
            host.initialize(u_m1=50.0)
            rows = []
            for k in range(20):
                if asks:
                    directional(host, ["der(omega[2])"], ["omega[3]"], np.ones(1))
                    host.set(u_m1=700.0)  # elsewhere, and back
                    directional(host, ["der(v_m1)", "tension_top"], ["theta[1]", "u_m1"], np.ones(2))
                    host.set(u_m1=50.0)
                host.step(0.1 * k, 0.1)
                rows.append(host.get(*host.names("output")))
            return rows

    assert run(asks=True) == run(asks=False)


@both
@pytest.mark.parametrize("kind", ["load", "pin", "floater", "anchor-spring"])
def test_an_equilibrium_follows_its_inputs(kind: str, fmi: int, unpacked_from_equilibrium: Unpacked) -> None:
    """While one is sought, states are unknowns: a(q, 0, u) = 0 gives dq/du = -a_q^-1 a_u, a being the dense
    equation's. What was set for states is where the search begins, and moves nothing."""
    scene = small_scene(kind)
    half = scene.cable.n + 1
    with Host(unpacked_from_equilibrium(kind, fmi)) as host:
        host.set_all({name: 40.0 + 30.0 * k for k, name in enumerate(host.names("input"))})
        host.enter_initialization()
        inputs = host.names("input")
        unknowns = [*states_of(scene), "x_c", "y_c", "energy", "der(v_m1)"]
        matrix = expected_matrix(host, scene, unknowns_of(host, scene))
        accelerations = matrix[half : 2 * half]
        shape = -np.linalg.solve(accelerations[:, :half], accelerations[:, 2 * half :])
        listed = unknowns_of(host, scene)
        places = [matrix[listed.index(name), :half] @ shape for name in ("x_c", "y_c", "energy")]
        expected = np.vstack([shape, np.zeros((half, len(inputs))), *places, np.zeros(len(inputs))])
        found = np.array([directional(host, unknowns, inputs, one) for one in np.eye(len(inputs))]).T
        size = np.abs(expected).max(axis=0)
        assert np.all(np.abs(found - expected) <= AT_EQUILIBRIUM * size)
        assert directional(host, unknowns, ["theta[1]"], np.ones(1)).tolist() == [0.0] * len(unknowns)
        if fmi == 3:
            rows = np.array([adjoint(host, unknowns, inputs, one) for one in np.eye(len(unknowns))])
            assert np.all(np.abs(rows - expected) <= AT_EQUILIBRIUM * size)
            assert adjoint(host, ["x_c"], ["theta[1]"], np.ones(1)).tolist() == [0.0]


@both
@pytest.mark.parametrize("kind", ["load", "floater"])
def test_outputs_have_derivatives_in_time(kind: str, fmi: int, unpacked: Unpacked) -> None:
    """Against the outputs themselves after short steps, by one-sided differences of fourth order; forces
    rest, as the host gives no derivatives of them. 1e-6: what a tolerance of 1e-12 leaves over steps of 1 ms; measured:
    4e-8."""
    with Host(unpacked(kind, fmi)) as host:
        names = [name for name in host.names("output") if not name.startswith("solver.")]
        host.enter_initialization(tolerance=1e-12)
        host.fmu.exitInitializationMode()
        host.set_all(dict.fromkeys(host.names("input"), 200.0))
        host.step(0.0, 0.5)
        read = host.fmu.getRealOutputDerivatives if fmi == 2 else host.fmu.getOutputDerivatives
        found = np.array(read([host.reference[name] for name in names], [1] * len(names)))
        h = 2.0**-10
        values = [np.array(host.get(*names))]
        for k in range(4):
            host.step(0.5 + k * h, h)
            values.append(np.array(host.get(*names)))
    weights = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / (12.0 * h)  # fourth order, one-sided
    expected = weights @ np.array(values)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(values[0]).max() / 1e3)
    assert np.count_nonzero(found) == len(names)


def test_output_derivatives_go_on_with_the_inputs_given(unpacked: Unpacked) -> None:
    """The tension follows a force on the terminal at once, and so does its derivative."""
    with Host(unpacked("load", 2)) as host:
        host.initialize()
        references = [host.reference["tension_end"]]
        (at_rest,) = host.fmu.getRealOutputDerivatives(references, [1])
        host.fmu.setRealInputDerivatives([host.reference["F_cy"]], [1], [1000.0])
        (pulled,) = host.fmu.getRealOutputDerivatives(references, [1])
        (by_force,) = directional(host, ["tension_end"], ["F_cy"], np.ones(1))
        assert pulled - at_rest == pytest.approx(1000.0 * by_force, rel=1e-12)


MISTAKES = [
    (["M_1"], ["theta[1]"], 1.0, "M_1 at t = 0 s: derivatives are of state derivatives and outputs"),
    (["der(v_m1)"], ["m_c"], 1.0, "m_c at t = 0 s: derivatives are by states, inputs and time"),
    (["der(v_m1)"], ["tension_top"], 1.0, "tension_top at t = 0 s: derivatives are by states"),
    (["der(v_m1)"], ["theta[1]"], np.nan, "theta[1] at t = 0 s: its seed must be a finite number"),
]


@both
@pytest.mark.parametrize(("unknowns", "knowns", "seed", "says"), MISTAKES)
def test_what_has_no_derivative(
    unknowns: list[str], knowns: list[str], seed: float, says: str, fmi: int, unpacked: Unpacked
) -> None:
    with Host(unpacked("load", fmi)) as host:
        host.initialize()
        assert host.refusal(directional, host, unknowns, knowns, np.array([seed])).startswith(says)


@both
def test_when_and_how_derivatives_are_refused(fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked("load", fmi)) as host:
        asked = (host, ["der(v_m1)"], ["theta[1]"], np.ones(1))
        assert "is not allowed before initialization" in host.refusal(directional, *asked)
        host.initialize()
        read = host.fmu.getRealOutputDerivatives if fmi == 2 else host.fmu.getOutputDerivatives
        says = host.refusal(read, [host.reference["x_c"]], [2])
        assert says == "x_c at t = 0 s: its derivative of order 1 is known, no other"
        assert "it is not an output" in host.refusal(read, [host.reference["der(v_m1)"]], [1])
        size, none = ctypes.c_size_t(1), ctypes.c_size_t(0)
        sizes = [None, size, None, none, None] if fmi == 2 else [None, size, None, none, None, none, None, size]
        name = f"fmi{fmi}GetDirectionalDerivative"
        assert host.raw(name, *sizes, None) == 3
        assert host.messages[-1].startswith(name)


def test_sizes_of_seeds_and_sensitivities_are_checked(unpacked: Unpacked) -> None:
    with Host(unpacked("load", 3)) as host:
        host.initialize()
        reference, values = (ctypes.c_uint32 * 1)(host.reference["theta[1]"]), (ctypes.c_double * 2)()
        for name in ("Directional", "Adjoint"):
            call = getattr(host.fmu, f"fmi3Get{name}Derivative")
            says = host.refusal(call, host.fmu.component, reference, 1, reference, 1, values, 2, values, 1)
            assert says.startswith(f"fmi3Get{name}Derivative: a seed for every")
        says = host.refusal(host.fmu.fmi3GetOutputDerivatives, host.fmu.component, reference, 1, None, values, 1)
        assert says.startswith("fmi3GetOutputDerivatives: an order and a value")
