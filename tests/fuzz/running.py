"""One run of a fuzzer, and what it says at its end."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz.building import environment

__all__ = ["Outcome", "lines_covered", "merge", "run", "run_on"]

MOST_BYTES = {"calls": 768, "resource": 4096}
"""64 records; a cable of two links has some 1,500 bytes"""
_SECONDS_PER_FILE, _MOST_CRASHES = 20, 20


@dataclass(frozen=True)
class Outcome:
    """What a fuzzer did."""

    executions: int
    edges: int
    """Of the program's branches, taken by some file"""
    crashes: list[Path]
    """Files that broke it"""
    text: str
    """What it printed last"""


def run(program: Path, scenes: Path, found: Path, start: Iterable[Path], *, seconds: int, seed: int = 1) -> Outcome:
    """Mutate files of the folders `start` for so long or until one breaks something; what is new goes to `found`."""
    crashes = found.parent / f"{found.name}-crashes-{seed}"
    crashes.mkdir(parents=True, exist_ok=True)
    found.mkdir(exist_ok=True)
    command = [str(program), f"-max_total_time={seconds}", f"-seed={seed}", f"-artifact_prefix={crashes}/"]
    command += [f"-max_len={MOST_BYTES[program.name]}", f"-timeout={_SECONDS_PER_FILE}", "-print_final_stats=1"]
    command += [str(found), *map(str, start)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", env=environment(scenes))
    executions = re.findall(r"number_of_executed_units: (\d+)", done.stderr) or ["0"]
    edges = re.findall(r"^#\d+\s.*?cov: (\d+)", done.stderr, re.MULTILINE) or ["0"]
    files = sorted(crashes.iterdir())
    assert files or done.returncode == 0, done.stderr[-3000:]
    return Outcome(int(executions[-1]), int(edges[-1]), files, done.stderr[-6000:])


def run_on(
    program: Path, scenes: Path, found: Path, start: Sequence[Path], *, seconds: int, seed: int, jobs: int
) -> Outcome:
    """The same in several processes that share what they find, each begun anew after a crash until the time is up."""
    until = time.monotonic() + seconds

    def work(job: int) -> list[Outcome]:
        outcomes: list[Outcome] = []
        while (left := round(until - time.monotonic())) > 0 and len(outcomes) < _MOST_CRASHES:
            number = seed + job + jobs * len(outcomes)
            outcomes.append(run(program, scenes, found, start, seconds=left, seed=number))
        return outcomes

    with ThreadPoolExecutor(jobs) as pool:
        outcomes = [outcome for several in pool.map(work, range(jobs)) for outcome in several]
    return Outcome(
        sum(outcome.executions for outcome in outcomes),
        max(outcome.edges for outcome in outcomes),
        [path for outcome in outcomes for path in outcome.crashes],
        outcomes[-1].text,
    )


def merge(program: Path, scenes: Path, into: Path, folders: Iterable[Path]) -> None:
    """Few files of the folders that take all their branches, however often."""
    command = [
        str(program),
        "-merge=1",
        "-use_counters=0",
        f"-max_len={MOST_BYTES[program.name]}",
        str(into),
        *map(str, folders),
    ]
    subprocess.run(command, capture_output=True, check=True, env=environment(scenes))


def lines_covered(programs: dict[Path, list[Path]], scenes: Path, sources: Iterable[Path]) -> dict[str, float]:
    """Share of the lines of each source that files in these folders execute, by programs compiled for coverage [%]."""
    profiles: list[str] = []
    for program, folders in programs.items():
        profiles.append(f"{program}.profraw")
        subprocess.run(
            [str(program), "-runs=0", *map(str, folders)], capture_output=True, check=True,
            env=environment(scenes) | {"LLVM_PROFILE_FILE": profiles[-1]},
        )  # fmt: skip
    first, *others = programs
    merged = first.with_suffix(".profdata")
    subprocess.run(["llvm-profdata", "merge", "-sparse", *profiles, "-o", str(merged)], check=True)
    objects = [word for program in others for word in ("-object", str(program))]
    report = subprocess.run(
        ["llvm-cov", "export", "-format=lcov", f"-instr-profile={merged}", str(first), *objects, *map(str, sources)],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    share: dict[str, float] = {}
    for record in report.split("end_of_record"):
        name, lines = re.search(r"^SF:(.*)$", record, re.MULTILINE), re.findall(r"^DA:\d+,(\d+)", record, re.MULTILINE)
        if name and lines:
            share[Path(name[1]).name] = 100.0 * sum(count != "0" for count in lines) / len(lines)
    return share
