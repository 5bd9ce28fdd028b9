"""The coupling error: mass inside and mass outside are one motion, and a report finds out how far runs are from it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cablefmu.cable import Floats
from cablefmu.coupling import load_coupling
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.extrapolation import through
from cablefmu.coupling.partners import make_partner
from cablefmu.coupling.run import run_system
from cablefmu.coupling.schema import AdaptiveSpec
from cablefmu.coupling.system import System, opened, varied
from cablefmu.coupling_report import CouplingReport, make_coupling_report
from cablefmu.coupling_report_command import names_coupling
from cablefmu.coupling_report_files import write_coupling_report, write_orders
from cablefmu.coupling_report_tables import ORDER_NAMES, coupling_sheets
from cablefmu.coupling_report_truth import Truth, find_truth
from cablefmu.coupling_report_whole import NotOneError, whole_scene
from cablefmu.errors import OptionError, RunError
from cablefmu.reference import Reference
from cablefmu.scene import load_scene
from cablefmu.vessel import BodyTable, Vessel
from tests.coupling.ships import NAMES, STOP, small

GOOD = 1e-8
"""Of the FMU of the whole at 1e-10 against either dense integration [m]; measured: below 1e-9."""


def mass_outside(coupling: Coupling, times: Floats) -> Floats:
    """x, y of the vessel and x_c, y_c [m] by the dense model of a cable whose top is given, and the vessel beside it.

    The loop between force and acceleration is solved by what the model says of it: F = F(a = 0) - m a. No code of the
    FMUs or of the master, and none of the equations of a floater.
    """
    spec = coupling.spec.model
    body = Vessel.from_table(spec[0].vessel).table
    assert isinstance(body, BodyTable)
    model = Reference(load_scene(coupling.folder / "ship.toml").cable)
    n = model.cable.n
    mass = np.diag([body.m_x, body.m_y])
    stiffness, damping = np.array([body.k_x, body.k_y]), np.array([body.c_x, body.c_y])
    load = np.array([body.external_x - body.static_load_x, body.external_y - body.static_load_y])

    def inputs(state: Floats, a: Floats) -> dict[str, float]:
        names = ("x_1", "y_1", "vx_1", "vy_1", "ax_1", "ay_1")
        return dict(zip(names, [*state[2 * n : 2 * n + 4], *a], strict=True))

    def right_side(t: float, state: Floats) -> Floats:
        q, v, place, velocity = state[:n], state[n : 2 * n], state[2 * n : 2 * n + 2], state[2 * n + 2 :]
        said = model.outputs(q, v, inputs(state, np.zeros(2)))
        added = np.array([[said["m_1xx"], said["m_1xy"]], [said["m_1xy"], said["m_1yy"]]])
        force = np.array([said["F_1x"], said["F_1y"]])
        a = np.linalg.solve(mass + added, force + load - stiffness * place - damping * velocity)
        return np.concatenate([v, model.acceleration(q, v, inputs(state, a)), velocity, a])

    start = [*model.cable.position, *model.cable.velocity, body.x_0, body.y_0, body.vx_0, body.vy_0]
    states = solve_ivp(right_side, (0.0, times[-1]), start, "DOP853", times, rtol=1e-10, atol=1e-12).y.T
    ends = [model.outputs(s[:n], s[n : 2 * n], inputs(s, np.zeros(2))) for s in states]
    return np.column_stack([states[:, 2 * n : 2 * n + 2], [(end["x_c"], end["y_c"]) for end in ends]])


@pytest.mark.parametrize("mass", [4000.0, 40.0])
def test_mass_inside_is_mass_outside(mass: float, tmp_path: Path) -> None:
    coupling = small(tmp_path, mass=mass)
    with opened(coupling) as system:
        truth = find_truth(system)
    times = np.arange(5) * 0.6
    assert truth.is_whole and truth.good_to < GOOD
    found = np.column_stack([truth.at(times)[name] for name in NAMES])
    assert np.ptp(found, axis=0).min() > 0.2  # m: there is something to agree on
    assert found == pytest.approx(mass_outside(coupling, times), abs=GOOD)


def largest(coupling: Coupling, truth: Truth, *, since: float = 0.1 * STOP, **settings: object) -> float:
    """Error of a run from a time on, by default after the first 10 % [m]."""
    with opened(coupling) as system:
        result = run_system(varied(system, **settings))
    right, late = truth.at(result["time"].values), result["time"].values >= since
    return max(float(np.abs(result[name].values - right[name])[late].max()) for name in NAMES)


@pytest.mark.parametrize(
    ("algorithm", "extrapolation", "order"),
    [("jacobi", 0, 1), ("jacobi", 1, 2), ("jacobi", 2, 3),
     ("gauss-seidel", 0, 1), ("gauss-seidel", 1, 2), ("gauss-seidel", 2, 3),
     ("iterated", 0, 1), ("iterated", 1, 2), ("iterated", 2, 3)],
)  # fmt: skip
def test_coupled_runs_tend_to_the_whole(algorithm: str, extrapolation: int, order: int, tmp_path: Path) -> None:
    coupling = small(tmp_path)
    with opened(coupling) as system:
        truth = find_truth(system)
    errors = [
        largest(coupling, truth, algorithm=algorithm, extrapolation=extrapolation, step=0.1 / 2**k) for k in range(3)
    ]
    observed = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert observed == pytest.approx([order] * 2, abs=0.35), errors
    assert errors[-1] > 10.0 * truth.good_to  # what was measured is the coupling


@pytest.mark.parametrize(("starts_iterated", "order"), [(True, 3.0), (False, 2.0)])
def test_the_order_of_quadratic_inputs_is_decided_by_the_first_steps(
    starts_iterated: bool, order: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Over the whole run: iterated, they err as all others do; with too few samples by the step squared."""
    coupling = small(tmp_path)
    with opened(coupling) as system:
        truth = find_truth(system)
        assert [varied(system, extrapolation=order).starts_iterated for order in (0, 2)] == [False, True]
    if not starts_iterated:
        monkeypatch.setattr(System, "starts_iterated", False)
    errors = [
        largest(coupling, truth, since=0.0, algorithm="jacobi", extrapolation=2, step=h) for h in (0.05, 0.025, 0.0125)
    ]
    assert np.log2(np.array(errors[:-1]) / np.array(errors[1:])) == pytest.approx([order] * 2, abs=0.1), errors


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel"])
def test_quadratic_inputs_are_of_third_order_for_the_moored_vessel(
    algorithm: str, moored: tuple[System, Truth]
) -> None:
    """From the start, with steps that resolve what the cable's force does in the first tenths of a second."""
    system, truth = moored
    errors = []
    for step in (0.0125, 0.00625):
        result = run_system(varied(system, algorithm=algorithm, extrapolation=2, step=step))
        right = truth.at(result["time"].values)
        errors.append(max(float(np.abs(result[name].values - right[name]).max()) for name in NAMES))
    assert np.log2(errors[0] / errors[1]) > 2.8, errors
    assert errors[1] > 10.0 * truth.good_to


@pytest.fixture(scope="module")
def moored() -> Iterator[tuple[System, Truth]]:
    """The first second of the coupling that ships."""
    with opened(load_coupling("moored-vessel")) as system:
        system = varied(system, stop_time=1.0)
        yield system, find_truth(system)


@pytest.mark.parametrize(("name", "algorithm"), [("moored-vessel", "jacobi"), ("light-vessel", "iterated")])
def test_adaptive_steps_begin(name: str, algorithm: str) -> None:
    """At a tolerance whose first steps, were they held, would be too wrong to go on from."""
    with opened(load_coupling(name)) as system:
        adaptive = AdaptiveSpec(tolerance=1e-4, smallest=0.1 / 256.0, largest=0.1)
        settings = {"algorithm": algorithm, "extrapolation": 1, "adaptive": adaptive, "step": 0.1, "stop_time": 0.4}
        result = run_system(varied(system, **settings))
    assert result.attrs["longest_step"] > 4.0 * result.attrs["shortest_step"]


def test_light_vessels_need_iteration(tmp_path: Path) -> None:
    """At one step; at all, below."""
    coupling = small(tmp_path, mass=40.0)
    with opened(coupling) as system:
        truth = find_truth(system)
    assert largest(coupling, truth, algorithm="iterated", extrapolation=1, step=0.05) < 0.01 * truth.motion
    for algorithm in ("jacobi", "gauss-seidel"):
        try:
            error = largest(coupling, truth, algorithm=algorithm, extrapolation=1, step=0.05)
        except RunError:
            continue
        assert error > truth.motion


@pytest.fixture(scope="module")
def light(tmp_path_factory: pytest.TempPathFactory) -> CouplingReport:
    """A vessel a third as heavy as what hangs from it, at two steps."""
    return make_coupling_report(small(tmp_path_factory.mktemp("light"), mass=40.0), steps=(1.0, 0.5, 0.25), limit=5.0)


@pytest.mark.slow
def test_a_light_vessel_needs_iteration(light: CouplingReport) -> None:
    for row in light.rows:
        if row.algorithm != "iterated" and row.adaptive is None:
            assert row.note.startswith(("diverged: off by", "failed: ")), row
    linear = [row for row in light.rows if (row.algorithm, row.extrapolation) == ("iterated", 1) and not row.adaptive]
    assert len(linear) == 3 and all(row.is_stable for row in linear)
    assert linear[0].position is not None and linear[0].position < 0.01 * light.truth.motion
    family = next(f for f in light.families if (f.algorithm, f.extrapolation) == ("jacobi", 1))
    assert family.longest_stable is None and family.note
    assert any(
        "diverged" in cell or "failed" in cell for sheet in coupling_sheets(light) for row in sheet.rows for cell in row
    )


@pytest.mark.slow
def test_the_recommended_setting_keeps_the_accuracy(light: CouplingReport) -> None:
    """Run anew, and measured against the dense model with the mass outside."""
    best = light.recommended
    assert best is not None and best.algorithm == "iterated"
    assert light.accuracy == pytest.approx(0.01 * light.truth.motion)
    assert best.adaptive is None  # those cost several times as much here
    with opened(light.coupling) as system:
        result = run_system(varied(system, algorithm=best.algorithm, extrapolation=best.extrapolation, step=best.step))
    found = np.column_stack([result[name].values for name in NAMES])
    assert np.abs(found - mass_outside(light.coupling, result["time"].values)).max() <= light.accuracy
    cheaper = [row for row in light.rows if row.cpu_time < 0.9 * best.cpu_time and row.is_stable]
    assert all((row.position or 0.0) > light.accuracy for row in cheaper)


def test_a_step_repeated_100_times_leaves_no_trace(tmp_path: Path) -> None:
    """A cable whose motion is given goes back to the bits that it had."""
    with opened(small(tmp_path)) as system:
        model = system.models["cable"]
        names = [c.target.name for c in system.connections if c.target.model == "cable"]
        ends = []
        for count in (1, 100):
            partner = make_partner(model, names)
            partner.enter_initialisation(STOP, 1e-8)
            partner.exit_initialisation()
            motions = [through([(0.0, 0.0), (0.1, 0.3 + k)], 1) for k in range(len(names))]
            partner.step(0.0, 0.1, motions, is_final=True)
            state = partner.save()
            for again in range(count):
                partner.restore(state)
                partner.step(
                    0.1, 0.2, [through([(0.1, p(0.1)), (0.2, p(0.2) + again)], 1) for p in motions], is_final=False
                )
            partner.restore(state)
            partner.step(0.1, 0.2, motions, is_final=True)
            ends.append(partner.get())
            partner.forget(state)
            partner.close()
    assert ends[0] == ends[1]


def test_what_is_no_single_scene_says_why(tmp_path: Path) -> None:
    unequal = small(tmp_path)
    text = unequal.text.replace("m_x = 4000.0", "m_x = 3000.0")
    with opened(Coupling.from_text(text, name="unequal", folder=tmp_path)) as system:
        with pytest.raises(NotOneError, match="m_x = 3000 kg and m_y = 4000 kg differ"):
            whole_scene(system)
        truth = find_truth(system)
    assert not truth.is_whole and "differ, and a floater has one mass" in truth.words
    with opened(Coupling.from_text(text, name="unequal", folder=tmp_path)) as system:
        times = np.arange(5) * 0.6
    found = np.column_stack([truth.at(times)[name] for name in NAMES])
    right = mass_outside(Coupling.from_text(text, name="unequal", folder=tmp_path), times)
    assert np.abs(found - right).max() < 1e-5


@pytest.mark.slow
def test_files_and_names(light: CouplingReport, tmp_path: Path) -> None:
    paths = write_coupling_report(light, tmp_path)
    said = json.loads(paths[0].read_text(encoding="utf-8"))
    assert said["recommended"]["algorithm"] == "iterated" and said["reference"]["is_whole"]
    assert len(paths[1].read_text(encoding="utf-8").splitlines()) == len(light.rows) + 1 == len(said["rows"]) + 1
    page = paths[2].read_text(encoding="utf-8")
    assert page.count("<svg") == 2 and "none of those tried" not in page
    (tmp_path / "one.toml").write_text(light.coupling.text, encoding="utf-8")
    assert names_coupling("light-vessel") and names_coupling(str(tmp_path / "one.toml"))
    assert not names_coupling("towed-40") and not names_coupling(str(tmp_path / "none.toml"))


@pytest.mark.slow
def test_orders_are_drawn_as_they_are(light: CouplingReport, tmp_path: Path) -> None:
    """Every family that has a stable step, as steep beside the slope of 1 as its order; the same file every time."""
    path = write_orders([light], tmp_path)
    text = path.read_bytes()
    assert write_orders([light], tmp_path).read_bytes() == text
    slopes = dict(drawn_slopes(text, "o-small-"))
    unit = slopes.pop("o-small-slope-1")
    assert [slopes.pop(f"o-small-slope-{k}") / unit for k in (2, 3)] == pytest.approx([2.0, 3.0], rel=1e-4)
    orders = {f"o-small-{f.algorithm}-{f.extrapolation}": f.order for f in light.families if f.longest_stable}
    assert slopes.keys() == orders.keys() >= {"o-small-iterated-1", "o-small-iterated-2"}
    for name in ("o-small-iterated-1", "o-small-iterated-2"):
        assert slopes[name] / unit == pytest.approx(orders[name], rel=1e-3)


def test_the_picture_in_the_docs_is_that_of_their_table() -> None:
    """If not: `cablefmu report moored-vessel light-vessel`, and copy its picture and its orders."""
    docs = Path(__file__).parents[1] / "docs"
    slopes = dict(drawn_slopes((docs / "coupling-orders.svg").read_bytes(), "o-moored-vessel-"))
    unit = slopes["o-moored-vessel-slope-1"]
    rows = re.findall(
        r"^\| ([a-z-]+), (held|linear|quadratic) \|.* (\S+) \|$", (docs / "coupling.md").read_text("utf-8"), re.M
    )
    assert len(rows) == 9
    for algorithm, inputs, order in rows:
        name = f"o-moored-vessel-{algorithm}-{ORDER_NAMES.index(inputs)}"
        assert slopes[name] / unit == pytest.approx(float(order), abs=0.006)


def drawn_slopes(text: bytes, prefix: str) -> Iterator[tuple[str, float]]:
    """Of every line whose name begins so, down for across, fitted."""
    for group in ElementTree.fromstring(text).iter("{http://www.w3.org/2000/svg}g"):
        path = group.find("{http://www.w3.org/2000/svg}path")
        if group.get("id", "").startswith(prefix) and path is not None:
            points = re.findall(r"[ML] (\S+) (\S+)", path.attrib["d"])
            if len(points) > 1:
                across, down = np.array(points, dtype=float).T
                yield group.attrib["id"], float(np.polyfit(across, down, 1)[0])


@pytest.mark.parametrize(("accuracy", "limit"), [(0.0, 60.0), (float("nan"), 60.0), (1e-3, 0.0)])
def test_refused_numbers(accuracy: float, limit: float, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="a number above 0"):
        make_coupling_report(small(tmp_path), accuracy=accuracy, limit=limit)
