"""A virtual environment for every host, under build/hosts, made once and made anew when its list changes."""

from __future__ import annotations

import fcntl
import shutil
import subprocess
import sys
from pathlib import Path

__all__ = ["INSIDE", "interpreter", "requirements"]

INSIDE = Path(__file__).with_name("inside")
_FOLDER = Path(__file__).parents[2] / "build" / "hosts"
_PATIENCE = 300
"""[s] for one installation."""


def requirements(host: str) -> list[str]:
    """The lines of inside/HOST.txt; the first is the host."""
    return (INSIDE / f"{host}.txt").read_text("utf-8").split()


def interpreter(host: str) -> Path:
    """The Python that has this host.

    Raises
    ------
    RuntimeError
        If it cannot be installed, with what pip says.
    """
    folder = _FOLDER / host
    _FOLDER.mkdir(parents=True, exist_ok=True)
    with (_FOLDER / f"{host}.lock").open("w") as lock:  # tests run side by side
        fcntl.flock(lock, fcntl.LOCK_EX)
        return _made(host, folder)


def _made(host: str, folder: Path) -> Path:
    python, stamp = folder / "bin" / "python", folder / "made_of.txt"
    made_of = "\n".join([sys.version, *requirements(host)])
    if stamp.exists() and stamp.read_text("utf-8") == made_of:
        return python
    shutil.rmtree(folder, ignore_errors=True)
    _run([sys.executable, "-m", "venv", "--without-pip", str(folder)])
    _run([
        sys.executable, "-m", "pip", "--python", str(python), "--disable-pip-version-check", "install", "-q",
        "--only-binary", ":all:", "-r", str(INSIDE / f"{host}.txt"),
    ])  # fmt: skip
    stamp.write_text(made_of, "utf-8")
    return python


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, timeout=_PATIENCE)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
