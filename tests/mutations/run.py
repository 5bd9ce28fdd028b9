"""The guards in front of a kernel of one's own choice, in a process of their own.

`python -m tests.mutations.run` shows what catches what: guards, `cablefmu report` and `cablefmu stress --short`;
`--markdown docs/mutations.md` writes the table there.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from platform import machine
from xml.etree import ElementTree

import cablefmu
from tests.kernel.library import toolchain
from tests.mutations.defects import DEFECTS, GUARDS, Defect
from tests.sources import changed_copy

__all__ = ["SCENE", "Told", "failures", "package_of", "rewritten", "row_of", "told_by_report", "told_by_stress"]

_ROOT = Path(__file__).parents[2]

SCENE = "free-12-water"
"""What `report` is asked for: it has water, springs and dampers, and takes seconds."""


def failures(sources: Path, guards: Iterable[str] = tuple(GUARDS)) -> set[str]:
    """Which guards fail with the C sources below that folder.

    Raises
    ------
    RuntimeError
        If anything but an assertion went wrong: a defect that does not compile is none.
    """
    report = sources / "guards.xml"
    command = [sys.executable, "-m", "pytest", "-q", "--tb=line", "-p", "no:cacheprovider", f"--junitxml={report}"]
    command += [GUARDS[name] for name in guards]
    done = subprocess.run(
        command, cwd=_ROOT, env=os.environ | {"CABLEFMU_SOURCES": str(sources)}, capture_output=True, text=True
    )
    if done.returncode not in (0, 1):
        raise RuntimeError((done.stdout + done.stderr)[:2000])
    cases = ElementTree.parse(report).findall(".//testcase")
    if not cases or any(case.find("error") is not None for case in cases):
        raise RuntimeError(done.stdout[:2000])
    failed = {
        (str(case.get("classname")).replace(".", "/") + ".py", str(case.get("name")).partition("[")[0])
        for case in cases
        if case.find("failure") is not None
    }
    return {name for name, guard in GUARDS.items() if tuple(guard.split("::")) in failed}


@dataclass(frozen=True)
class Told:
    """What a command of the package said of a defect."""

    caught: bool
    words: str
    """By what, or what it did not mind."""


def package_of(sources: Path, folder: Path) -> Path:
    """A copy of the package below `folder`, its FMUs with a library from those sources; what PYTHONPATH must hold."""
    package = shutil.copytree(Path(cablefmu.__file__).parent, folder / "cablefmu")
    recipe = toolchain(sources)
    platform = f"{machine()}-{sys.platform}"
    target, name = recipe.TARGETS[platform]
    output = package / "binaries" / platform / name
    recipe.compile_library(output, [*recipe.kernel_sources(), *recipe.fmi_sources()], recipe.RELEASE, target=target)
    return folder


def command(package: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """`cablefmu WORDS` of that package, run in its folder."""
    return subprocess.run(
        [sys.executable, "-m", "cablefmu", *words], cwd=package, env=os.environ | {"PYTHONPATH": str(package)},
        capture_output=True, text=True,
    )  # fmt: skip


def told_by_stress(package: Path, *words: str) -> Told:
    """What becomes of the short subset, or of the cases that `words` choose instead."""
    done = command(package, "stress", *(words or ("--short",)))
    if done.returncode not in (0, 1) or not (package / "build/stress/stress.json").is_file():
        raise RuntimeError(done.stdout[-1000:] + done.stderr[-1000:])
    cases = json.loads((package / "build/stress/stress.json").read_text(encoding="utf-8"))["cases"]
    failed = [case for case in cases if case["verdict"] not in ("within tolerance", "clean error")]
    if not failed:
        return Told(
            False, f"no: at most {max(case['worse'] or 0.0 for case in cases):.2g} times the error once measured"
        )
    first = failed[0]
    return Told(True, f"{len(failed)} of {len(cases)} cases; {first['case']} {first['verdict']}: {first['message']}")


def told_by_report(package: Path, scene: str = SCENE) -> Told:
    """Whether it trusts its reference, and whether the solvers at 1e-6 are within the accuracy that is asked for."""
    done = command(package, "report", scene, "--no-peers", "--limit", "2")
    if done.returncode == 1:
        return Told(True, f"refused: {done.stderr.strip().removeprefix(f'cablefmu: {scene}: ')}")
    data = json.loads((package / f"build/report/{scene}.report.json").read_text(encoding="utf-8"))
    off = {row["solver"]: row["error"]["position"] for row in data["ladder"] if row["tolerance"] == 1e-6}
    words = ", ".join(f"{solver} {error:.1e} m" for solver, error in off.items())
    caught = max(off.values()) > data["accuracy_m"]
    return Told(caught, f"at 1e-6 {words} off" if caught else f"no: at 1e-6 {words} off")


def row_of(name: str, defect: Defect, stress: Told, report: Told) -> str:
    """A line of the table."""
    cells = (f"**{name}**: {defect.what}", ", ".join(defect.caught_by), report.words, stress.words)
    return "| " + " | ".join(" ".join(cell.replace("|", "/").split()) for cell in cells) + " |"


def rewritten(page: str, rows: Iterable[str]) -> str:
    """The page with these lines in its table of defects."""
    head = "| defect | caught by the tests | report | stress |\n|---|---|---|---|\n"
    before, after = page.split(head)
    return before + head + "\n".join(rows) + after[after.index("\n\n") :]


def main(words: list[str]) -> None:
    """All guards, `report` and `stress` in front of every defect; --markdown FILE.md: the table of that page anew."""
    rows = []
    for name, defect in DEFECTS.items():
        with tempfile.TemporaryDirectory() as place:
            sources = changed_copy(Path(place) / "sources", defect.changes)
            failed = failures(sources)
            package = package_of(sources, Path(place) / "package")
            rows.append(row_of(name, defect, told_by_stress(package), told_by_report(package)))
        print(
            f"{rows[-1]}\n    all guards that fail: {', '.join(guard for guard in GUARDS if guard in failed)}",
            flush=True,
        )
    if words[:1] == ["--markdown"]:
        page = Path(words[1])
        page.write_text(rewritten(page.read_text(encoding="utf-8"), rows), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
