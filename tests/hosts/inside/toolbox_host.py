"""The checkers of fmu-manipulation-toolbox, and its container: an FMU that runs ours, run by FMPy."""

from __future__ import annotations

import logging
import subprocess
import sys
import tempfile
from pathlib import Path
from shutil import copy
from typing import Any

from exchange import Request, answer
from fmpy_host import run as run_fmpy
from fmu_manipulation_toolbox.checker import get_checkers
from fmu_manipulation_toolbox.operations import FMU


def check(request: Request) -> dict[str, Any]:
    """Everything from a warning up that its checkers say."""
    complaints: list[str] = []

    class Listener(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            if record.levelno >= logging.WARNING:
                complaints.append(record.getMessage())

    logging.getLogger("fmu_manipulation_toolbox").addHandler(Listener())
    fmu, checkers = FMU(request["fmu"]), get_checkers()
    for checker in checkers:
        fmu.apply_operation(checker())
    return {"checkers": [checker.__name__ for checker in checkers], "complaints": complaints}


def contained(request: Request) -> dict[str, Any]:
    """Its command line makes the container, whose inputs and outputs are ours."""
    with tempfile.TemporaryDirectory() as name:
        copy(request["fmu"], Path(name, "cable.fmu"))
        Path(name, "container.csv").write_text("rule;from_fmu;from_port;to_fmu;to_port\nFMU;cable.fmu;;;\n", "utf-8")
        make = [Path(sys.prefix, "bin", "fmucontainer"), "-container", f"container.csv:{request['step']}"]
        said = subprocess.run([*make, "-fmi", str(request["fmi"])], cwd=name, capture_output=True, text=True)
        container = Path(name, "container.fmu")
        if not container.exists():
            raise RuntimeError(said.stdout + said.stderr)
        return run_fmpy({**request, "fmu": str(container)})


if __name__ == "__main__":
    answer(
        "fmu-manipulation-toolbox", lambda request: (check if request["interface"] == "check" else contained)(request)
    )
