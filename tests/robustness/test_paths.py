"""An FMU runs wherever it was unpacked, writes nothing there, and does not care where its host stands."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pytest

from cablefmu import build_fmu, simulate
from tests.conftest import Unpacked
from tests.fmu_helpers import Host, small_scene
from tests.robustness.building import run, scene_words

both = pytest.mark.parametrize("fmi", [2, 3])

AWKWARD = [
    "it's",
    'say "cable"',
    "back\\slash",
    "new\nline",
    "tab\there",
    "-rf",
    "%00%2F%",
    "~",
    "$HOME",
    "ünï 100% 'x' \"y\"",
]


@both
@pytest.mark.parametrize("name", AWKWARD)
def test_quotes_and_what_a_shell_would_take_apart(name: str, fmi: int, unpacked: Unpacked, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(unpacked("load", fmi), tmp_path / name))
    with Host(folder) as moved, Host(unpacked("load", fmi)) as first:
        np.testing.assert_array_equal(moved.initialize().run(0.2), first.initialize().run(0.2))


def snapshot(folder: Path) -> dict[str, tuple[int, int, int]]:
    """Mode, size and time of change of everything in a folder, itself included."""
    found = [folder, *sorted(folder.rglob("*"))]
    return {str(path): (s.st_mode, s.st_size, s.st_mtime_ns) for path in found for s in [path.stat()]}


@both
def test_a_read_only_folder_is_left_as_it_was(fmi: int, unpacked: Unpacked, tmp_path: Path) -> None:
    """Nothing is written even where the system's manager, who may, is the user."""
    folder = Path(shutil.copytree(unpacked("load", fmi), tmp_path / "read only"))
    inside = [folder, *folder.rglob("*")]
    for path in inside:
        path.chmod(0o555 if path.is_dir() else 0o444)
    before = snapshot(folder)
    try:
        with Host(folder) as host, Host(unpacked("load", fmi)) as first:
            np.testing.assert_array_equal(host.initialize().run(0.5), first.initialize().run(0.5))
        assert snapshot(folder) == before
    finally:
        for path in inside:
            path.chmod(0o755)  # for whoever cleans up


@pytest.fixture
def load_words(unpacked: Unpacked) -> list[str]:
    return scene_words(unpacked("load", 3))


def test_the_current_folder_does_not_matter(
    shipped_host: Path, load_words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Elsewhere, or in a folder that was removed under the host's feet."""
    expected = run(shipped_host, "tour", load_words)
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    result = run(shipped_host, "tour", load_words)
    assert (result.returncode, result.stderr, result.stdout) == (0, "", expected.stdout)


def located(words: list[str], location: str) -> list[str]:
    return [location, *words[1:]]


FORMS = {
    "bare": "{path}",
    "bare with a slash": "{path}/",
    "relative": "{relative}",
    "relative with a dot": "./{relative}/",
    "two slashes inside": "{path}//.//",
    "one slash": "file:{quoted}",
    "empty authority": "file:///{quoted_after_slash}",
    "localhost": "file://localhost{quoted}/",
    "not encoded": "file://{path}",
    "everything encoded": "file://{hexadecimal}",
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_in_an_awkward_folder(
    form: str, shipped_host: Path, load_words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both versions of FMI take them all; a sign of percent stands for itself in a bare path."""
    name = "ünï '%s' 50" + ("" if form == "not encoded" else "%25")
    path = str(shutil.copytree(load_words[0], tmp_path / name))
    monkeypatch.chdir(tmp_path)
    quoted = quote(path)
    location = FORMS[form].format(
        path=path, relative=name, quoted=quoted, quoted_after_slash=quoted.removeprefix("/"),
        hexadecimal="".join("/" if byte == 0x2F else f"%{byte:02x}" for byte in os.fsencode(path)),
    )  # fmt: skip
    assert (
        run(shipped_host, "tour", located(load_words, location)).stdout == run(shipped_host, "tour", load_words).stdout
    )


@pytest.mark.parametrize("start", ["/", "/a"])
def test_a_path_longer_than_any_message_is_refused(start: str, shipped_host: Path, load_words: list[str]) -> None:
    """Longer than the system takes, and than a message has room for: cut, and between two characters."""
    result = run(shipped_host, "tour", located(load_words, start + "ü" * 5000))
    assert result.returncode == 1
    assert result.stderr.startswith(f"host: no instance: resource file {start}ü")
    assert result.stderr.endswith("ü\n")
    assert 500 < len(result.stderr.encode()) < 600


def test_from_scene_to_result_in_such_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Build the archive, read-only, in an awkward folder, and run it from another."""
    folder = tmp_path / AWKWARD[-1]
    folder.mkdir()
    scene = small_scene("load")
    archive = build_fmu(scene, folder / 'my "50%" cable\'s.fmu', fmi=2)
    plain = build_fmu(scene, tmp_path / "plain.fmu", fmi=2)
    assert archive.read_bytes() == plain.read_bytes()
    archive.chmod(0o444)
    command = [sys.executable, "-m", "cablefmu", "run", str(archive), "-o", "ö %d.csv"]
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    done = subprocess.run(command, cwd=elsewhere, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    table = np.genfromtxt(elsewhere / "ö %d.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(table["x_c"], simulate(scene).x_c)
