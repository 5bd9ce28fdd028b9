"""Shell completion: the script that bash gets, run by bash, and what it asks the package for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cablefmu.cli import app, main
from cablefmu.completion import files_like
from cablefmu.coupling.description import shipped_couplings
from cablefmu.scene import shipped_scenes

BIN = Path(sys.executable).parent


def bash(script: str, at: Path) -> subprocess.CompletedProcess[str]:
    environment = {
        **os.environ,
        "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}",
        "HOME": str(at),
        "SHELL": "/bin/bash",
    }
    command = ["bash", "--noprofile", "--norc", "-uo", "pipefail", "-c", script]
    return subprocess.run(command, cwd=at, env=environment, capture_output=True, text=True, timeout=120, check=False)


def press_tab(lines: list[str], at: Path) -> list[list[str]]:
    """What bash offers at the end of each command line, the word to be completed being the last."""
    (at / "completion.bash").write_text(app.generate_completion(shell="bash"))
    asked = "\n".join(
        f"COMP_WORDS=({line.removesuffix(' ')}{' ' + chr(34) * 2 if line.endswith(' ') else ''}); "
        'COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMPREPLY=(); _cablefmu; echo "${COMPREPLY[@]-}"'
        for line in lines
    )
    done = bash(f"source completion.bash\n{asked}", at)
    assert done.stderr == ""
    return [line.split() for line in done.stdout.splitlines()]


def test_commands_options_and_choices(tmp_path: Path) -> None:
    commands, options, choices, fmi = press_tab(
        ["cablefmu ", "cablefmu run --st", "cablefmu couple --engine ", "cablefmu build --fmi "], tmp_path
    )
    assert {"run", "build", "scenes", "doctor", "couple"} <= set(commands)
    assert set(options) == {"--step", "--stop-time"}
    assert set(choices) == {"own", "libcosim", "fmpy-ssp"}
    assert set(fmi) == {"2", "3"}


def test_names_and_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("free-mine.toml", "free.fmu", "free.csv", "moored.toml"):
        (tmp_path / name).write_text("")
    monkeypatch.chdir(tmp_path)

    def asked(*words: str) -> list[str]:
        with pytest.raises(SystemExit, match="0"):
            main(["__complete", *words])
        return [
            line.partition("\t")[0]
            for line in capsys.readouterr().out.splitlines()
            if line.strip() and line[0] != "\x1f"
        ]

    (run,) = press_tab(["cablefmu run free"], tmp_path)  # by bash, which calls the program
    scenes, couple = asked("scenes", "free"), asked("couple", "moored")
    shipped = [name for name in shipped_scenes() if name.startswith("free")]
    assert len(shipped) == 4
    assert sorted(scenes) == sorted(shipped)
    assert sorted(run) == sorted([*shipped, "free-mine.toml", "free.fmu"])
    assert sorted(couple) == sorted([n for n in shipped_couplings() if n.startswith("moored")] + ["moored.toml"])


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("", ["a.toml", "b.fmu", "sub/"]),
        ("a", ["a.toml"]),
        ("sub/", ["sub/c.toml"]),
        ("./sub/c", ["./sub/c.toml"]),
        (".h", [".hidden.toml"]),
        ("nowhere/", []),
        ("x", []),
    ],
)
def test_files_by_what_was_typed(
    typed: str, offered: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sub").mkdir()
    for name in ("a.toml", "a.txt", "b.fmu", "sub/c.toml", ".hidden.toml"):
        (tmp_path / name).write_text("")
    monkeypatch.chdir(tmp_path)
    assert files_like(typed, (".toml", ".fmu")) == offered


@pytest.mark.slow
def test_it_installs_itself_for_the_shell_that_it_is_called_from(tmp_path: Path) -> None:
    done = bash("cablefmu --install-completion && source ~/.bashrc && complete -p cablefmu", tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "complete -F _cablefmu cablefmu"
