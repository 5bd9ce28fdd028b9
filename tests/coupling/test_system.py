"""What is checked against the FMUs before a run: names, causality, units, sources, loops, what models can do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from cablefmu.coupling.connections import Connection, Variable
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.system import opened
from cablefmu.errors import CouplingError
from tests.coupling.oscillators import oscillators
from tests.coupling.vessels import vessel


def refusal(coupling: Coupling) -> list[str]:
    with pytest.raises(CouplingError) as raised, opened(coupling):
        pass
    return str(raised.value).splitlines()


def changed(cables: Path, *changes: tuple[str, str]) -> Coupling:
    text = oscillators(cables).text
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return Coupling.from_text(text, name="two", folder=cables)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'from = "a.y_m1"',
            'from = "a.y_m2"',
            'connection 1.from = "a.y_m2": model a has no variable y_m2; the nearest is "y_m1"',
        ),
        (
            'from = "a.y_m1"',
            'from = "c.y_m1"',
            'connection 1.from = "c.y_m1": there is no model c; allowed: a, b, spring',
        ),
        ('from = "a.y_m1"', 'from = "a.u_m1"', "an output is expected; u_m1 is of causality input"),
        ('to = "a.u_m1"', 'to = "a.y_m1"', "an input is expected; y_m1 is of causality output"),
        ('from = "a.y_m1"', 'from = "a.solver"', "an output is expected; solver is of causality parameter"),
        (
            'from = "a.y_m1"',
            'from = "a.v_m1"',
            "connection 1, a.v_m1 -> spring.y_a: m/s and m are no units of the same quantity",
        ),
        (
            'to = "b.u_m1"',
            'to = "a.u_m1"',
            "connection 6, spring.F_a -> a.u_m1: a.u_m1 has a source already, spring.F_a -> a.u_m1",
        ),
        (
            "stiffness = 250",
            "stifness = 250",
            'parameters.stifness = 250: there is no such parameter or start value; the nearest is "stiffness"',
        ),
        ("stiffness = 250", "stiffness = true", "model 3.parameters.stiffness = true: a number is expected"),
        (
            "y_m1 = 0.3",
            'solver = "quick"',
            'parameters.solver = "quick": one of automatic, explicit, implicit is expected',
        ),
        (
            "y_m1 = 0.3 }",
            "y_m1 = 0.3 }\ninputs = { F_cx = 1, u_m1 = 2 }",
            "input a.u_m1: has a source, spring.F_a -> a.u_m1, and a constant value",
        ),
        ("y_m1 = 0.3 }", "y_m1 = 0.3 }\ninputs = { q = 2 }", "model 1.inputs.q = 2.0: there is no such real input; "),
        ('partner = "spring"', 'partner = "sprig"', 'no partner "sprig" ships; the nearest is "spring"'),
        ('fmu = "a-2.fmu"', 'fmu = "c.fmu"', "c.fmu: there is no such file"),
        ('fmu = "a-2.fmu"', 'fmu = "a-2.fmu"\nfmi = 3', "fmi is for scenes, whose FMUs are built; leave it out"),
        ('fmu = "a-2.fmu"', 'scene = "free-12-watr"', 'no scene "free-12-watr" ships'),
        ('fmu = "a-2.fmu"', 'vessel = { kind = "bdy" }', 'a.vessel.kind = "bdy"'),
        ('flow = "a.v_m1"', 'flow = "b.y_m1"', "power 1: b.y_m1 times spring.F_a is m times N, which is no power"),
        (
            'effort = "spring.F_a"',
            'effort = "spring.F_b"',
            "power 1: one connection from a.v_m1 to model spring and one from spring.F_b to a",
        ),
    ],
)
def test_what_does_not_fit_the_fmus_is_told_with_the_connection(old: str, new: str, said: str, cables: Path) -> None:
    lines = refusal(changed(cables, (old, new)))
    assert len(lines) == 1, lines
    assert lines[0].startswith("two.toml: ") and said in lines[0]


@pytest.mark.parametrize(("value", "said"), [("-1", "at least 0 [kg] is expected"), ("nan", "a finite number [kg] is")])
def test_values_beyond_the_descriptions_limits(value: str, said: str, cables: Path) -> None:
    (line,) = refusal(changed(cables, ("y_m1 = 0.3", f"M_1 = {value}")))
    assert "model 1.parameters.M_1" in line and said in line


def test_an_input_without_a_source_is_a_mistake(cables: Path) -> None:
    source, lone = refusal(changed(cables, ('to = "spring.v_b"', 'to = "spring.v_a"')))
    assert source.endswith("spring.v_a: spring.v_a has a source already, a.v_m1 -> spring.v_a; one is allowed")
    assert (
        lone == "two.toml: input spring.v_b: has no source; a connection to it or inputs.v_b of its model is expected"
    )


def test_all_are_told_at_once(cables: Path) -> None:
    changes = (('from = "a.y_m1"', 'from = "a.v_m1"'), ("stiffness = 250", "stifness = 250"), ('"a.u_m1"', '"a.u_m3"'))
    assert len(refusal(changed(cables, *changes))) == 3


def test_a_broken_fmu(cables: Path, tmp_path: Path) -> None:
    (tmp_path / "x.fmu").write_bytes(b"PK")
    (line,) = refusal(changed(cables, ('"a-2.fmu"', f'"{tmp_path}/x.fmu"')))
    assert "x.fmu: is not an FMU that can be read" in line


def test_units_of_other_size_need_a_gain(cables: Path, slave: Callable[[str], Path]) -> None:
    """The wave's force in N, and an input that is said to be in kN."""
    text = (
        f'[coupling]\nstop_time = 1\nstep = 0.1\n[[model]]\nname = "k"\nfmu = "{slave("kilo")}"\n'
        '[[model]]\nname = "wave"\npartner = "wave_force"\n[[connection]]\nfrom = "wave.force"\nto = "k.u"\n'
    )
    (line,) = refusal(Coupling.from_text(text, name="x"))
    assert line == "x.toml: connection 1, wave.force -> k.u: N is not kN; gain = 0.001 is expected"
    with opened(Coupling.from_text(text + "gain = 0.001\n", name="x")) as system:
        assert system.connections == [Connection(Variable("wave", "force"), Variable("k", "u"), 0.001)]


def test_ports_connect_what_has_the_same_name(cables: Path) -> None:
    """A vessel that is a body, at the end of a cable: its force is the cable's load's motion's other side."""
    text = """
[coupling]
stop_time = 1
step = 0.1
[[model]]
name = "a"
fmu = "a-2.fmu"
[[model]]
name = "b"
fmu = "b-2.fmu"
[[connection]]
ports = ["a.floater_1", "b.load"]
"""
    (line,) = refusal(Coupling.from_text(text, name="x", folder=cables))
    assert "connection 1.ports" in line and "no output of one has an input of the same name in the other" in line
    (line,) = refusal(Coupling.from_text(text.replace("b.load", "b.lod"), name="x", folder=cables))
    assert line.endswith(
        'ports = "b.lod": model b has no terminal lod; the nearest is "load"; allowed: floater_1, load'
    )


def test_ports_of_two_vessels_and_a_load(slave: Callable[[str], Path]) -> None:
    """Motion goes one way and force the other, as the names say."""
    text = vessel(slave, ratio=1.0, algorithm="iterated", extrapolation=0, step=0.1).text
    text = text[: text.index("[[connection]]")] + '[[connection]]\nports = ["load", "vessel"]\n'
    with opened(Coupling.from_text(text, name="x")) as system:
        assert {str(connection) for connection in system.connections} == {
            "vessel.x -> load.x", "vessel.v -> load.v", "vessel.a -> load.a", "load.F -> vessel.F",
        }  # fmt: skip


# --- loops, and what models can do ---


def test_an_algebraic_loop_needs_iteration_or_a_declared_delay(slave: Callable[[str], Path]) -> None:
    (line,) = refusal(vessel(slave, ratio=0.1, algorithm="jacobi", extrapolation=0, step=0.1))
    assert line.startswith('vessel.toml: coupling.algorithm = "jacobi": algebraic loop: ')
    assert "vessel.a -> load.a" in line and "load.F -> vessel.F" in line
    assert line.endswith("; iterated is expected, or delayed = true in one of them")
    with opened(vessel(slave, ratio=0.1, algorithm="jacobi", extrapolation=0, step=0.1, delayed=True)) as system:
        assert len(system.loops) == 1


def test_outputs_that_depend_on_states_alone_make_no_loop(cables: Path) -> None:
    """As the cables' descriptions say; the spring answers at once."""
    with opened(oscillators(cables)) as system:
        assert system.loops == []
        assert system.models["spring"].feedthrough("F_a") == ["y_a", "v_a", "y_b", "v_b"]
        assert system.models["a"].feedthrough("y_m1") == []
        assert system.models["a"].feedthrough("tension_top") == ["u_m1", "F_cx", "F_cy"]


def test_what_a_description_leaves_open_can_be_declared(slave: Callable[[str], Path]) -> None:
    text = vessel(slave, ratio=0.1, algorithm="jacobi", extrapolation=0, step=0.1).text
    declared = text.replace('name = "load"\n', 'name = "load"\nfeedthrough = false\n')
    with opened(Coupling.from_text(declared, name="x")) as system:
        assert system.loops == []


_WAVE = """
[[model]]
name = "quitter"
fmu = "{path}"
[[connection]]
from = "spring.F_b"
to = "quitter.u"
"""


def test_models_that_cannot_do_what_is_asked_are_named(cables: Path, slave: Callable[[str], Path]) -> None:
    text = oscillators(cables, algorithm="iterated").text + _WAVE.format(path=slave("stiff"))
    (line,) = refusal(Coupling.from_text(text, name="two", folder=cables))
    assert "model quitter cannot be rolled back (canGetAndSetFMUstate); jacobi or gauss-seidel is expected" in line
    text = text.replace('"iterated"', '"jacobi"').replace("step = 0.02", "step = 0.03")
    (line,) = refusal(Coupling.from_text(text, name="two", folder=cables))
    assert "model quitter takes steps of one length alone; a multiple of the step is expected" in line


def test_first_steps_that_cannot_be_iterated_are_said(cables: Path, slave: Callable[[str], Path]) -> None:
    coupling = oscillators(cables, extrapolation=2)
    with opened(coupling) as system:
        assert system.starts_iterated and not any("first steps" in note for note in system.notes)
    text = coupling.text + _WAVE.format(path=slave("stiff"))
    with opened(Coupling.from_text(text, name="two", folder=cables)) as system:
        assert not system.starts_iterated
        assert "as these models cannot be rolled back: quitter" in system.notes[1]


def test_a_model_without_connected_inputs_need_not_be_rolled_back(cables: Path) -> None:
    wave = '[[model]]\nname = "wave"\npartner = "wave_force"\n[[connection]]\nfrom = "wave.force"\nto = "a.F_cy"\n'
    with opened(
        Coupling.from_text(oscillators(cables, algorithm="iterated").text + wave, name="x", folder=cables)
    ) as system:
        assert system.iterated == ["a", "b", "spring"] and not system.can_repeat


def test_an_input_that_follows_a_signal_in_its_scene_needs_a_source() -> None:
    text = '[coupling]\nstop_time = 1\nstep = 0.1\n[[model]]\nname = "a"\nscene = "heave-60-water"\n'
    (line,) = refusal(Coupling.from_text(text, name="x"))
    assert line.startswith(
        "x.toml: input a.u_m1: has no source (in the scene it varies over time, which a coupling does not feed)"
    )
    with opened(Coupling.from_text(text + "inputs = { u_m1 = 10 }\n", name="x")) as system:
        assert system.models["a"].constants["u_m1"] == 10.0


def test_what_is_held_is_said(cables: Path) -> None:
    with opened(oscillators(cables, extrapolation=1)) as system:
        assert [str(v) for v in system.holding] == ["spring.y_a", "spring.v_a", "spring.y_b", "spring.v_b"]
        assert system.notes[0].startswith("held inside a step at the value extrapolated to its end")
    with opened(oscillators(cables)) as system:
        assert system.notes == []
