"""Coupling files: what ships loads, and every mistake that shows without the FMUs is told at once, with its key."""

from __future__ import annotations

from pathlib import Path

import pytest

from cablefmu.coupling.description import Coupling, load_coupling, shipped_couplings
from cablefmu.errors import CouplingError

GOOD = """
[coupling]
stop_time = "2 s"
step = 0.1
[[model]]
name = "cable"
scene = "free-12-water"
[[model]]
name = "wave"
partner = "wave_force"
[[connection]]
from = "wave.force"
to = "cable.u_m1"
"""


def refusal(text: str) -> list[str]:
    with pytest.raises(CouplingError) as raised:
        Coupling.from_text(text, name="mine")
    return str(raised.value).splitlines()


@pytest.mark.parametrize("name", shipped_couplings())
def test_what_ships_loads_and_says_what_it_is(name: str) -> None:
    coupling = load_coupling(name)
    assert coupling.name == name and len(coupling.spec.coupling.description) > 20


def test_units_names_and_defaults() -> None:
    coupling = Coupling.from_text(GOOD, name="mine")
    settings = coupling.spec.coupling
    assert (coupling.name, settings.stop_time, settings.step, settings.algorithm) == ("mine", 2.0, 0.1, "jacobi")
    named = GOOD.replace("[coupling]", '[coupling]\nname = "tow"\n[coupling.iteration]\nmost = 7\n[coupling.x]', 1)
    assert refusal(named)[-1].startswith("mine.toml: coupling.x")  # tables of [coupling] are read as such
    assert Coupling.from_text(GOOD.replace("[coupling]", '[coupling]\nname = "tow"'), name="mine").name == "tow"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[coupling]", "[copling]", "coupling: this key is missing"),
        ('"2 s"', '"2 m"', 'coupling.stop_time = "2 m": a time [s] is expected, for example 31 or "31 s"'),
        ("step = 0.1", "step = 0", "coupling.step = 0: a time must be greater than 0"),
        ("step = 0.1", 'step = 0.1\nalgorithm = "jakobi"', 'algorithm = "jakobi": the nearest is "jacobi"; allowed: '),
        ("step = 0.1", "step = 0.1\nextrapolation = 3", "coupling.extrapolation = 3: 0, 1 or 2 is expected"),
        ("step = 0.1", "step = 0.1\niteration = { most = 0 }", "iteration.most = 0: a whole number from 1 to 1000"),
        ("step = 0.1", "step = 0.1\ntolerence = 1", 'coupling.tolerence = 1: unknown key; the nearest is "tolerance"'),
        (
            "step = 0.1",
            'step = 0.1\nadaptive = { tolerance = 1e-3, smallest = "2 s", largest = 1 }',
            "coupling.adaptive.smallest = 2.0: at most largest = 1 s is expected",
        ),
        ('name = "wave"', 'name = "cable"', 'model 2.name = "cable": another model has this name; once is allowed'),
        ('name = "wave"', 'name = "a.b"', 'model 2.name = "a.b": a name of letters, digits, - and _'),
        ('scene = "free-12-water"', "", "model 1: something is missing: exactly one of scene, fmu, partner, vessel"),
        ('scene = "', 'fmu = "x.fmu"\nscene = "', "model 1: scene and fmu contradict each other: exactly one of"),
        (
            'partner = "wave_force"',
            'partner = "wave_force"\nparameters = { a = [1] }',
            "model 2.parameters.a = [1]: a number, ",
        ),
        (
            'partner = "wave_force"',
            'partner = "wave_force"\ninputs = { a = "b" }',
            'model 2.inputs.a = "b": a number is',
        ),
        ('to = "cable.u_m1"', "", "connection 1: from and to are expected, or ports, for example"),
        ('"cable.u_m1"', '"cable"', 'connection 1.to = "cable": MODEL.INPUT is expected, for example "cable.vx_1"'),
        ('to = "cable.u_m1"', 'ports = ["wave"]', "connection 1"),
        ('to = "cable.u_m1"', 'to = "cable.u_m1"\ngain = nan', "connection 1.gain = NaN: this is not a finite number"),
        ("step = 0.1", "step = [", "this is not valid TOML"),
    ],
)
def test_every_mistake_is_told_with_file_key_and_what_is_allowed(old: str, new: str, said: str) -> None:
    assert old in GOOD
    lines = refusal(GOOD.replace(old, new))
    assert all(line.startswith("mine.toml: ") for line in lines)
    assert any(said.lower() in line.lower() for line in lines), lines


def test_all_mistakes_are_told_at_once() -> None:
    wrong = GOOD.replace('"2 s"', '"2 m"').replace("step = 0.1", "step = -1").replace('"cable.u_m1"', '"cable"')
    assert len(refusal(wrong)) == 3


def test_no_model_at_all() -> None:
    assert refusal("[coupling]\nstop_time = 1\nstep = 1") == [
        "mine.toml: model: at least one table [[model]] is expected"
    ]


def test_files_and_names_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(CouplingError, match=r'no coupling "wave-and-plat" ships; the nearest is "wave-and-plate"; '):
        load_coupling("wave-and-plat")
    with pytest.raises(CouplingError, match=r"x\.toml: there is no such file"):
        load_coupling(tmp_path / "x.toml")
    (tmp_path / "x.toml").write_bytes(b"\xff\xfe\xff")
    with pytest.raises(CouplingError, match=r"x\.toml: cannot be read"):
        load_coupling(tmp_path / "x.toml")
    (tmp_path / "tow.toml").write_text(GOOD)
    assert load_coupling(tmp_path / "tow.toml").folder == tmp_path
