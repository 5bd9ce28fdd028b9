"""Code blocks of the documentation: found in Markdown, run as a reader would, and what they print compared.

A block marked sh or python at the margin is run, all of a page in one folder and one Python, from top to bottom. A
block after `<!-- file: NAME -->` is that file. A text block is what the block before it prints, "..." standing for
anything.
"""

from __future__ import annotations

import doctest
import json
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Block", "blocks_of", "run_page"]

_BLOCK = re.compile(
    r"(?:^<!-- file: (?P<file>\S+) -->\n)?^```(?P<kind>\w+)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL
)
_BETWEEN = "<<< next block >>>"
_RUN = f"""
import json, subprocess, sys
space = {{"__name__": "__main__"}}
for kind, line, text in json.loads(sys.stdin.read()):
    print({_BETWEEN!r}, flush=True)
    if kind == "python":
        exec(compile("\\n" * line + text, sys.argv[1], "exec"), space)
    else:
        subprocess.run(["bash", "-euo", "pipefail", "-c", text], check=True, stdin=subprocess.DEVNULL)
    sys.stdout.flush()
"""


@dataclass(frozen=True, slots=True)
class Block:
    """One fenced block."""

    kind: str
    """sh, python, toml, text, ..."""
    text: str
    line: int
    """Of its fence, from 1."""
    file: str | None = None
    """What the reader is to call it."""


def blocks_of(text: str) -> list[Block]:
    """The blocks that begin at the margin and say what they are, in order."""
    return [
        Block(found["kind"], found["text"], text.count("\n", 0, found.start("kind")) + 1, found["file"])
        for found in _BLOCK.finditer(text)
    ]


def run_page(page: str, blocks: Sequence[Block], folder: Path) -> list[str]:
    """Run a page's blocks in `folder`; one line for everything that went otherwise than it says."""
    for block in blocks:
        if block.file:
            (folder / block.file).write_text(block.text, "utf-8")
    run = [block for block in blocks if block.kind in ("sh", "python") and not block.file]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", _RUN, page], cwd=folder, env=environment, capture_output=True, text=True,
        timeout=300, check=False, input=json.dumps([(block.kind, block.line, block.text) for block in run]),
    )  # fmt: skip
    if done.returncode:
        return [f"{page}: status {done.returncode}: {done.stderr.strip()}"]
    printed = dict(zip((block.line for block in run), done.stdout.split(f"{_BETWEEN}\n")[1:], strict=True))
    checker, flags = doctest.OutputChecker(), doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    wrong, last = [], ""
    for block in blocks:
        last = printed.get(block.line, last)
        if block.kind == "text" and not block.file and not checker.check_output(block.text, last, flags):
            wrong.append(f"{page}, line {block.line}: expected {block.text!r}, printed {last!r}")
    return wrong
