"""Equilibria, natural frequencies and end stiffness, against dense matrices, tables and the smooth catenary."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import cablefmu
from cablefmu.cable import Cable, Floats, Terminal
from cablefmu.errors import OptionError, RunError, SceneError
from cablefmu.kernel import KernelModel
from cablefmu.reference.chain import chain_of
from cablefmu.reference.kinematics import motion_of
from cablefmu.reference.matrices import inertia_matrix
from cablefmu.statics import end_stiffness, equilibrium, modes
from tests.fmu_helpers import small_scene
from tests.kernel.resting import cable_of, end_jacobian, end_of, start, tangent_stiffness
from tests.kernel.test_statics_classics import RIGID, SUSPENDED, beam, slack
from tests.random_cables import KINDS, random_inputs
from tests.validation.cables import GRAVITY, hanging_chain
from tests.validation.catenary import stiffness as smooth_stiffness
from tests.validation.checks import read_table

# --- equilibrium ---


@pytest.mark.parametrize("kind", ["air", "load", "load-volume", "anchor-mass", "anchor-spring", "floater", "pin"])
def test_a_scene_comes_to_rest(kind: str) -> None:
    found = equilibrium(small_scene(kind))
    assert found.residual < 1e-8 and found.iterations >= 1
    np.testing.assert_allclose(found.terminal, end_of(found.cable, found.q), rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(np.diff(found.points, axis=0)[:, 0], found.cable.links.length * np.sin(found.angles))
    assert found.heave == found.q[0]
    assert np.all(found.tensions > 0.0)


def test_tensions_are_the_fmus_own(tmp_path: Path) -> None:
    """Hanging with a sideways force, the first row of a run from the equilibrium shows the same pulls."""
    scene = small_scene("load")
    found = equilibrium(scene, {"F_cx": 300.0})
    given = {"F_cx": 300.0, "y_m1": found.heave} | {f"theta[{i + 1}]": a for i, a in enumerate(found.angles)}
    first = cablefmu.simulate(scene, stop_time=0.1, parameters=given).isel(time=0)
    assert float(first["tension_top"]) == pytest.approx(found.tensions[0, 0], rel=1e-9)
    assert float(first["tension_end"]) == pytest.approx(found.tensions[-1, 1], rel=1e-9)
    assert float(first["tension_max"]) == pytest.approx(found.tensions.max(), rel=1e-9)
    assert (float(first["x_c"]), float(first["y_c"])) == pytest.approx(found.terminal)


def test_inputs_are_those_of_the_start_unless_given() -> None:
    cable = replace(small_scene("load").cable, input_start={"F_cx": 50.0})
    assert equilibrium(cable).inputs == {"u_m1": 0.0, "F_cx": 50.0, "F_cy": 0.0}
    assert equilibrium(cable, {"F_cx": 0.0}).terminal[0] == pytest.approx(0.0, abs=1e-9)
    assert equilibrium(cable, {"F_cy": 10.0}).inputs == {"u_m1": 0.0, "F_cx": 50.0, "F_cy": 10.0}


def test_parameters_reach_the_kernel() -> None:
    """m_c more by 10 kg of steel in water: floater down by its submerged weight over k_m1."""
    cable = small_scene("load").cable
    p = cable.parameters
    heavier = equilibrium(cable, parameters={"m_c": p["m_c"] + 10.0}).heave - equilibrium(cable).heave
    assert heavier == pytest.approx(10.0 * (1.0 - p["rho_w"] / p["rho_c"]) * p["g"] / p["k_m1"], rel=1e-9)


def test_an_equilibrium_may_be_gone_on_from() -> None:
    """From one to the next, and the same when it is asked for again."""
    first = equilibrium(small_scene("load"), {"F_cx": 100.0})
    again = equilibrium(first)
    np.testing.assert_allclose(again.q, first.q, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(
        equilibrium(first, {"F_cx": 200.0}).q, equilibrium(small_scene("load"), {"F_cx": 200.0}).q, rtol=0.0, atol=1e-10
    )


def test_an_anchor_of_mass_is_a_pin_where_it_stands() -> None:
    scene = small_scene("anchor-mass")
    found = equilibrium(scene)
    assert found.cable.terminal is Terminal.PIN and "m_c" not in found.cable.parameters
    np.testing.assert_allclose(found.terminal, end_of(scene.cable, scene.cable.position), rtol=0.0, atol=1e-9)


def test_a_scene_may_be_named_or_a_file(tmp_path: Path) -> None:
    (tmp_path / "load.toml").write_text(small_scene("load").text)
    by_path = equilibrium(tmp_path / "load.toml")
    np.testing.assert_array_equal(by_path.q, equilibrium(small_scene("load")).q)
    assert equilibrium("free-12-water").cable.n == 12


@pytest.mark.parametrize(
    ("inputs", "parameters", "says"),
    [
        ({"u_m3": 1.0}, {}, "input u_m3: this cable has no such input; it has u_m1, F_cx, F_cy"),
        ({"F_cx": np.nan}, {}, r"input F_cx = nan: a finite number \[N\] is expected"),
        ({}, {"m_x": 1.0}, "parameter m_x: this cable has no such parameter; it has g, M_1"),
        ({}, {"m_c": 0.0}, r"parameter m_c = 0.0: a number above 0 \[kg\] is expected"),
        ({}, {"k_m1": -1.0}, r"parameter k_m1 = -1.0: a number of 0 or more \[N/m\] is expected"),
        ({}, {"g": np.inf}, r"parameter g = inf: a finite number \[m/s2\] is expected"),
    ],
)
def test_a_mistake_is_refused(inputs: dict[str, float], parameters: dict[str, float], says: str) -> None:
    with pytest.raises(OptionError, match=says):
        equilibrium(small_scene("load"), inputs, parameters)


def test_no_equilibrium_is_said_in_a_sentence() -> None:
    with pytest.raises(RunError, match="no stable equilibrium was found near the start shape: the forces could not be"):
        equilibrium(small_scene("load"), {"u_m1": 10.0}, {"k_m1": 0.0})
    with pytest.raises(RunError, match="went beyond the range of numbers"):
        equilibrium(small_scene("load"), {"F_cx": 1e308})
    with pytest.raises(SceneError, match="no scene"):
        equilibrium("nowhere")


# --- modes ---


def held_chain(n: int, ratio: float = 0.0) -> Cable:
    """The chain of the validation below a top that does not heave."""
    cable = hanging_chain(n, ratio=ratio)
    return replace(cable, parameters=cable.parameters | {"M_1": 1.0, "k_m1": RIGID})


@pytest.mark.parametrize("row", read_table("hanging_chain_frequencies"), ids=lambda r: f"{r['N']:g}-{r['mode']:g}")
def test_rods_swing_with_the_tables_frequencies(row: dict[str, float]) -> None:
    """Rounding of an eigenvalue beside the largest one, which is that of links: 1e-10."""
    n, mode = int(row["N"]), int(row["mode"])
    found = modes(held_chain(n), count=mode)
    assert found.pulsation[mode - 1] * np.sqrt(12.0 / GRAVITY) == pytest.approx(row["rigid_rod_chain"], rel=1e-9)
    np.testing.assert_allclose(found.frequency, found.pulsation / (2.0 * np.pi))


def test_many_rods_swing_as_a_flexible_chain() -> None:
    """Ten thousand rods: half the zeros of Bessel's J_0, too fast by O((mode/n)^2), see validation/frequencies.py."""
    found = modes(held_chain(10_000), count=5)
    table = [
        r["continuous_bessel"] for r in read_table("hanging_chain_frequencies") if r["N"] == 120 and r["mode"] <= 5
    ]
    np.testing.assert_allclose(found.pulsation * np.sqrt(12.0 / GRAVITY), table[: len(found.pulsation)], rtol=1e-6)


@pytest.mark.parametrize("n", [1, 2, 3, 12, 30])
@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_the_dense_eigenproblem_has_the_same_modes(kind: int, n: int) -> None:
    """K by differences of the dense forces, M [5.1], and for a pin the basis of what it allows: 1e-7 of a slow mode's
    square beside a fast one's 1e6 times as large."""
    cable = cable_of(kind, n)
    cable = replace(cable, position=start("zigzag", n))
    found = modes(cable, random_inputs(np.random.default_rng([n, kind]), cable), count=n + 1)
    rest = found.equilibrium
    q = rest.q
    basis = null_space(end_jacobian(rest.cable, q)) if rest.cable.terminal is Terminal.PIN else np.eye(n + 1)
    assert len(found.pulsation) == basis.shape[1]
    if not len(found.pulsation):
        return
    mass = inertia_matrix(chain_of(rest.cable), motion_of(q, np.zeros_like(q)))
    squares = eigh(tangent_stiffness(rest.cable, q, rest.inputs), basis.T @ mass @ basis, eigvals_only=True)
    np.testing.assert_allclose(found.pulsation**2, squares, rtol=1e-6, atol=1e-9 * squares.max())
    np.testing.assert_allclose(found.shapes @ mass @ found.shapes.T, np.eye(len(squares)), rtol=0.0, atol=1e-8)
    if rest.cable.terminal is Terminal.PIN:
        assert np.abs(end_jacobian(rest.cable, q) @ found.shapes.T).max() < 1e-9 * np.abs(found.shapes).max() * 1e3


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_lanczos_agrees_with_all_modes_at_once(kind: int) -> None:
    """240 links by ARPACK, by the dense eigenproblem of the same products: what two methods may differ by."""
    cable = replace(cable_of(kind, 240), position=start("zigzag", 240))
    found = modes(cable, count=8)
    model = KernelModel(found.equilibrium.cable)
    model.rest(found.equilibrium.q, found.equilibrium.inputs)
    units = np.eye(241)
    stiffness, inertia = (
        np.array([model.product(unit, stiffness=k, mass=m) for unit in units]) for k, m in ((1.0, 0.0), (0.0, 1.0))
    )
    pinned = model.cable.terminal is Terminal.PIN
    basis = null_space(end_jacobian(model.cable, found.equilibrium.q)) if pinned else units
    squares, shapes = eigh(basis.T @ stiffness @ basis, basis.T @ inertia @ basis, subset_by_index=(0, 7))
    shapes = (basis @ shapes).T
    np.testing.assert_allclose(found.pulsation**2, squares, rtol=1e-6)
    mass = np.array([model.product(shape, stiffness=0.0, mass=1.0) for shape in shapes])
    np.testing.assert_allclose(np.abs(found.shapes @ mass.T), np.eye(8), rtol=0.0, atol=1e-4)


def test_a_cantilever_vibrates_as_a_beam() -> None:
    """EI and m of the same beam, links' rotary inertia included: (1.8751, 4.6941)^2 sqrt(EI/(m L^3)), less O(n^-2)."""
    n = 100
    cable = replace(beam(n), parameters=beam(n).parameters)
    expected = np.array([1.87510407, 4.69409113, 7.85475744]) ** 2 * np.sqrt(628.3 / (10.0 * 10.0**3))
    np.testing.assert_allclose(modes(cable, count=3).pulsation, expected, rtol=2e-3)


def test_shapes_have_one_sign() -> None:
    """Their largest entry is positive, so that pictures of neighbouring cases can be compared."""
    found = modes(small_scene("floater"))
    for shape in found.shapes:
        assert shape[np.argmax(np.abs(shape))] > 0.0


def test_modes_that_rounding_hides_are_not_told() -> None:
    """1e300 N sideways have an equilibrium; beside the stiffness that they bring, heave has none to be seen."""
    with pytest.raises(RunError, match="the slowest modes drown in rounding"):
        modes(small_scene("load"), {"F_cx": 1e300})


@pytest.mark.parametrize("count", [0, 501])
def test_a_count_out_of_range_is_refused(count: int) -> None:
    with pytest.raises(OptionError, match=rf"count = {count}: 1 to 500 modes are expected"):
        modes(small_scene("load"), count=count)


# --- end stiffness ---


@pytest.mark.parametrize("row", SUSPENDED[:4], ids=lambda row: f"{row['x_m']:g}-{row['z_m']:g}-{row['L_m']:g}")
def test_end_stiffness_approaches_the_smooth_catenarys(row: dict[str, float]) -> None:
    """d(H, V)/d(end), the inverse of dP/d(H, V) = int (d/d(H, V)) of (H, V - w s)/T ds (tests/validation/catenary.py),
    the midpoint rule being wrong by n^-2."""
    exact = smooth_stiffness(row)
    errors = []
    for n in (240, 480, 960):
        found = end_stiffness(slack(row, n))
        k = found[:2, :2]
        np.testing.assert_allclose(found, np.block([[k, -k], [-k, k]]), rtol=1e-12)
        np.testing.assert_allclose(k, k.T, rtol=1e-12)
        errors.append(np.abs(k - exact).max() / np.abs(exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 1.9) and np.all(orders < 2.1), (errors, orders)


def moved(cable: Cable, by: Floats) -> Floats:
    """Forces (top x, top y, end x, end y) that hold the cable with its pin moved; the top stays."""
    x, y = cable.rest_position
    there = equilibrium(replace(cable, rest_position=(x + by[0], y + by[1])))
    return np.concatenate([there.forces[0], -there.forces[-1]])


@pytest.mark.parametrize("n", [2, 3, 12, 60])
@pytest.mark.parametrize("elastic", [False, True])
def test_end_stiffness_is_that_of_differences(n: int, elastic: bool) -> None:
    """Central differences of two equilibria 2e-4 m apart, of the force on the cable at its end, and of that at its top.
    What they leave out is the third derivative times 1e-8 m^2 / 6, below 1e-6 of a slack cable's stiffness."""
    row = SUSPENDED[0]
    cable = slack(row, n)
    if elastic:
        cable = replace(cable, links=replace(cable.links, joint_stiffness=np.full(n, 2e4)))
    found, step = end_stiffness(cable), 1e-4
    for axis in (0, 1):
        by = step * np.eye(2)[axis]
        slope = (moved(cable, by) - moved(cable, -by)) / (2.0 * step)
        np.testing.assert_allclose(slope, found[:, 2 + axis], rtol=0.0, atol=1e-5 * np.abs(found).max())


def test_a_beam_is_as_stiff_as_a_beam() -> None:
    """Across a hardly bent cantilever, free along itself, L^3/(3 EI) (1 + 1/(2 n^2)), as tests/validation/elastica.py
    derives: P = 0.01 EI/L^2 changes it by some 1e-4."""
    n = 40
    found = end_stiffness(beam(n), {"F_cx": 0.01 * 628.3 / 100.0})
    compliance = np.linalg.inv(found[2:, 2:])
    assert compliance[0, 0] == pytest.approx(1000.0 / (3 * 628.3) * (1 + 0.5 / n**2), rel=2e-4)


def test_the_terminals_own_springs_are_not_in_it() -> None:
    """A spring at the end holds the cable where a pin would, and the cable is as stiff."""
    sprung = equilibrium("seabed-spring-60")
    pinned = replace(
        sprung.cable,
        terminal=Terminal.PIN,
        rest_position=sprung.terminal,
        position=sprung.q,
        parameters={
            name: value
            for name, value in sprung.cable.parameters.items()
            if name in ("g", "rho_w", "Cd", "k_joint", "c_joint", "M_1", "k_m1", "c_m1", "static_load")
        },
    )
    np.testing.assert_allclose(end_stiffness(sprung), end_stiffness(pinned), rtol=1e-6)


def test_a_taut_catenary_is_the_stiffer() -> None:
    """Span grows, sag goes: stiffness along the chord grows beyond that of the slack cable."""
    stiff = [end_stiffness(slack(row, 240))[0, 0] for row in (SUSPENDED[1], SUSPENDED[8])]
    assert stiff[1] > 100.0 * stiff[0]


@pytest.mark.parametrize("what", ["free-12-air", "free-60-water"])
def test_a_straight_cable_has_none(what: str) -> None:
    with pytest.raises(RunError, match="the cable is straight between its ends, and its links do not stretch"):
        end_stiffness(what)
