"""The page of all variables that FMUs have, made of the table that kernel and descriptions are made of."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from itertools import chain, combinations

from cablefmu.cable import Terminal, Top
from cablefmu.errors import SceneError
from cablefmu.fmu.table import Row, table
from cablefmu.fmu.variables import COSIMULATION_ONLY, ENUMERATIONS, FRAME, Variable, variables_of
from cablefmu.scene import load_scene, shipped_scenes
from cablefmu.whole import whole_of

__all__ = ["Entry", "entries", "variables_page"]

ARRAYS = "with `--arrays`"
_INDEX = re.compile(r"\[\d+\]")
_LINK = re.compile(r"\bLink \d+\b")
_TOPS = {
    Top.FLOATER: "a floater that heaves",
    Top.FREE: "a floater that heaves and surges",
    Top.MOTION: "a vessel at the top",
}
_TERMINALS = {
    Terminal.LOAD: "a load",
    Terminal.ANCHOR_MASS: "an anchor that is a mass",
    Terminal.ANCHOR_SPRING: "an anchor on springs",
    Terminal.FLOATER: "a second floater",
    Terminal.PIN: "a pin",
    Terminal.MOTION: "a vessel at the lower end",
}

_TITLES = {
    "structuralParameter": "Parameters",
    "parameter": "Parameters",
    "calculatedParameter": "Parameters",
    "input": "Inputs",
    "output": "Outputs",
    "local": "States and their derivatives",
    "independent": "Time",
}
_ORDER = ("Inputs", "Outputs", "Parameters", "States and their derivatives", "Time")

_HEAD = """# Variables of the FMUs

Every variable that an FMU of a cable can have. A scene's FMU has those alone that the scene needs, in the same order
and with the same names in FMI 2 and 3. SI units, x to the right, y down, angles from the downward vertical. Scenes may
leave out any output by `[outputs]`; `solver.` outputs stay 0 in Model Exchange. Angles and rates are shown once for all
links: `theta[i]` is of link i, 1 at the top; with `--arrays` (FMI 3) they are arrays. `statics.` outputs come with
`[run] initial = "equilibrium"`.

Made of the same table as the FMUs (`fmu_src/kernel/variables.def`) and of the scenes that ship.
"""


@dataclass
class Entry:
    """One variable, in whichever scenes it is."""

    name: str
    unit: str
    causality: str
    variability: str
    description: str
    scenes: list[str] = field(default_factory=list)
    """Names of shipped scenes, and ARRAYS."""


def entries() -> dict[str, Entry]:
    """By name, those of shipped scenes in the order of FMUs; behind them what no scene that ships has."""
    found: dict[str, Entry] = {}
    for name in shipped_scenes():
        cable = load_scene(name).cable
        _add(found, variables_of(cable), name)
    for name in shipped_scenes():
        scene = load_scene(name)
        try:
            whole = whole_of(scene)
        except SceneError:
            continue
        _add(found, variables_of(scene.cable, whole=whole), ARRAYS)
    return found | {name: entry for name, entry in _of_table().items() if name not in found}


def _add(found: dict[str, Entry], variables: Iterable[Variable], place: str) -> None:
    for variable in variables:
        name = _INDEX.sub("[i]", variable.name)
        description = _LINK.sub("Link i", _INDEX.sub("[i]", variable.description))
        entry = found.setdefault(
            name, Entry(name, variable.unit, variable.causality, variable.variability, description)
        )
        if place not in entry.scenes:
            entry.scenes.append(place)


def _of_table() -> dict[str, Entry]:
    """Every row of the table, whether a scene that ships has it or not."""
    lists: list[tuple[dict[str, Row], str, str]] = [
        (table().inputs, "input", "continuous"), (table().outputs, "output", "continuous"),
        (table().solver, "output", "continuous"), (table().statics, "output", "discrete"),
        (table().parameters, "parameter", "fixed"), (table().whole, "parameter", "fixed"),
    ]  # fmt: skip
    return {
        name: Entry(name, row.unit, causality, variability, row.description)
        for rows, causality, variability in lists
        for name, row in rows.items()
    }


def variables_page() -> str:
    """The page in Markdown."""
    all_entries = list(entries().values())
    parts = [_HEAD]
    for title in _ORDER:
        chosen = [entry for entry in all_entries if _TITLES[entry.causality] == title]
        parts.append(
            f"## {title}\n\n| name | unit | causality | what | in scenes with |\n| --- | --- | --- | --- | --- |"
        )
        parts[-1] += "".join(f"\n{_row(entry)}" for entry in chosen) + "\n"
    parts.append(_enumerations())
    return "\n".join(parts)


def _row(entry: Entry) -> str:
    causality = entry.causality if entry.variability in ("fixed", "continuous") else f"{entry.causality}, discrete"
    what = entry.description.removesuffix(f"; {FRAME}").removesuffix(f"; {COSIMULATION_ONLY}").replace("|", "\\|")
    cells = (f"`{entry.name}`", entry.unit, causality, what, where(entry.scenes))
    return f"| {' | '.join(cells)} |"


def where(scenes: list[str]) -> str:
    """By what is at the ends and around the cable, if that tells these scenes from all others; else by name."""
    named = {name for name in scenes if name != ARRAYS}
    if not named:
        return f"only {ARRAYS}" if scenes else "none that ships"
    if len(named) == len(shipped_scenes()):
        return "all"
    axes = _axes()
    for chosen in chain(combinations(axes, 1), combinations(axes, 2)):
        words = [{axis[name]: None for name in shipped_scenes() if name in named} for axis in chosen]
        if named == {n for n in shipped_scenes() if all(a[n] in w for a, w in zip(chosen, words, strict=True))}:
            return ", and ".join(" or ".join(alternatives) for alternatives in words)
    return ", ".join(f"`{name}`" for name in shipped_scenes() if name in named)


@cache
def _axes() -> tuple[dict[str, str], ...]:
    """What is at the top of each scene that ships, at its lower end, and around it."""
    cables = {name: load_scene(name).cable for name in shipped_scenes()}
    return (
        {name: _TOPS[cable.top] for name, cable in cables.items()},
        {name: _TERMINALS[cable.terminal] for name, cable in cables.items()},
        {name: "water" if cable.in_water else "air" for name, cable in cables.items()},
    )


def _enumerations() -> str:
    parts = ["## Enumerations\n"]
    for name, kind in ENUMERATIONS.items():
        parts.append(
            f"`{name}`, of type `{kind.name}`: {kind.description}.\n\n| value | name | what |\n| --- | --- | --- |"
        )
        parts[-1] += "".join(f"\n| {item.value} | {item.name} | {item.description} |" for item in kind.items) + "\n"
    return "\n".join(parts)
