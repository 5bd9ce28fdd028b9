"""documentation/index.html: what one FMU is, for whoever finds it without us.

One page, made of the scene and of the same variables as modelDescription.xml; it needs no network and no scripts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from html import escape
from importlib.resources import files

import numpy as np

from .. import __version__
from ..cable import Cable, Drag, Initial, Terminal, Top
from ..scene import Scene
from ..signals import Constant, Derivative, Sampled, Signal, Sine, Spline, Steps
from .equations import equations_of
from .listing import Row, number, rows_of
from .mathml import mathml
from .sketch import sketch
from .variables import COSIMULATION_ONLY, ENUMERATIONS, Kind, Variable

__all__ = ["DOCUMENTATION", "documentation"]

DOCUMENTATION = "documentation/index.html"
"""Its name in the archive, as FMI wants it."""


def documentation(scene: Scene, variables: Sequence[Variable], *, fmi: int, file: str, twin: str = "") -> bytes:
    """The page.

    Parameters
    ----------
    scene
        What the FMU is made of.
    variables
        Of the FMU; FMI 2 has no variable of time.
    fmi
        Version of FMI.
    file
        What the archive is called where a host reads it.
    twin
        What is to be said of an FMU that is computed otherwise: of Co-Simulation only, and without the kernel's solver.
    """
    if fmi == 2:
        variables = [variable for variable in variables if variable.kind is not Kind.TIME]
    sections: dict[str, Iterable[str]] = {
        "The scene": [f"<figure>{sketch(scene.cable)}{_caption(scene.cable)}</figure>", *_facts(scene)],
        "How to run it": _driving(scene, variables, file, "" if twin else _given(fmi)),
        "Variables": _variables(variables),
        "Equations": _equations(scene.cable, variables),
        "Solver": [f"<p>{escape(twin)}</p>"] if twin else _solver(scene),
        "Limits": _limits([*_model_limits(scene.cable, variables), *([] if twin else _solver_limits())]),
        "Licence": [
            f'<p>The FMU was made by cablefmu {escape(__version__)}, BSD-3-Clause: <a href="licenses/license.txt">its'
            " licence</a>.</p>"
        ],
    }
    offered = "Co-Simulation" if twin else "Model Exchange and Co-Simulation"
    return _page(scene, f"FMI {fmi}.0, {offered}", sections).encode()


@cache
def _style() -> str:
    return (files("cablefmu") / "fmu" / "assets" / "documentation.css").read_text(encoding="utf-8")


def _page(scene: Scene, kind: str, sections: Mapping[str, Iterable[str]]) -> str:
    links = "\n".join(f'<li><a href="#{_anchor(title)}">{title}</a></li>' for title in sections)
    content = "\n".join(
        "\n".join([f'<section id="{_anchor(title)}">', f"<h2>{title}</h2>", *parts, "</section>"])
        for title, parts in sections.items()
    )
    frame = "<b>x to the right, y down</b>, angles from the downward vertical, positive towards +x"
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{escape(scene.name)}</title>
<style>
{_style()}</style>
</head>
<body>
<header>
<h1>{escape(scene.name)}</h1>
<p class="lead">{_sentence(scene.description)}</p>
<p class="kind">{kind}. SI units; {frame}.</p>
<nav><ul>
{links}
</ul></nav>
</header>
<main>
{content}
</main>
</body>
</html>
"""


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


def _sentence(text: str) -> str:
    return escape(text if text.endswith((".", "!", "?")) else f"{text}.")


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>"


def _rich(text: str) -> str:
    """Text with `code` and $formulas$."""
    parts = re.split(r"(`[^`]+`|\$[^$]+\$)", text)
    return "".join(
        _code(part[1:-1]) if part.startswith("`") else mathml(part[1:-1]) if part.startswith("$") else escape(part)
        for part in parts
    )


# --- the scene ---


def _caption(cable: Cable) -> str:
    sought = cable.initial is Initial.EQUILIBRIUM
    what = "The shape near which the equilibrium is sought" if sought else "The shape at the start, at rest"
    length = number(float(np.sum(cable.links.length)))
    return f"<figcaption>{what}: {length} m in {cable.n} links, to scale but for the bodies at its ends.</figcaption>"


def _facts(scene: Scene) -> Iterator[str]:
    rows = "\n".join(f"<tr><th>{name}</th><td>{_rich(value)}</td></tr>" for name, value in _about(scene.cable))
    yield f'<table class="facts">\n{rows}\n</table>'


def _about(cable: Cable) -> Iterator[tuple[str, str]]:
    """What the scene says of the cable that is no parameter of the FMU."""
    links = cable.links
    yield "Links", f"{cable.n}, rigid"
    yield "Length", f"{number(float(np.sum(links.length)))} m, each link {_spread(links.length, 'm')}"
    yield "Mass", f"{number(float(np.sum(links.mass)))} kg, each link {_spread(links.mass, 'kg')}"
    if cable.in_water:
        submerged = float(np.sum(links.mass - cable.parameters["rho_w"] * links.volume)) * cable.parameters["g"]
        yield "Weight in water", f"{number(submerged)} N without the end"
    for name, values, unit, parameter in (
        ("Joint stiffness", links.joint_stiffness, "N m/rad", "k_joint"),
        ("Joint damping", links.joint_damping, "N m s/rad", "c_joint"),
    ):
        if np.any(values):
            settable = f", parameter `{parameter}`" if parameter in cable.parameters else ""
            yield name, f"{_spread(values, unit)}{settable}"
    if cable.drag is Drag.COEFFICIENT:
        yield "Diameter", _spread(links.drag_area / links.length, "m")
        settable = ", parameter `Cd`" if "Cd" in cable.parameters else ""
        yield "Drag coefficient", f"{_spread(links.drag, '')}{settable}"
    elif cable.drag is Drag.PER_LINK:
        yield "Drag of each link", _spread(links.drag, "N s²/m²")
    yield "Top", _TOP_WORDS[cable.top]
    yield "End", _END_WORDS[cable.terminal]


_TOP_WORDS = {
    Top.FLOATER: "a floater, see the parameters",
    Top.FREE: "a floater that heaves and surges, see the parameters",
    Top.MOTION: "a vessel whose motion is an input",
}
_TOP_LIMITS = {
    Top.FLOATER: ("Floater 1 only heaves; its spring and its damper are linear.",),
    Top.FREE: ("Floater 1 heaves and surges, and does not turn; its springs and its dampers are linear.",),
    Top.MOTION: ("The vessel at the top moves as it is told: what the cable does to it is for others to reckon with.",),
}
_END_WORDS = {
    Terminal.LOAD: "a load",
    Terminal.ANCHOR_MASS: "an anchor of mass, neutrally buoyant",
    Terminal.ANCHOR_SPRING: "an anchor on springs and dampers",
    Terminal.FLOATER: "a second floater on springs and dampers",
    Terminal.PIN: "a pin, which cannot move",
    Terminal.MOTION: "a vessel whose motion is an input",
}


def _spread(values: np.ndarray, unit: str) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    # Values that were divided by something differ in their last digits.
    alike = high - low <= 1e-12 * abs(high)
    return f"{number(low) if alike else f'{number(low)} to {number(high)}'} {unit}".strip()


# --- how to run it ---


def _driving(scene: Scene, variables: Sequence[Variable], file: str, given: str) -> Iterator[str]:
    yield "<p>In Python, with FMPy (<code>pip install fmpy</code>):</p>"
    yield f'<pre><code class="language-python">{escape(_snippet(scene, variables, file))}</code></pre>'
    if given:
        yield f"<p>In Co-Simulation an input is held over a communication step unless the host gives {given}.</p>"
        if _motions(scene.cable):
            yield (
                "<p>Of a motion the host sets place, velocity and acceleration. Inside the step the place follows the"
                " velocity, and that the acceleration, unless the host says otherwise: from three that are held, a"
                " velocity that goes linearly with time and a place that goes with its square.</p>"
            )
    driven = [name for name in scene.cable.inputs if scene.signals[name] != Constant(0.0)]
    if driven:
        yield (
            "<p>What happens over time is the host's business. The scene that this FMU was made of has these, and"
            f" {_code(f'cablefmu run {file}')} feeds them:</p>"
        )
        units = {variable.name: variable.unit for variable in variables}
        items = "\n".join(
            f"<li>{_code(name)}: {_signal_words(scene.signals[name], units.get(name, 'N'))}</li>" for name in driven
        )
        yield f"<ul>\n{items}\n</ul>"
    named = f"resources/{scene.name}.toml"
    yield f'<p>The scene itself is in the archive: <a href="../{escape(named)}">{escape(named)}</a>.</p>'


def _given(fmi: int) -> str:
    """How a host says what an input does inside a communication step."""
    if fmi == 2:
        return "its time derivatives (<code>fmi2SetRealInputDerivatives</code>)"
    return "it in the middle of the step as well (intermediate update)"


def _motions(cable: Cable) -> list[str]:
    """Places that are inputs: x_1, y_1, x_2, y_2 as far as there are any."""
    return [name for name in cable.inputs if name in ("x_1", "y_1", "x_2", "y_2")]


def _driven(cable: Cable) -> str:
    """An array of inputs over time: a force that sets in, or a vessel that goes to and fro beside one that does not."""
    places = _motions(cable)
    if not places:
        return f"""\
columns = [("time", float), ("{cable.inputs[0]}", float)]  # s, N
driven = np.array([(0, 0), (1, 1000), (5, 1000)], dtype=columns)
"""
    every = [f"{kind}{place}" for place in places for kind in ("", "v", "a")]
    names = ", ".join(f'"{name}"' for name in every if name in cable.inputs)
    first, *others = ((place, cable.input_start.get(place, 0.0)) for place in places)
    accelerated = f'driven["a{first[0]}"] = np.cos(t)  # m/s2\n' if f"a{first[0]}" in cable.inputs else ""
    resting = "".join(f'driven["{place}"] = {start:.12g}\n' for place, start in others if start)
    return f"""\
t = np.linspace(0, 10, 101)  # s
driven = np.zeros(len(t), dtype=[(name, float) for name in ("time", {names})])
driven["time"] = t
driven["{first[0]}"] = {first[1]:.12g} + 1 - np.cos(t)  # m
driven["v{first[0]}"] = np.sin(t)  # m/s
{accelerated}{resting}"""


def _snippet(scene: Scene, variables: Sequence[Variable], file: str) -> str:
    outputs = [variable.name for variable in variables if variable.causality == "output"][:4]
    return f"""\
import numpy as np
from fmpy import simulate_fmu

{_driven(scene.cable)}result = simulate_fmu(
    "{file}",
    stop_time={scene.stop_time:g},
    output_interval={scene.step:g},
    start_values={{"g": {scene.cable.parameters["g"]!r}}},  # any parameter
    input=driven,
    output={outputs!r},
)
print(result.dtype.names, result[-1])
""".replace("'", '"')


def _signal_words(signal: Signal, unit: str) -> str:
    match signal:
        case Constant():
            return f"{number(signal.value)} {_unit(unit)}"
        case Derivative():
            return ("the velocity", "the acceleration")[signal.order - 1] + " of that motion"
        case Sine():
            offset = f"{number(signal.offset)} {unit} + " if signal.offset else ""
            phase = f" + {number(signal.phase)}" if signal.phase else ""
            since = f" from t = {number(signal.start)} s on, counted from there" if signal.start is not None else ""
            return (
                f"{offset}{number(signal.amplitude)} {unit} · sin(2π · {number(signal.frequency)} Hz · t{phase}){since}"
            )
        case Steps():
            steps = [f"{number(v)} {unit} from {number(t)} s" for t, v in zip(signal.times, signal.values, strict=True)]
            return ", ".join(steps) if len(steps) <= 8 else f"{len(steps)} steps"
        case Sampled():
            first, last = number(signal.times[0]), number(signal.times[-1])
            return f"{len(signal.times)} samples from {first} s to {last} s, linear between"
        case Spline():
            first, last = number(signal.times[0]), number(signal.times[-1])
            return f"the cubic spline through {len(signal.times)} samples from {first} s to {last} s"
    return "over time"


# --- variables ---

_HEALTH = "How the solver does"
_INTEGRATED = "The states that are no outputs, and the time derivatives of all states."
_GROUPS = (
    ("Inputs", "input", "The values are those of the scene at its start."),
    ("Outputs", "output", ""),
    (_HEALTH, "output", f"{COSIMULATION_ONLY}."),
    ("Size", "structuralParameter", "Set in configuration mode, before initialization: arrays have as many elements."),
    ("Parameters", "parameter", "Fixed once initialization has ended; the values are the scene's."),
    ("Preloads", "calculatedParameter", "Worked out at the start, fixed from then on."),
    ("States and derivatives", "local", _INTEGRATED),
    ("Time", "independent", ""),
)
"""Title, causality and words of each table."""


def _variables(variables: Sequence[Variable]) -> Iterator[str]:
    yield "<p>Every variable by its FMI name. Forces, displacements and velocities count right and down.</p>"
    for title, causality, words in _GROUPS:
        alike = [variable for variable in variables if variable.causality == causality]
        rows = rows_of([variable for variable in alike if (variable.kind is Kind.SOLVER) == (title == _HEALTH)])
        if rows:
            yield f"<h3>{title}</h3>"
            yield f"<p>Causality <code>{causality}</code>. {words}</p>".replace(" </p>", "</p>")
            yield _table(rows)


def _table(rows: list[Row]) -> str:
    starts = any(row.start for row in rows)
    head = "<tr><th>Name</th><th>Unit</th>" + ("<th>Value</th>" if starts else "") + "<th>Meaning, sign</th></tr>"
    lines = "\n".join(_line(row, starts) for row in rows)
    return f'<table class="variables">\n<thead>{head}</thead>\n<tbody>\n{lines}\n</tbody>\n</table>'


def _line(row: Row, starts: bool) -> str:
    name = _code(row.first) if row.first == row.last else f"{_code(row.first)} … {_code(row.last)}"
    start = f'<td class="number">{escape(row.start)}</td>' if starts else ""
    return f"<tr><td>{name}</td><td>{_unit(row.unit)}</td>{start}<td>{escape(row.description)}</td></tr>"


def _unit(unit: str) -> str:
    """As people write it: "N.m.s/rad" is N m s/rad, "m/s2" is m/s²."""
    if unit in ("", "1"):
        return "–"
    return escape(unit.replace(".", " ").replace("2", "²").replace("3", "³"))


# --- equations, solver, limits ---


def _equations(cable: Cable, variables: Sequence[Variable]) -> Iterator[str]:
    yield "<p>Planar motion of rigid links; a dot is a derivative with respect to time.</p>"
    for topic in equations_of(cable, variables):
        yield f"<h3>{topic.title}</h3>"
        for formula in topic.formulas:
            # Beside each other where there is room.
            parts = "\n".join(mathml(part, block=True) for part in formula.split(r"\quad"))
            yield f'<div class="formula">{parts}</div>'
        yield f"<p>{_rich(topic.words)}</p>"


def _solver(scene: Scene) -> Iterator[str]:
    items = "\n".join(
        f"<li>{_code(item.name)}: {escape(item.description)}.</li>" for item in ENUMERATIONS["solver"].items
    )
    yield (
        "<p>In Model Exchange the host's solver integrates. In Co-Simulation the FMU has its own, which needs no step"
        " size; the parameter <code>solver</code> chooses:</p>"
    )
    yield f"<ul>\n{items}\n</ul>"
    yield (
        "<p>Both control the same error: in every state x the largest local error stays below the tolerance times"
        f" 1 + |x|, in m, rad, m/s and rad/s. The default of the scene is {number(scene.tolerance)}, with"
        f" communication steps of {number(scene.step)} s up to {number(scene.stop_time)} s; these may vary. A step"
        " that cannot be done ends in an error that says what, where and when.</p>"
    )
    if scene.cable.initial is Initial.EQUILIBRIUM:
        yield (
            "<p>A run starts from the stable equilibrium under the inputs of the start, which is found during"
            " initialization; the start values of the angles are where the search begins.</p>"
        )


def _limits(limits: Iterable[str]) -> Iterator[str]:
    items = "\n".join(f"<li>{_rich(text)}</li>" for text in limits)
    yield f"<ul>\n{items}\n</ul>"


def _model_limits(cable: Cable, variables: Sequence[Variable]) -> Iterator[str]:
    yield "Motion is in one vertical plane. Links are rigid: the cable neither stretches nor twists."
    if cable.in_water:
        yield "The water is at rest, and resists motion across the links only. It is not carried along: no added mass."
        yield "All of the cable stays submerged, also above y = 0."
    else:
        yield "Nothing around the cable acts on it: its motion is that in a vacuum."
    yield "Nothing stops the cable at a ground or a seabed."
    yield from _TOP_LIMITS[cable.top]
    if cable.terminal is Terminal.FLOATER:
        yield "The springs and dampers of floater 2 are linear, and it does not turn."
    if cable.terminal is Terminal.LOAD and cable.in_water:
        yield "The load is a point, and the water does not resist its motion."
    if any(variable.kind is Kind.LINKS for variable in variables):
        yield "The number of links `n` is 1 to 10,000, and cannot change during a run; links are all alike."
    else:
        yield f"The number of links is fixed: {cable.n} here, 1 to 10,000 in other scenes."
    for name, kind in ((v.name, v.kind) for v in variables if v.name in ("static_load", "static_pull")):
        if kind is Kind.PRELOAD:
            yield f"`{name}` is worked out at the start, for the rest shape of the cable as its parameters have it."
        else:
            yield f"`{name}` is worked out when the FMU is built, and does not follow when other parameters change."
    yield "Inputs, parameters and states that are not finite are refused, and so are masses and densities below zero."


def _solver_limits() -> Iterator[str]:
    yield "Angles may wind up to 1.6e6 rad; beyond that a run ends with an error."
    yield "Tolerances are taken from 1e-13 to 0.1; what is outside counts as the nearest of these."
    yield "A communication step takes at most a million attempts at a step of the solver, then it ends with an error."
