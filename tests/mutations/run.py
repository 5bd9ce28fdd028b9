"""The guards in front of a kernel of one's own choice, in a process of their own.

`python -m tests.mutations.run` shows what catches what.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree

from tests.mutations.defects import DEFECTS, GUARDS
from tests.sources import changed_copy

__all__ = ["failures"]

_ROOT = Path(__file__).parents[2]


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


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        for number, (title, defect) in enumerate(DEFECTS.items()):
            failed = failures(changed_copy(Path(place) / str(number), defect.changes))
            print(f"{title}: {', '.join(name for name in GUARDS if name in failed)}", flush=True)
