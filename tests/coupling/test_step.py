"""Steps of a coupling against the exact motion of a linear system, and against themselves, repeated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cablefmu.coupling import couple
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.exchange import Exchange
from cablefmu.coupling.initialise import initialise
from cablefmu.coupling.partners import Partner, make_partner
from cablefmu.coupling.step import Ended, make_stepper
from cablefmu.coupling.system import System, opened
from cablefmu.errors import RunError
from tests.coupling.oscillators import error, oscillators
from tests.coupling.ships import small
from tests.coupling.vessels import exact_vessel, vessel

ALGORITHMS = ("jacobi", "gauss-seidel", "iterated")
TIGHT = "iteration = { tolerance = 1e-10 }"
STEPS = (0.01, 0.005)

NEAR = 0.25
"""Of observed orders to the limit, with some 100 and 200 steps in the fastest period (0.9 s)."""


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("extrapolation", [0, 1, 2])
def test_error_is_of_the_order_of_the_inputs_plus_one(
    fmi: int, algorithm: str, extrapolation: int, cables: Path
) -> None:
    """A polynomial of order p through samples h apart is wrong by h^(p+1), and so is the motion."""
    errors = [
        error(
            couple(oscillators(cables, step=h, algorithm=algorithm, extrapolation=extrapolation, fmi=fmi, more=TIGHT))
        )
        for h in STEPS
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(extrapolation + 1, abs=NEAR)


def test_first_steps_are_iterated_and_no_others(cables: Path) -> None:
    """Two of 20 with quadratic inputs; what stops them says that it need not be."""
    result = couple(oscillators(cables, step=0.1, extrapolation=2))
    assert result.attrs["steps"] == 20
    first = couple(oscillators(cables, step=0.1, extrapolation=2, algorithm="iterated")).isel(time=slice(0, 3))
    assert result["a.y_m1"].values[:3].tolist() == first["a.y_m1"].values.tolist()
    assert couple(oscillators(cables, step=0.1)).attrs["evaluations"] == 20 < result.attrs["evaluations"] < 40
    with pytest.raises(RunError, match=r"from t = 0 s did not agree in 2 iterations: .*; extrapolation = 0 needs none"):
        couple(oscillators(cables, step=0.1, extrapolation=2, more="iteration = { most = 2 }"))


def test_what_knows_more_of_the_end_is_more_exact(cables: Path) -> None:
    """Gauss-Seidel interpolates half of what Jacobi extrapolates, the iterated step all of it."""
    jacobi, seidel, iterated = (
        error(couple(oscillators(cables, step=0.02, algorithm=algorithm, extrapolation=1))) for algorithm in ALGORITHMS
    )
    assert iterated < 0.3 * seidel < 0.3 * 0.5 * jacobi


class Bench:
    """A coupling between its start and its first step."""

    def __init__(self, system: System) -> None:
        self.exchange = Exchange(system.connections, system.models, system.settings.extrapolation)
        self.partners: dict[str, Partner] = {
            name: make_partner(model, self.exchange.inputs(name)) for name, model in system.models.items()
        }
        self.exchange.accept(0.0, initialise(system, self.partners, self.exchange))
        self.step = make_stepper(system, self.partners, self.exchange, may_repeat=True)

    def repeated(self, start: float, end: float, times: int) -> Ended:
        """The same step, taken back and taken again."""
        states = {name: partner.save() for name, partner in self.partners.items()}
        for _ in range(times - 1):
            self.step(start, end)
            for name, partner in self.partners.items():
                partner.restore(states[name])
        for name, partner in self.partners.items():
            partner.forget(states[name])
        return self.step(start, end)

    def close(self) -> None:
        for partner in self.partners.values():
            partner.close()


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_step_repeated_100_times_leaves_no_trace(fmi: int, algorithm: str, cables: Path) -> None:
    once, often = once_and_100_times(oscillators(cables, algorithm=algorithm, extrapolation=2, fmi=fmi))
    assert once == often


@pytest.mark.parametrize("fmi", [2, 3])
def test_neither_does_an_iterated_step_of_a_vessel_and_its_cable(fmi: int, tmp_path: Path) -> None:
    """Through the motion port: the vessel's place, velocity and acceleration one way, the cable's force the other."""
    text = small(tmp_path).text
    for old, new in (
        ('"gauss-seidel"', '"iterated"'),
        ("extrapolation = 1", "extrapolation = 2"),
        ('"ship.toml"', f'"ship.toml"\nfmi = {fmi}'),
    ):
        assert old in text
        text = text.replace(old, new)
    once, often = once_and_100_times(Coupling.from_text(text, name="small", folder=tmp_path))
    assert all(ended.evaluations > 1 for ended in once)
    assert once == often


def once_and_100_times(coupling: Coupling) -> list[list[Ended]]:
    """Five steps of 20 ms, of which the third is taken once or 100 times: every output of both, in all its bits."""
    ends: list[list[Ended]] = []
    with opened(coupling) as system:
        for times in (1, 100):
            bench, steps = Bench(system), []
            for k in range(5):
                steps.append(bench.repeated(0.02 * k, 0.02 * (k + 1), times if k == 2 else 1))
                bench.exchange.accept(0.02 * (k + 1), steps[-1].outputs)
            ends.append(steps)
            bench.close()
    assert len(ends[0][-1].outputs) > 20
    return ends


# --- a vessel lighter than what hangs on it ---


@pytest.mark.parametrize("ratio", [0.5, 5.0, 50.0])
def test_iterated_step_bears_a_vessel_lighter_than_its_load(ratio: float, slave: Callable[[str], Path]) -> None:
    """The force on the vessel depends at once on its acceleration: load over vessel is the gain of the loop."""
    result = couple(vessel(slave, ratio=ratio, algorithm="iterated", extrapolation=1, step=0.02, more=TIGHT))
    assert np.abs(result["vessel.x"].values - exact_vessel(result["time"].values, ratio)).max() < 2e-3
    assert (
        result.attrs["evaluations"] / result.attrs["steps"] <= 4
    )  # one value to guess in a linear problem: 3, rounding 4


def test_error_of_the_light_vessel_is_of_second_order(slave: Callable[[str], Path]) -> None:
    errors = []
    for step in (0.04, 0.02):
        result = couple(vessel(slave, ratio=5.0, algorithm="iterated", extrapolation=1, step=step))
        errors.append(np.abs(result["vessel.x"].values - exact_vessel(result["time"].values, 5.0)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=NEAR)


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize(("ratio", "holds"), [(0.2, True), (5.0, False)])
def test_explicit_coupling_fails_where_the_load_is_heavier(
    algorithm: str, ratio: float, holds: bool, slave: Callable[[str], Path]
) -> None:
    """What the iterated step is there for: the same coupling, its loop declared to be late by a step."""
    coupling = vessel(slave, ratio=ratio, algorithm=algorithm, extrapolation=0, step=0.02, delayed=True)
    try:
        largest = float(np.abs(couple(coupling)["vessel.x"].values).max())
    except RunError:
        largest = np.inf
    assert (largest < 2.0) == holds


def test_plain_repetition_fails_where_the_load_is_heavier_and_names_the_connection(
    slave: Callable[[str], Path],
) -> None:
    coupling = vessel(
        slave, ratio=5.0, algorithm="iterated", extrapolation=0, step=0.02, more='iteration = { acceleration = "none" }'
    )
    with pytest.raises(
        RunError, match=r"no initial values that agree were found: load\.F -> vessel\.F still changes by"
    ):
        couple(coupling)


# --- models that fail ---

_QUITTER = """
[coupling]
stop_time = 1
step = 0.1
[[model]]
name = "line"
fmu = "{path}"
parameters = {{ {parameters} }}
[[model]]
name = "wave"
partner = "wave_force"
[[connection]]
from = "wave.force"
to = "line.u"
"""


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (
            "fails_at = 0.55",
            r"model line failed in its step from t = 0\.5 s: .*the line has parted.*wave\.force -> line\.u = ",
        ),
        ("nan_at = 0.55", r"output line\.y = nan: a finite number is expected"),
    ],
)
def test_a_model_that_fails_ends_the_run_with_its_connections_and_what_there_was(
    parameters: str, message: str, slave: Callable[[str], Path]
) -> None:
    text = _QUITTER.format(path=slave("quitter"), parameters=parameters)
    with pytest.raises(RunError, match=message) as raised:
        couple(Coupling.from_text(text, name="quitter"))
    assert raised.value.time == 0.5
    assert raised.value.partial["time"].values.tolist() == pytest.approx([0.1 * k for k in range(6)])  # type: ignore[attr-defined]
