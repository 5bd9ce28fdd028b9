"""Instructions by feature, counted by callgrind: the same on every run.

`python -m tests.lean.counts` counts anew, and writes tests/data/lean.json and the tables of docs/lean.md.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from cablefmu.fmu.resource import resource_bytes, token_of
from cablefmu.fmu.variables import variables_of
from cablefmu.scene import Scene
from tests.benchmarks.test_instructions import compile_program, instructions, per_evaluation
from tests.fmu_helpers import unpack
from tests.kernel.library import ROOT, toolchain
from tests.lean.features import FEATURES, scene_pair
from tests.lean.without import INTERFACES, WITHOUT
from tests.sources import changed_copy

__all__ = [
    "COUNTS", "FREE", "LINKS", "PAGE", "RIGHT_SIDES", "SCENES", "STATICS", "STEPPED", "added_code", "compile_steps",
    "growth", "per_step", "right_side", "shortened_program", "tables", "until_first_step",
]  # fmt: skip

COUNTS = Path(__file__).parents[1] / "data" / "lean.json"
PAGE = ROOT / "docs" / "lean.md"
LINKS = (12, 120)

RIGHT_SIDES = {
    "water (drag and buoyancy)": ("wkcru", "kcru"),
    "drag, the buoyancy staying": ("wkcru", "bkcru"),
    "joint stiffness": ("wkcru", "wcru"),
    "joint damping": ("wkcru", "wkru"),
    "terminal spring": ("wkcrus", "wkcru"),
    "second floater": ("wkcruf", "wkcru"),
    "pin": ("wkcrup", "wkcru"),
    "rotary inertia of the load": ("wkcru", "wkcu"),
    "inputs, all four": ("wkcru", "wkcr"),
}
"""Feature -> letters of tests/benchmarks/count.c with it and without."""

FREE = ("rotary inertia of the load", "inputs, all four")
"""What is a number in a sum that is there anyway: with it or without, the instructions are the same."""

SCENES = {
    "drag": "kcru", "terminal spring": "wkcru", "joint stiffness": "wcru", "joint damping": "wkru", "pin": "wkcru",
    "horizontal loads on links": "kcru", "torques on links": "wru",
}  # fmt: skip
"""The scene that has everything else, for what code there is."""

STEPPED = (
    *(name for name in FEATURES if name.startswith("output ") and "." not in name),
    "output solver.energy_residual", "outputs solver.*",
)  # fmt: skip
"""What may cost a communication step of an FMU, besides its right-hand sides."""

STATICS = "outputs statics.*"
"""What costs once, before the first step: the equilibrium that they tell of."""


def right_side(program: Path, feature: str, links: int) -> tuple[int, int]:
    """Instructions of an evaluation with the feature and without."""
    having, lacking = RIGHT_SIDES[feature]
    return round(per_evaluation(program, links, having)), round(per_evaluation(program, links, lacking))


def added_code(program: Path, shortened: Path, feature: str, links: int) -> dict[str, tuple[int, int]]:
    """The kernel as it is against the one without the code, for the bare scene and for the one with all else."""
    scenes = {"bare": "", "with all else": SCENES[feature]}
    return {
        name: (round(per_evaluation(program, links, letters)), round(per_evaluation(shortened, links, letters)))
        for name, letters in scenes.items()
    }


def shortened_program(folder: Path, feature: str) -> Path:
    return compile_program(folder, changed_copy(folder / "sources", (WITHOUT | INTERFACES)[feature]))


def compile_steps(folder: Path) -> Path:
    """fmu_steps.c with the FMU's sources."""
    recipe = toolchain()
    flags = [flag for flag in recipe.RELEASE if flag not in ("-shared", "-s")]
    sources = [Path(__file__).with_name("fmu_steps.c"), *recipe.kernel_sources(), *recipe.fmi_sources()]
    recipe.compile_library(folder / "steps", sources, flags, target=recipe.TARGETS["x86_64-linux"][0])
    return folder / "steps"


def until_first_step(program: Path, scene: Scene, folder: Path) -> int:
    """Instructions of loading, instantiation and initialisation."""
    return instructions(program, *_unpacked(scene, folder), 0)


def per_step(program: Path, scene: Scene, folder: Path) -> int:
    """Instructions of a communication step: of 30 less 10, over 20."""
    place, token = _unpacked(scene, folder)
    few, many = (instructions(program, place, token, steps) for steps in (10, 30))
    return round((many - few) / 20)


def _unpacked(scene: Scene, folder: Path) -> tuple[Path, str]:
    """Where its FMU lies, and the FMU's token."""
    place = unpack(scene, folder, 2)
    return place, token_of(resource_bytes(scene.cable, variables_of(scene.cable, scene.dropped_outputs)))


def measure(folder: Path) -> dict[str, list[dict[str, str | int]]]:
    """Everything, as it stands in lean.json."""
    program, steps = compile_program(folder), compile_steps(folder)
    sides: list[dict[str, str | int]] = []
    for feature in RIGHT_SIDES:
        for links in LINKS:
            having, lacking = right_side(program, feature, links)
            sides.append({"feature": feature, "links": links, "with": having, "without": lacking})
    added: list[dict[str, str | int]] = []
    for feature in (*WITHOUT, *INTERFACES):
        shortened = shortened_program(folder / feature, feature)
        for links in LINKS:
            for scene, (whole, short) in added_code(program, shortened, feature, links).items():
                added.append({"code": feature, "links": links, "scene": scene, "there": whole, "deleted": short})
    stepped: list[dict[str, str | int]] = []
    for feature in STEPPED:
        pair = [per_step(steps, scene, folder / feature) for scene in scene_pair(feature)]
        stepped.append({"feature": feature, "with": pair[0], "without": pair[1]})
    begun = [until_first_step(steps, scene, folder / STATICS) for scene in scene_pair(STATICS)]
    started: list[dict[str, str | int]] = [{"feature": STATICS, "with": begun[0], "without": begun[1]}]
    return {"right-hand side": sides, "code": added, "communication step": stepped, "until the first step": started}


def tables(counts: Mapping[str, Iterable[Mapping[str, str | int]]]) -> str:
    """The three tables of docs/lean.md."""
    return "\n".join([*_sides(counts["right-hand side"]), "", *_code(counts["code"]), "", *_steps(counts)])


def _sides(rows: Iterable[Mapping[str, str | int]]) -> list[str]:
    lines = ["| right-hand side | 12 links, with | without | 120 links, with | without |", "|---|---|---|---|---|"]
    rows = list(rows)
    for feature in dict.fromkeys(row["feature"] for row in rows):
        cells = [str(row[key]) for row in rows if row["feature"] == feature for key in ("with", "without")]
        lines.append(f"| {feature} | {' | '.join(cells)} |")
    return lines


def _code(rows: Iterable[Mapping[str, str | int]]) -> list[str]:
    lines = ["| code of | 12 links, bare | with all else | 120 links, bare | with all else |", "|---|---|---|---|---|"]
    rows = list(rows)
    for feature in dict.fromkeys(row["code"] for row in rows):
        cells = [f"{growth(row):+.2f} %" for row in rows if row["code"] == feature]
        lines.append(f"| {feature} | {' | '.join(cells)} |")
    return lines


def _steps(counts: Mapping[str, Iterable[Mapping[str, str | int]]]) -> list[str]:
    lines = ["| communication step | with | without |", "|---|---|---|"]
    lines += [f"| {row['feature']} | {row['with']} | {row['without']} |" for row in counts["communication step"]]
    (start,) = counts["until the first step"]
    return [*lines, f"| {start['feature']}: all before the first step | {start['with']} | {start['without']} |"]


def growth(row: Mapping[str, str | int]) -> float:
    """By how much the count grows when the code is added [%]."""
    return 100.0 * (int(row["there"]) / int(row["deleted"]) - 1.0)


def write_page(text: str) -> None:
    """The tables into docs/lean.md, between its marks."""
    page = PAGE.read_text(encoding="utf-8")
    pattern = re.compile(r"(<!-- counts -->\n).*?(<!-- end -->)", re.DOTALL)
    PAGE.write_text(pattern.sub(lambda found: f"{found[1]}{text}\n{found[2]}", page), encoding="utf-8")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        found = measure(Path(place))
    rows = ",\n".join(
        f' "{part}": [\n  ' + ",\n  ".join(json.dumps(row) for row in part_rows) + "\n ]"
        for part, part_rows in found.items()
    )
    COUNTS.write_text("{\n" + rows + "\n}\n", encoding="utf-8")
    write_page(tables(found))
    print(tables(found))
