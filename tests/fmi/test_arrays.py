"""FMI 3 arrays: one FMU with n links is to the bit the FMU of the scene that is written with n links."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from fmpy import fmi3, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException

from cablefmu.cable import Floats, Top
from tests.fmu_helpers import KINDS, Host, from_equilibrium, pushed, small_scene, unpack, with_links

Arrays = Callable[[str], Path]
LOADS = ("air", "load", "load-volume", "moved")
HELD = tuple(kind for kind in KINDS if kind not in LOADS)
CASES = [(kind, n) for kind in KINDS for n in ((1, 2, 5, 9, 60) if kind in LOADS else (2, 5, 9, 60))]
every = pytest.mark.parametrize(("kind", "n"), CASES)
STATES = ("theta", "omega", "der(theta)", "der(omega)")


def elements(array: str, n: int) -> list[str]:
    """What an FMU without arrays has instead: theta[1], der(theta[1]), ..."""
    stem, end = (array.removesuffix(")"), ")") if array.endswith(")") else (array, "")
    return [f"{stem}[{i}]{end}" for i in range(1, n + 1)]


def scalars(host: Host, array: str, n: int) -> list[float]:
    """The same of an FMU without arrays."""
    return host.get(*elements(array, n))


def run(host: Host, stop: float) -> Floats:
    """All outputs, the solver's health among them, every 0.1 s under a push that grows."""
    host.initialize(**pushed(host.reference, 0.0, 300.0))
    rows = [host.get(*host.names("output"))]
    for k in range(round(stop / 0.1)):
        host.set_all(pushed(host.reference, 0.1 * k, 300.0 + 100.0 * k))
        host.step(k * 0.1, 0.1)
        rows.append(host.get(*host.names("output")))
    return np.array(rows)


# --- to the bit ---


@every
def test_a_run_is_that_of_the_scene_with_as_many_links(
    kind: str, n: int, unpacked_arrays: Arrays, tmp_path: Path
) -> None:
    with (
        Host(unpacked_arrays(kind)).configure(n) as host,
        Host(unpack(with_links(small_scene(kind), n), tmp_path, 3)) as other,
    ):
        np.testing.assert_array_equal(run(host, 0.5), run(other, 0.5))
        assert host.names("output") == other.names("output")
        for array in STATES:
            assert host.get_array(array) == scalars(other, array, n)
            assert len(set(host.get_array(array))) > 1 or n == 1, "a run in which nothing bends shows little"


@every
def test_model_exchange_is_that_of_the_scene_with_as_many_links(
    kind: str, n: int, unpacked_arrays: Arrays, tmp_path: Path
) -> None:
    scene = with_links(small_scene(kind), n)
    other_folder = unpack(scene, tmp_path, 3)
    states, first = 2 * scene.cable.coordinates, 0 if scene.cable.top is Top.MOTION else 1
    with (
        Host(unpacked_arrays(kind), interface="me").configure(n) as host,
        Host(other_folder, interface="me") as other,
    ):
        for one in (host, other):
            one.initialize(**pushed(one.reference, 0.0, 300.0))
            assert one.number_of_states() == states
        np.testing.assert_array_equal(host.states(), other.states())
        np.testing.assert_array_equal(host.derivatives(), other.derivatives())
        moved = other.states() + np.linspace(-0.3, 0.4, states)
        for one in (host, other):
            one.set_states(moved)
        np.testing.assert_array_equal(host.derivatives(), other.derivatives())
        q, v = np.split(moved, 2)
        (heave, angles, surge), (rate, rates, along) = (np.split(part, [first, first + n]) for part in (q, v))
        tops = [name for name in ("y_m1", "x_m1", "v_m1", "vx_m1") if name in host.reference]
        assert host.get(*tops) == [*heave, *surge, *rate, *along]
        assert (host.get_array("theta"), host.get_array("omega")) == (angles.tolist(), rates.tolist())
        assert host.get_array("der(theta)") == rates.tolist()
        assert host.get_array("der(omega)") == host.derivatives()[states // 2 + first :][:n].tolist()


@pytest.mark.parametrize("n", [1, 60, 1000])
def test_one_fmu_with_few_links_and_with_many(n: int, unpacked_arrays: Arrays, tmp_path: Path) -> None:
    with (
        Host(unpacked_arrays("load")).configure(n) as host,
        Host(unpack(with_links(small_scene("load"), n), tmp_path, 3)) as other,
    ):
        np.testing.assert_array_equal(run(host, 0.2), run(other, 0.2))
        assert host.get_array("theta") == scalars(other, "theta", n)


@pytest.mark.parametrize("kind", KINDS)
def test_a_start_from_equilibrium_as_well(kind: str, tmp_path: Path) -> None:
    scene = from_equilibrium(small_scene(kind))
    with (
        Host(unpack(scene, tmp_path / "arrays", 3, arrays=True)).configure(12) as host,
        Host(unpack(with_links(scene, 12), tmp_path / "scalars", 3)) as other,
    ):
        np.testing.assert_array_equal(run(host, 0.2), run(other, 0.2))
        assert host.get_array("theta") == scalars(other, "theta", 12)
        assert host.get("statics.iterations") > [0.0]


@pytest.mark.parametrize(("kind", "n"), [("load", 1), ("load", 60), ("floater", 9), ("pin", 9)])
def test_derivatives_take_arrays_as_a_whole(kind: str, n: int, unpacked_arrays: Arrays, tmp_path: Path) -> None:
    """A reference stands for n seeds or sensitivities, in their order."""
    unknowns, knowns = ["x_c", "der(omega)", "tension_max", "der(theta)"], ["omega", "u_m1", "theta", "y_m1"]

    def one_by_one(names: list[str]) -> list[str]:
        scalar = {
            "theta": "theta[{}]",
            "omega": "omega[{}]",
            "der(omega)": "der(omega[{}])",
            "der(theta)": "der(theta[{}])",
        }
        return [scalar.get(name, name).format(i) for name in names for i in range(1, n + 1 if name in scalar else 2)]

    rng = np.random.default_rng(3)
    by_known, by_unknown = rng.normal(size=2 * n + 2), rng.normal(size=2 * n + 2)
    built = unpack(with_links(small_scene(kind), n), tmp_path, 3)
    with (
        Host(unpacked_arrays(kind), interface="me").configure(n) as host,
        Host(built, interface="me") as other,
    ):
        moved = other.initialize().states() + rng.normal(size=2 * n + 2, scale=0.1)
        other.set_states(moved)
        host.initialize().set_states(moved)
        found, expected = np.empty((2, 2 * n + 2)), np.empty((2, 2 * n + 2))
        for one, names, values in ((host, list, found), (other, one_by_one, expected)):
            of, by = ([one.reference[name] for name in names(group)] for group in (unknowns, knowns))
            values[0] = sensitivities(one, "fmi3GetDirectionalDerivative", of, by, by_known)
            values[1] = sensitivities(one, "fmi3GetAdjointDerivative", of, by, by_unknown)
        np.testing.assert_array_equal(found, expected)
        # The two are each other's transpose.
        assert by_unknown @ found[0] == pytest.approx(by_known @ found[1], rel=1e-10)
        wrong = (host.reference["theta"],), (host.reference["omega"],), np.ones(2 * n + 3)
        with pytest.raises(FMICallException):
            sensitivities(host, "fmi3GetDirectionalDerivative", *wrong)
        assert "a seed for every known" in host.messages[-1]


def sensitivities(host: Host, function: str, of: Sequence[int], by: Sequence[int], seed: Floats) -> Floats:
    """With as many results as seeds."""
    sensitivity = np.empty_like(seed)
    pointers = [values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for values in (seed, sensitivity)]
    unknowns, knowns = (ctypes.c_uint32 * len(of))(*of), (ctypes.c_uint32 * len(by))(*by)
    call = getattr(host.fmu, function)
    call(host.fmu.component, unknowns, len(of), knowns, len(by), pointers[0], len(seed), pointers[1], len(seed))
    return sensitivity


def test_arrays_of_states_are_moved_as_variables_in_model_exchange(unpacked_arrays: Arrays) -> None:
    with Host(unpacked_arrays("load"), interface="me").configure(3) as host:
        host.initialize()
        references = [host.reference[name] for name in ("omega", "y_m1", "theta")]
        host.fmu.setFloat64(references, [0.1, 0.2, 0.3, 0.5, -0.1, -0.2, -0.3])
        np.testing.assert_array_equal(host.states(), [0.5, -0.1, -0.2, -0.3, 0.0, 0.1, 0.2, 0.3])
        says = host.refusal(host.fmu.setFloat64, references, [0.1, math.nan, 0.3, 0.5, -0.1, -0.2, -0.3])
        assert says == "omega = nan at t = 0 s: a finite number is expected"
        np.testing.assert_array_equal(host.states(), [0.5, -0.1, -0.2, -0.3, 0.0, 0.1, 0.2, 0.3])


def test_ten_thousand_links(unpacked_arrays: Arrays) -> None:
    """Pulled sideways, the end moves by 6 mm; a line through 1/200 and 1/400 says where that is at 1/10,000."""
    ends = {}
    for n in (200, 400, 10_000):
        with Host(unpacked_arrays("load")).configure(n) as host:
            host.initialize(theta_start=0.0, F_cx=20.0)
            host.step(0.0, 0.2)
            assert len(host.get_array("theta")) == n
            assert np.all(np.isfinite(host.get_array("omega")))
            (ends[n],) = host.get("x_c")
    slope = 400.0 * (ends[200] - ends[400])
    # The line misses what is of second order in 1/n, and every run has its tolerance: measured 1e-7 m.
    assert ends[10_000] == pytest.approx(ends[400] + slope * (1 / 10_000 - 1 / 400), rel=0, abs=1e-6)
    assert abs(ends[10_000] - ends[400]) > 4e-6


@pytest.mark.parametrize("n", [3, 60])
def test_fmpy_simulates_an_instance_that_was_configured(n: int, unpacked_arrays: Arrays, tmp_path: Path) -> None:
    """FMPy's `simulate_fmu` has no configuration mode of its own; the size of arrays it takes from the description."""
    folder = unpacked_arrays("load")
    description = read_model_description(str(folder), validate=False)
    fmu = fmi3.FMU3Slave(
        guid=description.guid, unzipDirectory=str(folder), modelIdentifier=description.coSimulation.modelIdentifier
    )
    fmu.instantiate()
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu.enterConfigurationMode()
    fmu.setUInt64([reference["n"]], [n])
    fmu.exitConfigurationMode()
    for variable in description.modelVariables:
        variable.shape = (n,) if variable.dimensions else ()
    how: dict[str, object] = {"stop_time": 0.5, "output_interval": 0.1, "start_values": {"u_m1": 500.0}}
    arrays = simulate_fmu(folder, model_description=description, fmu_instance=fmu, output=["x_c", "theta"], **how)
    fmu.freeInstance()
    names = [f"theta[{i}]" for i in range(1, n + 1)]
    built = unpack(with_links(small_scene("load"), n), tmp_path, 3)
    plain = simulate_fmu(built, output=["x_c", *names], **how)
    np.testing.assert_array_equal(arrays["x_c"], plain["x_c"])
    np.testing.assert_array_equal(arrays["theta"], np.array([plain[name] for name in names]).T)


# --- parameters of the whole cable ---

TOLD = {"L": ("length = 20", "length = 21.5"), "D": ("diameter = 0.02", "diameter = 0.03"),
        "rho_cable": ("density = 7850\nyoung", "density = 5000\nyoung"),
        "theta_start": ("angle = 0.5", "angle = -0.7")}  # fmt: skip
"""Parameter -> the edit of the scene that says the same."""


@pytest.mark.parametrize(("kind", "name"), [
    (kind, name) for kind in KINDS for name in TOLD if kind in LOADS or name != "theta_start"
])  # fmt: skip
def test_setting_is_writing(kind: str, name: str, unpacked_arrays: Arrays, tmp_path: Path) -> None:
    """To the bit, but for what the scene derives and the FMU has as a parameter: those are taken over."""
    old, new = TOLD[name]
    scene = with_links(small_scene(kind), 7)
    text = scene.text.replace(old, new)
    assert text != scene.text
    value = float(new.partition("= ")[2].partition("\n")[0])
    with (
        Host(unpacked_arrays(kind)).configure(7) as host,
        Host(unpack(type(scene).from_text(text, name=kind), tmp_path, 3)) as other,
    ):
        (stiffness,) = other.get("k_joint")
        given = {name: value, "EI": stiffness * (value if name == "L" else 20.0) / 7}
        if "static_load" in host.names("parameter"):
            given["static_load"] = other.get("static_load")[0]
        host.set_all(given)
        # EI / l and k l / l may differ in the last bit, and a run multiplies that.
        np.testing.assert_allclose(run(host, 0.3), run(other, 0.3), rtol=1e-9, atol=1e-9)


def test_bending_stiffness_is_that_of_the_joints(unpacked_arrays: Arrays, tmp_path: Path) -> None:
    scene = small_scene("load")
    text = scene.text.replace("young_modulus = 8e10", "joint_stiffness = 250.0")
    with (
        Host(unpacked_arrays("load")) as host,
        Host(unpack(type(scene).from_text(text, name="load"), tmp_path, 3)) as other,
    ):
        host.set(EI=1000.0)  # over links of 4 m
        np.testing.assert_array_equal(run(host, 0.5), run(other, 0.5))


def test_a_stiffness_per_joint_stays_one(tmp_path: Path) -> None:
    scene = small_scene("load")
    scene = type(scene).from_text(scene.text.replace("young_modulus = 8e10", "joint_stiffness = 250.0"), name="load")
    with (
        Host(unpack(scene, tmp_path / "arrays", 3, arrays=True)).configure(11) as host,
        Host(unpack(with_links(scene, 11), tmp_path / "scalars", 3)) as other,
    ):
        assert "EI" not in host.reference
        np.testing.assert_array_equal(run(host, 0.5), run(other, 0.5))


@pytest.mark.parametrize("kind", ["anchor-spring", "floater"])
def test_preloads_follow_the_rest_shape(kind: str, unpacked_arrays: Arrays, tmp_path: Path) -> None:
    """They are calculated, from gravity as well, where a scene without arrays keeps what it was built with."""
    scene = with_links(small_scene(kind), 8)
    heavier = type(scene).from_text("gravity = 12.0\n" + scene.text, name=kind)
    with Host(unpacked_arrays(kind)).configure(8) as host, Host(unpack(heavier, tmp_path, 3)) as other:
        names = ("static_load", "static_load_2", "static_pull_2")
        assert host.names("calculatedParameter") == list(names)
        host.initialize(g=12.0)
        other.initialize()
        assert host.get(*names) == other.get(*names)
        assert host.get_array("theta") == scalars(other, "theta", 8)
        assert "static_load = 1 at t = 0 s: it is calculated" in host.refusal(host.set, static_load=1.0)


def test_a_static_load_that_the_scene_gives_is_kept(tmp_path: Path) -> None:
    scene = small_scene("floater")
    scene = type(scene).from_text(scene.text.replace("damping = 240\n", "damping = 240\nstatic_load = 150\n"), name="x")
    with (
        Host(unpack(scene, tmp_path / "arrays", 3, arrays=True)).configure(9) as host,
        Host(unpack(with_links(scene, 9), tmp_path / "scalars", 3)) as other,
    ):
        assert host.names("calculatedParameter") == ["static_load_2", "static_pull_2"]
        np.testing.assert_array_equal(run(host, 0.5), run(other, 0.5))
        assert host.get("static_load") == [150.0]
