"""`python -m tests.fuzz --minutes 60 --jobs 1`: fuzz for so long, and keep what is found.

Needs Debian's clang, llvm and libclang-rt-14-dev. Files that take new branches go to tests/fuzz/corpus, as few as do;
files that break something stay in build/fuzz, and the exit status is 1.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

from tests.fuzz.building import COVERAGE, FUZZERS, SAVED, compile_fuzzers, starts, write_scenes
from tests.fuzz.running import Outcome, lines_covered, merge, run_on
from tests.kernel.library import toolchain

SHARE = {"calls": 0.8, "resource": 0.2}
"""Of the time"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    work = Path("build/fuzz").resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    scenes = write_scenes(work)
    start = starts(scenes, work)
    compile_fuzzers(work / "sanitized")
    compile_fuzzers(work / "coverage", COVERAGE)

    outcomes: dict[str, Outcome] = {}
    for name in FUZZERS:
        seconds = round(60.0 * options.minutes * SHARE[name])
        program, found = work / "sanitized" / name, work / f"found-{name}"
        outcomes[name] = run_on(
            program, scenes, found, start[name], seconds=seconds, seed=options.seed, jobs=options.jobs
        )
        outcome = outcomes[name]
        print(f"{name}: {outcome.executions} executions in {seconds} s, {outcome.edges} edges, "
              f"{len(outcome.crashes)} crashes", flush=True)  # fmt: skip
        for path in outcome.crashes:
            print(f"  {path}")

    fewest = work / "fewest"
    fewest.mkdir()
    program = work / "sanitized" / "calls"
    merge(program, scenes, fewest, [*start["calls"], work / "found-calls"])
    shutil.rmtree(SAVED)
    shutil.copytree(fewest, SAVED)
    size = sum(path.stat().st_size for path in fewest.iterdir())
    print(f"corpus: {len(list(fewest.iterdir()))} files, {size} bytes")

    folders = {work / "coverage" / name: start[name] for name in FUZZERS}
    for name, share in lines_covered(folders, scenes, sorted((toolchain().HERE / "fmi").glob("*.c"))).items():
        print(f"{name}: {share:.1f} % of its lines")
    return 1 if any(outcome.crashes for outcome in outcomes.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
