"""One instance by itself: both versions of FMI say the same, and refuse in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from cablefmu.coupling import couple
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.extrapolation import through
from cablefmu.coupling.partners import Partner, make_partner
from cablefmu.coupling.system import opened
from cablefmu.errors import FmuError, RunError
from tests.coupling.oscillators import oscillators

LINE = through([(0.0, 10.0), (0.1, 25.0)], 1)


@contextmanager
def cable(folder: Path, fmi: int, parameters: str = "y_m1 = 0.3") -> Iterator[Partner]:
    text = oscillators(folder, fmi=fmi).text.replace("y_m1 = 0.3", parameters)
    with opened(Coupling.from_text(text, name="x", folder=folder)) as system:
        partner = make_partner(system.models["a"], ["u_m1"])
        try:
            partner.enter_initialisation(2.0, 1e-10)
            partner.set([LINE(0.0)])
            partner.exit_initialisation()
            yield partner
        finally:
            partner.close()


def test_both_versions_follow_an_input_inside_a_step_alike(cables: Path) -> None:
    """Derivatives in FMI 2, intermediate updates in FMI 3; held inputs give another motion."""
    ends = []
    for fmi in (2, 3):
        with cable(cables, fmi) as partner:
            partner.step(0.0, 0.1, [LINE], is_final=True)
            ends.append(dict(zip(partner.outputs, partner.get(), strict=True)))
    with cable(cables, 2) as partner:
        partner.step(0.0, 0.1, [through([(0.0, 10.0)], 0)], is_final=True)
        held = dict(zip(partner.outputs, partner.get(), strict=True))
    assert ends[0]["y_m1"] == pytest.approx(ends[1]["y_m1"], abs=1e-10)
    assert abs(ends[0]["y_m1"] - held["y_m1"]) > 1e-3


@pytest.mark.parametrize("fmi", [2, 3])
def test_parameters_of_every_type_arrive(fmi: int, cables: Path) -> None:
    """The enumeration by its name: an explicit method counts no Jacobians, an implicit one does."""
    counts = []
    for solver in ("explicit", "implicit"):
        with cable(cables, fmi, f'y_m1 = 0.25, solver = "{solver}"') as partner:
            assert partner.get()[partner.outputs.index("y_m1")] == 0.25
            partner.step(0.0, 0.1, [LINE], is_final=True)
            counts.append(partner.get()[partner.outputs.index("solver.jacobians")])
    assert counts[0] == 0.0 < counts[1]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_state_can_be_gone_back_to_again_and_again(fmi: int, cables: Path) -> None:
    with cable(cables, fmi) as partner:
        state, ends = partner.save(), []
        for _ in range(3):
            partner.step(0.0, 0.1, [LINE], is_final=False)
            ends.append(partner.get())
            partner.restore(state)
        partner.forget(state)
    assert ends[0] == ends[1] == ends[2]


@pytest.mark.parametrize("fmi", [2, 3])
def test_what_is_no_number_and_what_the_fmu_refuses(fmi: int, cables: Path) -> None:
    with cable(cables, fmi) as partner:
        with pytest.raises(RunError, match=r"input a\.u_m1 = nan: a finite number is expected"):
            partner.set([math.nan])
        with pytest.raises(RunError, match=r"model a failed in its step from t = 7 s: .*communication point"):
            partner.step(7.0, 7.1, [LINE], is_final=True)


def test_parameters_that_the_fmu_refuses_are_told_in_its_words(cables: Path) -> None:
    """A rate beyond all sense is within the description's limits, but cannot be gone on from."""
    text = oscillators(cables).text.replace("y_m1 = 0.3", 'y_m1 = 0.3, "omega[1]" = 1e300')
    with pytest.raises(RunError, match=r"^model a failed in .+: .+") as raised:
        couple(Coupling.from_text(text, name="x", folder=cables))
    assert str(raised.value).count("model a") == 1


def test_an_fmu_without_a_library_for_this_machine(cables: Path) -> None:
    with opened(oscillators(cables)) as system:
        model = system.models["a"]
        for library in (model.folder / "binaries").rglob("*.so"):
            library.unlink()
        with pytest.raises(FmuError, match=r"model a: its FMU cannot be loaded: "):
            make_partner(model, ["u_m1"])
