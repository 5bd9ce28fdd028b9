"""Whatever is wrong with a scene is said in a sentence that names file, key, value and what is allowed."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from cablefmu.errors import SceneError
from cablefmu.scene import Scene, load_scene

GOOD = """\
format = 1
description = "Three links between a floater and an anchor"

[cable]
links = 3
length = "30 m"
diameter = "20 mm"
density = 7850
young_modulus = "80 GPa"
joint_damping = 2.8

[water]
Cd = 1.0

[top]
kind = "floater"
mass = 600
stiffness = 1200
damping = 237.6

[terminal]
kind = "anchor-spring"
mass = 60
density = 7850
stiffness_horizontal = 1.2e5
damping_horizontal = 7920
stiffness_vertical = 1.2e5
damping_vertical = 7920
position = [15, 20]

[shape]
kind = "catenary"

[inputs]
u_m1 = { signal = "sine", amplitude = 100, period = 4 }

[run]
stop_time = 10
"""

CSV = {
    "waves.csv": b"0,1\n1,2\n",
    "back.csv": b"0,1\n0,2\n",
    "one.csv": b"0,1\n",
    "words.csv": b"t,F\n0,nan\n",
    "bytes.csv": b"\xff",
}


def load(text: str) -> Scene:
    return Scene.from_text(text, name="x", files=CSV, source="scenes/x.toml")


def test_the_scene_to_spoil_is_good() -> None:
    assert load(GOOD).cable.n == 3


SPRINGS = GOOD.partition("[terminal]\n")[2].partition("position")[0]
SINE = '{ signal = "sine", amplitude = 100, period = 4 }'

BAD: list[tuple[str, str, tuple[str, ...]]] = [
    # Wrong dimension or unit
    ('"30 m"', '"5 kg"', ('cable.length = "5 kg": a length [m] is expected, for example 240 or "240 m"',)),
    ('"30 m"', '"30"', ('cable.length = "30": the unit is missing',)),
    ('"80 GPa"', '"80 GPascals"', ("cable.young_modulus", "a modulus of elasticity [Pa]")),
    ("[15, 20]", '["15 m", "20 s"]', ('terminal.position, entry 2 = "20 s": a coordinate [m]',)),
    ("stop_time = 10", 'stop_time = "10 m"', ('run.stop_time = "10 m": a time [s]',)),
    # Unknown names
    (
        "diameter =",
        "diametre =",
        ("cable.diametre", 'the nearest is "diameter"', "cable.diameter: this key is missing"),
    ),
    (
        "[top]",
        "[topp]",
        ('topp: unknown key; the nearest is "top"', "top: this key is missing; a table [top]"),
    ),
    (
        "Cd = 1.0",
        "cd = 1.0",
        ('water.cd = 1.0: unknown key; the nearest is "Cd"', "exactly one of Cd, drag_per_link"),
    ),
    (
        "amplitude = 100",
        "amplitud = 100",
        ('inputs.u_m1.amplitud = 100: unknown key; the nearest is "amplitude"',),
    ),
    ("[run]", '[outputs]\ndrop = ["tension"]\n[run]', ('outputs.drop, entry 1 = "tension"', "tension_top")),
    (
        "[run]",
        '[run]\nsolver = "implict"',
        ('run.solver = "implict": the nearest is "implicit"', "automatic, explicit"),
    ),
    ("[run]", '[run]\ninitial = "rest"', ('run.initial = "rest": allowed: shape, equilibrium',)),
    (
        "[run]",
        '[outputs]\ndrop = ["statics.residual"]\n[run]',
        ("outputs.drop", 'statics.residual exists only in scenes with [run] initial = "equilibrium"'),
    ),
    # Wrong type
    ("[run]", "[outputs]\nsolver = 0\n[run]", ("outputs.solver = 0: true or false is expected",)),
    ("[run]", "[run]\nsolver = 2", ("run.solver = 2: allowed: automatic, explicit, implicit",)),
    ("mass = 600", "mass = true", ("top.mass = true: a mass [kg] is expected",)),
    ("links = 3", "links = 3.0", ("cable.links = 3.0: a whole number of links from 1 to 10000",)),
    ("[water]", "[[water]]", ('water = [{"Cd": 1.0}]: a table is expected',)),
    ('"Three links between a floater and an anchor"', "3", ("description = 3: a text of one line",)),
    ("[15, 20]", "[15]", ("terminal.position = [15]: a list with 2 entries",)),
    # Outside physical limits
    ("mass = 60\n", "mass = -60\n", ("terminal.mass = -60: a mass must be greater than 0",)),
    ("links = 3", "links = 0", ("cable.links = 0: a whole number of links from 1 to 10000",)),
    ("links = 3", "links = 10001", ("cable.links = 10001", "from 1 to 10000")),
    ("stiffness = 1200", "stiffness = -1", ("top.stiffness = -1: a stiffness must be 0 or greater",)),
    ("[run]", "[run]\ntolerance = 2", ("run.tolerance = 2", "from 1e-13 to 0.1")),
    # No number at all
    (
        "joint_damping = 2.8",
        "joint_damping = nan",
        ("cable.joint_damping = NaN: this is not a finite number",),
    ),
    ('"30 m"', "inf", ("cable.length = Infinity: this is not a finite number",)),
    ('"30 m"', "1" + "0" * 400, ("cable.length = Infinity: this is not a finite number",)),
    ("amplitude = 100", 'amplitude = "-inf N"', ('inputs.u_m1.amplitude = "-inf N": a force [N]',)),
    # Lists
    (
        "density = 7850\ny",
        "density = [7850, 7850]\ny",
        ("cable.density", "one entry per link, 3 in all; this one has 2"),
    ),
    (
        'length = "30 m"',
        "link_length = [10, 0, 20]",
        ("cable.link_length, entry 2 = 0: a length must be greater",),
    ),
    (
        '"catenary"',
        '"angles"\nangles = [0, 0]',
        ("shape.angles = [0, 0]: a list needs one entry per link, 3 in all",),
    ),
    (SINE, '{ signal = "steps", times = [0, 1], values = [5] }', ("inputs.u_m1: 2 times and 1 values",)),
    (SINE, '{ signal = "steps", times = [1, 1], values = [5, 6] }', ("inputs.u_m1: times must rise",)),
    # Contradictory or missing keys
    (
        'length = "30 m"',
        "length = 30\nlink_length = 10",
        ("cable: length and link_length contradict each other",),
    ),
    ("density = 7850\nstiff", "stiff", ("terminal: density or volume is missing: in water",)),
    ("[water]\nCd = 1.0", "", ("terminal.density = 7850: only for scenes with [water]",)),
    (
        "period = 4",
        "period = 4, frequency = 0.25",
        ("inputs.u_m1: frequency and period contradict each other",),
    ),
    ("damping = 237.6", "", ("top.damping: this key is missing; a damping [N s/m] is expected",)),
    # Kinds
    (
        '"anchor-spring"',
        '"anchor"',
        ('terminal.kind = "anchor": the nearest is "anchor-mass"', "anchor-spring, floater, pin"),
    ),
    (
        'kind = "catenary"',
        "",
        ("shape.kind: this key is missing; allowed: straight, angles, hanging, catenary",),
    ),
    ('kind = "floater"', 'kind = "boat"', ('top.kind = "boat": allowed: floater, motion',)),
    ('signal = "sine"', 'signal = "cosine"', ('inputs.u_m1.signal = "cosine": the nearest is "sine"',)),
    (
        "u_m1 = {",
        "F_cx = {",
        ("inputs.F_cx", 'a scene with top "floater" and terminal "anchor-spring" has the inputs u_m1'),
    ),
    # (an integer that Python itself refuses to print)
    ('signal = "sine"', "signal = 0x" + "f" * 6000, ("inputs.u_m1.signal = Infinity",)),
    (SPRINGS, 'kind = "pin"\nmass = 60\n', ("terminal.mass = 60: unknown key; allowed: kind, position",)),
    (SPRINGS, 'kind = "pin"\nstiffness_vertical = 1e9\n', ("terminal.stiffness_vertical", "allowed: kind, position")),
    # Geometry that cannot be
    (
        SPRINGS + 'position = [15, 20]\n\n[shape]\nkind = "catenary"',
        'kind = "pin"\nposition = [15, 20]\n[shape]\nkind = "hanging"',
        ("terminal.position = [15.0, 20.0]: the start shape ends at (0, 30) m, not at the pin", '"catenary"'),
    ),
    ("[15, 20]", "[15, 30]", ("terminal.position = [15.0, 30.0]: the ports are 33.541 m apart", "30 m long")),
    ("[15, 20]", "[0, 0]", ("terminal.position", "too close together")),
    ("density = 7850\ny", "density = 1000\ny", ("terminal.position", "a cable without weight")),
    (
        '"catenary"',
        '"straight"\nangle = 45',
        ("shape.angle = 45: an angle must be from -6.28319 to", '"45 deg"'),
    ),
    # Files that a scene names
    (SINE, '{ signal = "csv", file = "no.csv" }', ("inputs.u_m1: no.csv: there is no such file",)),
    (SINE, '{ signal = "csv", file = "back.csv" }', ("back.csv: row 2: time 0 s does not come after 0 s",)),
    (
        SINE,
        '{ signal = "csv", file = "words.csv" }',
        ("words.csv: row 2, column 2: a finite number is expected",),
    ),
    (
        SINE,
        '{ signal = "csv", file = "bytes.csv" }',
        ("bytes.csv: this is not a comma-separated text in UTF-8",),
    ),
    (SINE, '{ signal = "csv", file = "../waves.csv" }', ("inputs.u_m1.file", "in the folder of the scene")),
    # The file as a whole
    ("links = 3", "links = ", ("this is not valid TOML: Invalid value (at line 5",)),
    ("links = 3", "links = 3\nlinks = 3", ("this is not valid TOML", "line 6")),
    ("format = 1", "format = 2", ("format = 2: this version reads scenes with format = 1",)),
    ("format = 1", "", ("format: this key is missing; allowed: 1",)),
    ("format = 1", "format = true", ("format = true: this version reads",)),
]


@pytest.mark.parametrize(("good", "bad", "says"), BAD)
def test_a_mistake_is_named(good: str, bad: str, says: tuple[str, ...]) -> None:
    assert GOOD.count(good) == 1, "the change must hit one place"
    with pytest.raises(SceneError) as refused:
        load(GOOD.replace(good, bad))
    message = str(refused.value)
    assert all(line.startswith("scenes/x.toml: ") for line in message.splitlines())
    for part in says:
        assert part in message


SURGES = GOOD.replace("damping = 237.6", "damping = 237.6\nstiffness_horizontal = 300\ndamping_horizontal = 20")
MOVED = GOOD.replace(GOOD.partition("[top]\n")[2].partition("[terminal]")[0], 'kind = "motion"\n\n').replace(
    "u_m1", "y_1"
)
MOVED_BELOW = MOVED.replace(SPRINGS, 'kind = "motion"\n')
BAD_ENDS = [
    (
        SURGES,
        "damping_horizontal = 20",
        "",
        "top: a floater that surges needs stiffness_horizontal and damping_horizontal",
    ),
    (SURGES, "stiffness_horizontal = 300", "", "top: a floater that surges needs stiffness_horizontal and damping_"),
    (
        SURGES,
        "stiffness_horizontal = 300",
        "stiffness_horizontal = -3",
        "top.stiffness_horizontal = -3: a stiffness must",
    ),
    (GOOD, "damping = 237.6", "damping = 237.6\nstatic_pull = 5", "top: static_pull is only for a floater that surges"),
    (GOOD, "u_m1 =", "u_m1x =", 'top "floater" and terminal "anchor-spring" has the inputs u_m1'),
    (GOOD, "u_m1 =", "x_1 =", 'top "floater" and terminal "anchor-spring" has the inputs u_m1'),
    (SURGES, "u_m1 =", "u_m2 =", 'top "floater" and terminal "anchor-spring" has the inputs u_m1, u_m1x'),
    (
        MOVED,
        "y_1 =",
        "u_m1 =",
        'inputs.u_m1: a scene with top "motion" and terminal "anchor-spring" has the inputs x_1, y_1',
    ),
    (
        MOVED,
        "y_1 =",
        "y_2 =",
        'inputs.y_2: a scene with top "motion" and terminal "anchor-spring" has the inputs x_1, y_1',
    ),
    (MOVED_BELOW, "y_1 =", "F_cx =", 'and terminal "motion" has the inputs x_1, y_1, x_2, y_2'),
    (MOVED, "y_1 =", "vy_1 =", "inputs.vy_1"),
    (MOVED, 'kind = "motion"', 'kind = "motion"\nmass = 5', "top.mass = 5: unknown key; allowed: kind, acceleration"),
    (MOVED_BELOW, "position = [15, 20]", "", "terminal.position: this key is missing"),
    (
        MOVED_BELOW,
        "position = [15, 20]",
        "position = [15, 20]\nmass = 1",
        "terminal.mass = 1: unknown key; allowed: kind, pos",
    ),
    (MOVED_BELOW, '"catenary"', '"hanging"', "the start shape ends at (0, 30) m, not at the vessel"),
    (MOVED_BELOW, "[15, 20]", "[15, 30]", "terminal.position = [15.0, 30.0]: the ports are 33.541 m apart"),
    (MOVED, "amplitude = 100", 'amplitude = "100 N"', 'inputs.y_1.amplitude = "100 N": a coordinate [m]'),
    (MOVED, SINE, '"5 s"', 'inputs.y_1 = "5 s": a coordinate [m] is expected, for example 0.5 or "0.5 m", or a table'),
    (MOVED, SINE, '{ signal = "steps", times = [0], values = [5] }', 'inputs.y_1.signal = "steps": allowed: sine, csv'),
    (MOVED, "period = 4", "period = 4, start = 2", "inputs.y_1.start = 2: unknown key"),
    (
        MOVED,
        SINE,
        '{ signal = "csv", file = "one.csv" }',
        "inputs.y_1: one.csv: a motion needs two lines with numbers or more",
    ),
    (
        MOVED,
        SINE,
        '{ signal = "csv", file = "back.csv" }',
        "inputs.y_1: back.csv: row 2: time 0 s does not come after 0 s",
    ),
]


@pytest.mark.parametrize(("scene", "good", "bad", "says"), BAD_ENDS)
def test_a_mistake_in_what_the_other_ends_have_is_named(scene: str, good: str, bad: str, says: str) -> None:
    load(scene)
    assert scene.count(good) == 1, "the change must hit one place"
    with pytest.raises(SceneError) as refused:
        load(scene.replace(good, bad))
    message = str(refused.value)
    assert all(line.startswith("scenes/x.toml: ") for line in message.splitlines())
    assert says in message


def test_all_mistakes_come_at_once() -> None:
    text = GOOD.replace('"30 m"', '"5 kg"').replace("mass = 600", "mass = -1").replace("Cd = 1.0", "Cd = true")
    text = text.replace("amplitude = 100", "amplitude = nan").replace("density = 7850\ny", "density = [1, 2]\ny")
    with pytest.raises(SceneError) as refused:
        load(text + "stopp = 3\n")
    keys = [line.split(": ")[1].split(" = ")[0] for line in str(refused.value).splitlines()]
    assert keys == [
        "cable.length",
        "cable.density",
        "water.Cd",
        "top.mass",
        "inputs.u_m1.amplitude",
        "run.stopp",
    ]


def test_a_flood_of_mistakes_is_cut_short() -> None:
    names = "\n".join(f"k{i} = 1" for i in range(500))
    with pytest.raises(SceneError, match=r"and \d+ more mistakes$") as refused:
        load(names + "\n" + GOOD)
    assert len(str(refused.value).splitlines()) == 51


@pytest.mark.parametrize("name", ["Mühle", "a b", "", "a.b", "../x"])
def test_names_of_scenes_are_plain(name: str) -> None:
    with pytest.raises(SceneError, match="letters a to z, digits, - and _ are allowed"):
        Scene.from_text(GOOD, name=name)


def test_files_that_cannot_be_scenes(tmp_path: Path) -> None:
    not_text = tmp_path / "bytes.toml"
    not_text.write_bytes(b"format = 1 # \xff")
    for path, says in (
        (not_text, "bytes.toml: a text in UTF-8 is expected; byte 13"),
        (tmp_path / "missing.toml", "missing.toml: there is no such file"),
        (tmp_path, "there is no such file"),
        ("a\0b.toml", "there is no such file"),
    ):
        with pytest.raises(SceneError, match=says):
            load_scene(path)


def test_an_unknown_scene_is_answered_with_the_nearest() -> None:
    with pytest.raises(SceneError, match='no scene "free-12-watr" ships; the nearest is "free-12-water"'):
        load_scene("free-12-watr")


@pytest.mark.parametrize("seed", range(300))
def test_garbage_is_refused_or_read_but_never_breaks(seed: int) -> None:
    """Cut, double, swap and scribble over a good scene: what comes out is a scene or a `SceneError`."""
    dice = random.Random(seed)
    lines = GOOD.splitlines()
    scribbles = [
        "[[1]]",
        "{}",
        "[]",
        '""',
        "1979-05-27",
        "0xff",
        "-1",
        "nan",
        '"\\u0000"',
        "[" * 2000,
        "{ kind = [1] }",
    ]
    for _ in range(dice.randint(1, 6)):
        k, j = dice.randrange(len(lines)), dice.randrange(len(lines))
        match dice.randrange(5):
            case 0:
                del lines[k]
            case 1:
                lines[k], lines[j] = lines[j], lines[k]
            case 2:
                lines.insert(k, lines[j])
            case 3:
                lines[k] = lines[k].partition("=")[0] + "= " + dice.choice(scribbles)
            case _:
                lines[k] = "".join(chr(dice.randint(1, 300)) if dice.random() < 0.1 else c for c in lines[k])
        if len(lines) < 2:
            break
    try:
        scene = load("\n".join(lines))
    except SceneError as error:
        message = str(error)
    else:
        message = f"scenes/x.toml: {scene.cable.n} links"
    assert message.startswith("scenes/x.toml: ")
