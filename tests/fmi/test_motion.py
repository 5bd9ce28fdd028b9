"""Ends whose motion the host gives: what it is inside a communication step, and the force that comes back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from scipy.interpolate import BPoly

from cablefmu.cable import Cable, Floats
from cablefmu.reference import integrate
from cablefmu.scene import Scene
from tests.conftest import Unpacked
from tests.fmu_helpers import SCENES, Host, small_scene, unpack

MOVED = ("moved", "between")
"""The top's motion is given; both ends' is."""
ENDS = {"moved": (1,), "between": (1, 2)}
STOP = 1.0
AXES = "xy"


def angles(cable: Cable) -> list[str]:
    return [f"theta[{i}]" for i in range(1, cable.n + 1)]


@cache
def truth(kind: str) -> Floats:
    """Link angles at the end, by the dense model under scipy with the motion as it is [rad]; good to 1e-9."""
    scene = small_scene(kind)
    run = integrate(scene.cable, lambda t: inputs_at(scene, t), [0.0, STOP], rtol=1e-11, atol=1e-12)
    return scene.cable.angles_in(run.q[-1])


def inputs_at(scene: Scene, time: float) -> dict[str, float]:
    return {name: signal(time) for name, signal in scene.signals.items()}


Derivatives = Callable[[float], Iterable[tuple[str, int, float]]]
"""At a time: name of an input, order, value of its derivative."""


def held(host: Host, scene: Scene, step: float, derivatives: Derivatives = lambda _: ()) -> Floats:
    """Link angles after a run in which the host sets x, v and a at every communication point [rad]."""
    host.fmu.setupExperiment(startTime=0.0, tolerance=1e-9)
    host.fmu.enterInitializationMode()
    host.set_all(inputs_at(scene, 0.0))
    host.fmu.exitInitializationMode()
    for k in range(round(STOP / step)):
        host.set_all(inputs_at(scene, k * step))
        for name, order, value in derivatives(k * step):
            host.fmu.setRealInputDerivatives([host.reference[name]], [order], [value])
        host.step(k * step, step)
    return np.array(host.get(*angles(scene.cable)))


def of_acceleration(scene: Scene, orders: int) -> Derivatives:
    """So many derivatives of the accelerations, and of nothing else."""

    def at(time: float) -> Iterable[tuple[str, int, float]]:
        for name in scene.cable.inputs:
            if name[0] == "a":
                for order, value in enumerate(scene.signals[name].derivatives(time, orders), start=1):
                    yield name, order, value

    return at


@pytest.mark.parametrize("kind", MOVED)
@pytest.mark.parametrize(("orders", "order"), [(0, 1), (1, 2), (2, 3)])
def test_order_in_the_communication_step(kind: str, orders: int, order: int, unpacked: Unpacked) -> None:
    """Inside a step v follows a and x follows v: with a held, errors of first order; with its slope, of second."""
    scene, errors = small_scene(kind), []
    for step in (0.1, 0.05, 0.025):
        with Host(unpacked(kind, 2)) as host:
            found = held(host, scene, step, of_acceleration(scene, orders))
        errors.append(float(np.max(np.abs(found - truth(kind)))))
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(observed, order, rtol=0, atol=0.35, err_msg=str(errors))


@pytest.mark.parametrize("kind", MOVED)
def test_with_many_derivatives_the_motion_is_exact(kind: str, unpacked: Unpacked) -> None:
    """Of the acceleration alone: six of them describe these sines over 0.05 s to 1e-12 of their size."""
    scene = small_scene(kind)
    with Host(unpacked(kind, 2)) as host:
        found = held(host, scene, 0.05, of_acceleration(scene, 6))
    assert np.max(np.abs(found - truth(kind))) < 1e-7


@pytest.mark.parametrize("kind", MOVED)
def test_asked_inside_the_step_the_motion_is_exact(kind: str, unpacked: Unpacked) -> None:
    """Intermediate update of FMI 3, in steps of any length; the host must give x, v and a then."""
    scene = small_scene(kind)
    with Host(unpacked(kind, 3), ask=lambda host, time: host.set_all(inputs_at(scene, time))) as host:
        host.enter_initialization(tolerance=1e-9)
        host.fmu.exitInitializationMode()
        for start, end in ((0.0, 0.5), (0.5, 0.7), (0.7, STOP)):
            host.step(start, end - start)
        found = np.array(host.get(*angles(scene.cable)))
    assert np.max(np.abs(found - truth(kind))) < 1e-7


def test_what_the_host_says_of_v_and_x_goes_before(unpacked: Unpacked) -> None:
    """A slope of v that is not a: the host's word, in the saved state as well."""
    scene, ends = small_scene("moved"), []
    for slope in (None, 0.0, 0.7):
        with Host(unpacked("moved", 2)) as host:
            given = [] if slope is None else [("vy_1", 1, slope)]
            held(host, scene, 0.5, lambda _, given=given: given)
            ends.append(host.get("vy_c", "y_c"))
    assert len({tuple(end) for end in ends}) == 3


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", MOVED)
def test_a_state_saved_in_mid_run_goes_on_with_the_same_bits(kind: str, fmi: int, unpacked: Unpacked) -> None:
    """Before a step whose inputs have slopes (FMI 2): of v as well as of a, so that x alone follows."""
    scene = small_scene(kind)

    def go_on(host: Host) -> Floats:
        rows = []
        for k in range(3, 6):
            host.set_all(inputs_at(scene, 0.1 * k)) if k > 3 else None
            host.step(0.1 * k, 0.1)
            rows.append(host.get(*host.names("output"), *angles(scene.cable)))
        return np.array(rows)

    with Host(unpacked(kind, fmi)) as host, Host(unpacked(kind, fmi)) as other:
        host.initialize()
        for k in range(4):
            host.set_all(inputs_at(scene, 0.1 * k))
            if fmi == 2:
                slopes = {name: 0.3 for name in scene.cable.inputs if name[0] in "av"}
                references = [host.reference[name] for name in slopes]
                host.fmu.setRealInputDerivatives(references, [1] * len(slopes), list(slopes.values()))
            if k < 3:
                host.step(0.1 * k, 0.1)
        image = host.save()
        np.testing.assert_array_equal(go_on(other.initialize().load(image)), go_on(host))
        assert host.save() == other.save()


# --- the force ---


def weight(cable: Cable, *, load: bool) -> float:
    """Submerged [N]."""
    g, density = cable.parameters["g"], cable.parameters["rho_w"]
    links = float(np.sum(cable.links.mass - density * cable.links.volume))
    if not load:
        return links * g
    mass = cable.parameters["m_c"]
    return (links + mass * (1.0 - density / cable.parameters["rho_c"])) * g


def edited(kind: str, *edits: tuple[str, str]) -> Scene:
    text = SCENES[kind]
    for old, new in edits:
        assert text.count(old) == 1
        text = text.replace(old, new)
    return Scene.from_text(text, name=kind)


def without_motion(kind: str) -> Scene:
    text = "\n".join(line for line in SCENES[kind].splitlines() if not line.startswith(("x_1", "y_1", "y_2")))
    return Scene.from_text(text.replace("angle = 0.5", "angle = 0.0"), name=kind)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_load_at_rest_pulls_with_its_weight_downward(fmi: int, tmp_path: Path) -> None:
    scene = without_motion("moved")
    with Host(unpack(scene, tmp_path, fmi)) as host:
        force_x, force_y = host.initialize().get("F_1x", "F_1y")
    assert force_y == pytest.approx(weight(scene.cable, load=True), rel=1e-12)
    assert abs(force_x) < 1e-9


def test_two_vessels_share_the_weight_and_are_drawn_together(tmp_path: Path) -> None:
    """The shape hangs by itself without the joints' stiffness, and a vessel moves by no force."""
    scene = without_motion("between")
    limp = Scene.from_text(scene.text.replace("young_modulus = 8e10", "joint_stiffness = 0"), name="between")
    with Host(unpack(limp, tmp_path, 2)) as host:
        x1, y1, x2, y2 = host.initialize().get("F_1x", "F_1y", "F_2x", "F_2y")
    assert y1 + y2 == pytest.approx(weight(limp.cable, load=False), rel=1e-9)
    assert x1 > 0.0 > x2
    assert x1 == pytest.approx(-x2, rel=1e-9)


def test_inertia_pulls_against_the_acceleration(unpacked: Unpacked) -> None:
    """dF/da, what FMI calls direct feedthrough: that of F is declared, and F is linear in a."""
    with Host(unpacked("moved", 2)) as host:
        unknowns = {u.variable.name: u.dependencies for u in host.description.outputs}
        assert unknowns["F_1x"] is None and unknowns["F_1y"] is None, "on everything"
        host.initialize()
        names = ("F_1x", "F_1y")
        before = np.array(host.get(*names))
        (start,) = host.get("ay_1")
        by = host.fmu.getDirectionalDerivative([host.reference[n] for n in names], [host.reference["ay_1"]], [1.0])
        host.set(ay_1=start + 2.0)
        np.testing.assert_allclose(np.array(host.get(*names)) - before, 2.0 * np.array(by), rtol=1e-10)
        (xy, yy) = host.get("m_1xy", "m_1yy")
        np.testing.assert_allclose(by, [-xy, -yy], rtol=1e-12)
        total = float(np.sum(small_scene("moved").cable.links.mass)) + 60.0
        assert -total < by[1] < 0.0, "less than all of the mass, which may turn out of the way"


STEP = 0.05


def test_the_vessel_inside_and_outside(tmp_path: Path) -> None:
    """A floater driven by forces; then its motion, as a vessel's, moves the same cable: the same motion and pull.

    Between communication points the motion is the polynomial of fifth degree through x, v and a of both, whose error
    in a is of fourth order: measured 2e-8 rad, 4e-7 of the pull.
    """
    load = ('[terminal]\nkind = "pin"\n' + 'position = [12, 13]\n[shape]\nkind = "catenary"\n',
            SCENES["moved"][SCENES["moved"].index("[terminal]"):])  # fmt: skip
    inside = edited("surge", load)
    outside = small_scene("moved")
    count = round(1.5 / STEP)
    with Host(unpack(inside, tmp_path / "in", 2), interface="cs") as host:
        reference = host.reference
        motion, pulls, bends = [], [], []
        host.enter_initialization(tolerance=1e-10)
        host.set(u_m1=700.0, u_m1x=-400.0)
        host.fmu.exitInitializationMode()
        for k in range(count + 1):
            x, y, vx, vy, ax, ay = host.get("x_m1", "y_m1", "vx_m1", "v_m1", "der(vx_m1)", "der(v_m1)")
            motion.append(np.array([[x, vx, ax], [y, vy, ay]]))
            pulls.append(floater_pull(inside.cable, motion[-1], (-400.0, 700.0)))
            bends.append(host.get(*angles(inside.cable)))
            if k < count:
                host.step(k * STEP, STEP)
    assert reference["x_m1"]
    with Host(unpack(outside, tmp_path / "out", 2)) as host:
        host.set_all(named(motion[0]))
        host.enter_initialization(tolerance=1e-10)
        host.fmu.exitInitializationMode()
        for k in range(count + 1):
            host.set_all(named(motion[k]))
            np.testing.assert_allclose(host.get("F_1x", "F_1y"), pulls[k], rtol=0, atol=1e-5 * np.max(np.abs(pulls)))
            np.testing.assert_allclose(host.get(*angles(outside.cable)), bends[k], rtol=0, atol=1e-6)
            if k == count:
                break
            for axis in range(2):
                path = BPoly.from_derivatives([0.0, STEP], [motion[k][axis], motion[k + 1][axis]])
                values = [float(path.derivative(order)(0.0)) for order in (3, 4, 5)]
                host.fmu.setRealInputDerivatives([host.reference[f"a{AXES[axis]}_1"]] * 3, [1, 2, 3], values)
            host.step(k * STEP, STEP)
    assert np.ptp(np.array(bends), axis=0).max() > 0.1, "it moves"


def floater_pull(cable: Cable, motion: Floats, forces: tuple[float, float]) -> Floats:
    """What the cable does to the floater by the floater's own equation: M a, springs, dampers, less what else pulls."""
    p = cable.parameters
    static, stiffness, damping = ("static_pull", "static_load"), ("k_m1H", "k_m1"), ("c_m1H", "c_m1")
    return np.array([
        p["M_1"] * a + p[damping[k]] * v + p[stiffness[k]] * x + p[static[k]] - forces[k]
        for k, (x, v, a) in enumerate(motion)
    ])  # fmt: skip


def named(motion: Floats) -> Mapping[str, float]:
    """x_1 ... ay_1 of position, velocity and acceleration along x and y, shape (2, 3)."""
    return {f"{kind}{AXES[axis]}_1": float(motion[axis, k]) for k, kind in enumerate(("", "v", "a")) for axis in (0, 1)}


# --- borders ---


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", ["x_1", "vy_1", "ax_1"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_no_number_is_refused(fmi: int, name: str, value: float, unpacked: Unpacked) -> None:
    with Host(unpacked("moved", fmi)) as host:
        host.initialize()
        before = host.get(name)
        says = host.refusal(host.set_all, {name: value})
        assert says == f"{name} = {value:g} at t = 0 s: a finite number is expected"
        assert host.get(name) == before
        host.step(0.0, 0.1)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", MOVED)
def test_states_of_a_given_top_are_those_of_links_alone(kind: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked(kind, fmi), interface="me") as host:
        host.initialize()
        links = range(1, 6)
        assert host.number_of_states() == 10
        of = [u.variable.derivative.name for u in host.description.derivatives]
        assert of == [*(f"theta[{i}]" for i in links), *(f"omega[{i}]" for i in links)]
        x = np.linspace(-0.3, 0.6, 10)
        host.set_states(x)
        assert host.get(*of) == x.tolist()
        np.testing.assert_array_equal(host.states(), x)
        assert host.get(*(f"der({name})" for name in of)) == host.derivatives().tolist()
        assert host.derivatives()[:5].tolist() == x[5:].tolist()
        assert "12 states were given or asked for; this cable has 10" in host.refusal(host.set_states, np.zeros(12))


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_start_away_from_rest(fmi: int, unpacked: Unpacked) -> None:
    """x_1 starts at 0.2 m, and the cable with it; between two vessels the shape reaches from one to the other."""
    with Host(unpacked("moved", fmi)) as host:
        x, y = host.initialize().get("x_c", "y_c")
        assert host.get("x_1", "y_1") == pytest.approx([0.2, 0.0], abs=1e-15)
        assert (x, y) == pytest.approx((0.2 + 20.0 * math.sin(0.5), 20.0 * math.cos(0.5)), rel=1e-12)
    with Host(unpacked("between", fmi)) as host:
        host.initialize()
        assert host.get("x_2", "y_2") == pytest.approx([12.0, 12.9])
        # The shape meets the port to 1e-9 of the cable.
        assert host.get("x_c", "y_c") == pytest.approx(host.get("x_2", "y_2"), abs=2e-8)


# --- without accelerations ---


def unaccelerated(kind: str) -> Scene:
    text = SCENES[kind].replace('kind = "motion"', 'kind = "motion"\nacceleration = false')
    return Scene.from_text(text, name=kind)


@pytest.mark.parametrize("kind", MOVED)
def test_a_host_without_accelerations_has_first_order(kind: str, tmp_path: Path) -> None:
    """What v did since the last step takes their place; at the first step nothing does."""
    scene, errors = unaccelerated(kind), []
    assert not any(name[0] == "a" for name in scene.cable.inputs)
    folder = unpack(scene, tmp_path, 2)
    for step in (0.05, 0.025, 0.0125):
        with Host(folder) as host:
            errors.append(float(np.max(np.abs(held(host, scene, step) - truth(kind)))))
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(observed, 1.0, rtol=0, atol=0.5, err_msg=str(errors))


def test_the_slope_of_the_velocity_is_the_acceleration(tmp_path: Path, unpacked: Unpacked) -> None:
    """Given for each step, the run is to the bit that with the same accelerations held."""
    scene = unaccelerated("moved")

    def slopes(time: float) -> Iterable[tuple[str, int, float]]:
        return [(name, 1, scene.signals[name].derivatives(time, 1)[0]) for name in ("vx_1", "vy_1")]

    with Host(unpack(scene, tmp_path, 2)) as host, Host(unpacked("moved", 2)) as other:
        found = held(host, scene, 0.1, slopes)
        np.testing.assert_array_equal(found, held(other, small_scene("moved"), 0.1))


@pytest.mark.parametrize("fmi", [2, 3])
def test_its_state_saved_in_mid_run_goes_on_with_the_same_bits(fmi: int, tmp_path: Path) -> None:
    """The velocity of the step before belongs to it."""
    scene = unaccelerated("between")
    folder = unpack(scene, tmp_path, fmi)
    with Host(folder) as host, Host(folder) as other:
        host.initialize()
        for k in range(3):
            host.set_all(inputs_at(scene, 0.1 * k))
            host.step(0.1 * k, 0.1)
        other.initialize().load(host.save())
        for each in (host, other):
            each.set_all(inputs_at(scene, 0.3))
            each.step(0.3, 0.1)
        assert host.get("F_1x", "F_2y", *angles(scene.cable)) == other.get("F_1x", "F_2y", *angles(scene.cable))
        assert host.save() == other.save()


@pytest.mark.parametrize("fmi", [2, 3])
def test_model_exchange_needs_accelerations(fmi: int, tmp_path: Path) -> None:
    """It is not offered, and refused to who asks all the same."""
    folder = unpack(unaccelerated("moved"), tmp_path, fmi)
    description = read_model_description(str(folder), validate=True)
    assert description.modelExchange is None and description.coSimulation is not None
