"""What a shell offers behind TAB where names or files are expected; commands and options are in the shell's script.

`cablefmu --install-completion` writes that script, which asks here by way of cyclopts' command `__complete`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from cyclopts import Parameter
from cyclopts.completion import CompletionContext

from .coupling.description import shipped_couplings
from .scene import shipped_scenes

__all__ = [
    "COUPLING_NAME",
    "COUPLING_OR_FILE",
    "SCENE_NAME",
    "SCENE_OR_COUPLING",
    "SCENE_OR_FILE",
    "SCENE_OR_FMU",
    "files_like",
]


def files_like(incomplete: str, suffixes: Iterable[str]) -> list[str]:
    """Files with one of the suffixes that begin like that, and folders, which end with a slash.

    Parameters
    ----------
    incomplete
        What was typed so far, perhaps with folders; hidden files are offered where a dot was typed.
    suffixes
        Such as ".toml".
    """
    folder, _, begin = incomplete.rpartition("/")
    base = f"{folder}/" if "/" in incomplete else ""
    try:
        entries = sorted(Path(base or ".").iterdir())
    except OSError:
        return []
    shown = [e for e in entries if e.name.startswith(begin) and (begin.startswith(".") or not e.name.startswith("."))]
    return [
        f"{base}{entry.name}{'/' if entry.is_dir() else ''}"
        for entry in shown
        if entry.is_dir() or entry.suffix in suffixes
    ]


def _offering(names: Callable[[], Iterable[str]], *suffixes: str) -> Parameter:
    """Of names, while what was typed may still be one, and of files with these suffixes."""

    def complete(context: CompletionContext) -> list[str]:
        typed = context.incomplete
        found = [name for name in names() if name.startswith(typed)]
        return found + (files_like(typed, suffixes) if suffixes else [])

    return Parameter(completer=complete)


SCENE_NAME = _offering(shipped_scenes)
COUPLING_NAME = _offering(shipped_couplings)
SCENE_OR_FILE = _offering(shipped_scenes, ".toml")
SCENE_OR_FMU = _offering(shipped_scenes, ".toml", ".fmu")
COUPLING_OR_FILE = _offering(shipped_couplings, ".toml")
SCENE_OR_COUPLING = _offering(lambda: [*shipped_scenes(), *shipped_couplings()], ".toml")
