"""The kernel's library for Python: its binding table, its linear algebra against dense matrices, what it refuses."""

from __future__ import annotations

import re
import zipfile
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space

from cablefmu.cable import Cable, Floats, Terminal
from cablefmu.errors import OptionError
from cablefmu.fmu.archive import build_fmu
from cablefmu.kernel import BINDINGS, KernelModel, StaticsStatus, library
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.matrices import inertia_matrix
from tests.fmu_helpers import small_scene
from tests.kernel.resting import cable_of, end_jacobian, missing_forces, start, tangent_stiffness
from tests.random_cables import KINDS, random_inputs

API = Path(__file__).parents[1] / "fmu_src" / "kernel_api" / "api.h"
FREE = [k for k, (terminal, *_) in enumerate(KINDS) if terminal is not Terminal.ANCHOR_MASS]
"""An anchor of mass rests as a pin; see tests/test_statics.py"""


def rested(kind: int, n: int) -> tuple[Cable, KernelModel, Floats, dict[str, float]]:
    """A cable at its equilibrium, linearised there."""
    cable = cable_of(kind, n)
    inputs = random_inputs(np.random.default_rng([n, kind]), cable)
    model = KernelModel(cable)
    found = model.equilibrium(start("zigzag", n), inputs)
    assert found.status is StaticsStatus.OK
    model.rest(found.q, inputs)
    return cable, model, found.q, inputs


def mass_of(cable: Cable, q: Floats) -> Floats:
    return np.asarray(inertia_matrix(chain_of(cable), motion_of(q, np.zeros_like(q))))


def test_every_function_is_bound_with_all_its_arguments() -> None:
    """ctypes takes a call with a wrong number of arguments to an untyped function without a word."""
    found = re.findall(r"^VISIBLE [\w ]+[ *](kernel_\w+)\(([^)]*)\);$", API.read_text(), re.MULTILINE)
    assert {name: arguments.count(",") + 1 for name, arguments in found} == {
        name: len(types) - 1 for name, types in BINDINGS.items()
    }
    assert all(hasattr(library(), name) for name in BINDINGS)


def test_nothing_else_is_visible() -> None:
    assert not any(
        hasattr(library(), name) for name in ("statics_solve", "linear_factor", "fmi2DoStep", "model_prepare")
    )


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_fmu_holds_it(fmi: int, tmp_path: Path) -> None:
    path = build_fmu(small_scene("load"), tmp_path / "x.fmu", fmi=fmi, platforms=["x86_64-linux"])
    platform = "x86_64-linux"
    ours = (files("cablefmu") / "binaries" / platform / "kernel.so").read_bytes()
    with zipfile.ZipFile(path) as archive:
        libraries = [name for name in archive.namelist() if name.endswith(".so")]
        assert len(libraries) == 1
        assert archive.read(libraries[0]) != ours


@pytest.mark.parametrize("n", [1, 2, 5, 20])
@pytest.mark.parametrize("kind", FREE)
def test_products_are_those_of_the_dense_matrices(kind: int, n: int) -> None:
    """Stiffness by differences of the dense forces (1e-9 of the largest element), the inertia matrix as it is [5.1]."""
    cable, model, q, inputs = rested(kind, n)
    units = np.eye(n + 1)
    mass = np.array([model.product(unit, stiffness=0.0, mass=1.0) for unit in units])
    dense = mass_of(cable, q)
    np.testing.assert_allclose(mass, dense, rtol=0.0, atol=1e-12 * np.abs(dense).max())
    stiffness = np.array([model.product(unit, stiffness=1.0, mass=0.0) for unit in units])
    basis = null_space(end_jacobian(cable, q)) if cable.terminal is Terminal.PIN else units
    expected = tangent_stiffness(cable, q, inputs)
    np.testing.assert_allclose(
        basis.T @ stiffness @ basis, expected, rtol=0.0, atol=1e-8 * max(np.abs(stiffness).max(), 1.0)
    )
    both = np.array([model.product(unit, stiffness=2.0, mass=0.5) for unit in units])
    np.testing.assert_allclose(both, 2.0 * stiffness + 0.5 * mass, rtol=0.0, atol=1e-12 * np.abs(both).max())


@pytest.mark.parametrize("n", [2, 5, 200])
@pytest.mark.parametrize("kind", FREE)
def test_a_solution_answers_to_its_force(kind: int, n: int) -> None:
    """The pin's share is J^T through; it does not move."""
    cable, model, q, _ = rested(kind, n)
    force = np.random.default_rng(n).standard_normal(n + 1)
    jacobian = end_jacobian(cable, q)
    for stiffness, mass in ((1.0, 0.0), (0.0, 1.0), (1.0, 0.7)):
        assert model.factor(stiffness=stiffness, mass=mass) == 0
        found = model.solve(force)
        back = model.product(found.change, stiffness=stiffness, mass=mass) + jacobian.T @ found.through
        size = np.abs(jacobian.T @ found.through).max() + np.abs(force).max()
        np.testing.assert_allclose(back, force, rtol=0.0, atol=1e-8 * size)
        if cable.terminal is Terminal.PIN:
            assert np.abs(jacobian @ found.change).max() <= 1e-9 * np.abs(found.change).max() * np.abs(jacobian).sum()
        else:
            assert not np.any(found.through)


@pytest.mark.parametrize("mass", [1.0, 1e5, 1e10])
def test_a_heavy_end_is_in_the_inertia_matrix(mass: float) -> None:
    """From 100 times the cable's mass on the kernel keeps it apart; the product has it all the same."""
    kind = next(k for k, (terminal, *_) in enumerate(KINDS) if terminal is Terminal.LOAD)
    base = cable_of(kind, 5)
    cable = replace(base, parameters=base.parameters | {"m_c": mass * base.links.mass.sum()})
    q, model = start("zigzag", 5), KernelModel(cable)
    model.rest(q, {})
    found = np.array([model.product(unit, stiffness=0.0, mass=1.0) for unit in np.eye(6)])
    dense = mass_of(cable, q)
    np.testing.assert_allclose(found, dense, rtol=0.0, atol=1e-12 * np.abs(dense).max())


def test_negative_pivots_count_the_ways_downhill() -> None:
    """Exactly upright every link of a limp cable would fall."""
    kind = next(k for k, (terminal, water, _) in enumerate(KINDS) if terminal is Terminal.LOAD and not water)
    cable = cable_of(kind, 7)
    limp = replace(cable, links=replace(cable.links, joint_stiffness=np.zeros(7)))
    limp = replace(limp, parameters={name: v for name, v in cable.parameters.items() if name != "k_joint"})
    model = KernelModel(limp)
    for name, expected in (("inverted", 7), ("hanging", 0)):
        model.rest(start(name, 7), {})
        assert model.factor(stiffness=1.0, mass=0.0) == expected


def test_forces_at_rest_balance() -> None:
    """R of the top joint carries all that hangs below, and nothing is left by the dense equations."""
    kind = next(k for k, (terminal, water, _) in enumerate(KINDS) if terminal is Terminal.LOAD and not water)
    cable, model, q, inputs = rested(kind, 5)
    rest = model.rest(q, inputs)
    weight = (cable.links.mass.sum() + cable.parameters["m_c"]) * cable.parameters["g"]
    np.testing.assert_allclose(rest.forces[0], [-inputs["F_cx"], -inputs["F_cy"] - weight], rtol=1e-9)
    assert np.abs(rest.acceleration).max() < 1e-8
    assert np.abs(missing_forces(cable, q, inputs)).max() < 1e-9 * weight * cable.links.length.sum()


# --- mistakes ---


@pytest.mark.parametrize(
    ("q", "inputs", "says"),
    [
        (np.zeros(3), {}, r"q: shape \(6,\) is expected, got \(3,\)"),
        (np.full(6, np.nan), {}, "q: finite numbers are expected"),
        (np.append(0.0, np.full(5, 1e7)), {}, "q: angles within 1.6e6 rad are expected"),
        (np.zeros(6), {"u_m2": 1.0}, "input u_m2: this cable has no such input; it has u_m1, F_cx, F_cy"),
        (np.zeros(6), {"u_m1": np.inf}, r"input u_m1 = inf: a finite number \[N\] is expected"),
    ],
)
def test_a_mistake_is_refused(q: Floats, inputs: dict[str, float], says: str) -> None:
    model = KernelModel(small_scene("load").cable)
    with pytest.raises(OptionError, match=says):
        model.equilibrium(q, inputs)
    with pytest.raises(OptionError, match=says):
        model.rest(q, inputs)


def test_vectors_of_another_length_never_reach_the_library() -> None:
    model = KernelModel(small_scene("load").cable)
    model.rest(np.zeros(6), {})
    model.factor(stiffness=0.0, mass=1.0)
    with pytest.raises(OptionError, match="force: shape"):
        model.solve(np.zeros(7))
    with pytest.raises(OptionError, match="change: shape"):
        model.product(np.zeros((1, 6)), stiffness=1.0, mass=0.0)
