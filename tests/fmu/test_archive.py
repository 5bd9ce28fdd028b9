"""The archive: what is in it, the same to the byte each time, valid for every checker, and read back only if ours."""

from __future__ import annotations

import logging
import random
import time
import zipfile
from functools import cache
from pathlib import Path

import pytest
import xmlschema
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.checker import get_checkers
from fmu_manipulation_toolbox.operations import FMU

from cablefmu.errors import FmuError, OptionError, SceneError
from cablefmu.fmu.archive import build_fmu, default_path, open_fmu
from cablefmu.scene import Scene, load_scene, shipped_scenes
from tests.fmu_helpers import KINDS, SCENES, from_equilibrium, small_scene

both = pytest.mark.parametrize("fmi", [2, 3])


schema = cache(xmlschema.XMLSchema)  # the checker would read it anew for every FMU


def second_checker(path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> list[str]:
    """What fmu-manipulation-toolbox, which shares no code with FMPy, has to say."""
    monkeypatch.setattr(xmlschema, "XMLSchema", schema)
    with caplog.at_level(logging.WARNING), FMU(str(path)) as fmu:
        for checker in get_checkers():
            fmu.apply_operation(checker())
    return [record.getMessage() for record in caplog.records]


@both
@pytest.mark.parametrize("name", shipped_scenes())
def test_checkers_find_nothing(
    name: str, fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = build_fmu(name, tmp_path / "x.fmu", fmi=fmi)
    assert validate_fmu(str(path)) == []
    assert second_checker(path, monkeypatch, caplog) == []


@both
@pytest.mark.parametrize("kind", KINDS)
def test_checkers_find_nothing_where_a_run_starts_from_equilibrium(
    kind: str, fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = build_fmu(from_equilibrium(small_scene(kind)), tmp_path / "x.fmu", fmi=fmi)
    assert validate_fmu(str(path)) == []
    assert second_checker(path, monkeypatch, caplog) == []


def test_checkers_see_mistakes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """That they say nothing of ours means something."""
    good = tmp_path / "x.fmu"
    known = rewrite(build_fmu(from_equilibrium(small_scene("load")), good), {b'initial="approx"': b'initial="exact"'},
                    tmp_path)  # fmt: skip
    assert any("InitialUnknowns" in problem for problem in validate_fmu(str(known)))
    path = rewrite(build_fmu(small_scene("load"), good), {b'name="theta[1]"': b'name="theta[2]"'}, tmp_path)
    assert any("theta[2]" in problem for problem in validate_fmu(str(path)))
    assert any("'theta[2]' is used by several" in line for line in second_checker(path, monkeypatch, caplog))


def rewrite(path: Path, changes: dict[bytes, bytes], folder: Path, without: str = "") -> Path:
    """A sound zip archive with other bytes in its description, or without some members."""
    target = folder / "rewritten.fmu"
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(target, "w") as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                for old, new in changes.items():
                    content = content.replace(old, new)
            if not without or without not in name:
                archive.writestr(name, content)
    return target


@both
def test_two_builds_are_the_same_to_the_byte(fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = build_fmu("free-12-water", tmp_path / "a.fmu", fmi=fmi).read_bytes()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    monkeypatch.setattr(time, "time", lambda: 2e9)
    monkeypatch.setenv("TZ", "Asia/Kathmandu")
    assert build_fmu("free-12-water", Path("b.fmu"), fmi=fmi).read_bytes() == first


@both
def test_members(fmi: int, tmp_path: Path) -> None:
    path = build_fmu(small_scene("load-volume"), tmp_path / "x.fmu", fmi=fmi, platforms=["x86_64-linux"])
    platform = "linux64" if fmi == 2 else "x86_64-linux"
    with zipfile.ZipFile(path) as archive:
        assert [name for name in archive.namelist() if not name.startswith("sources/")] == [
            f"binaries/{platform}/load_volume.so",
            "documentation/index.html",
            "documentation/licenses/license.txt",
            *(["model.png"] if fmi == 2 else []),
            "modelDescription.xml",
            "resources/cable.bin",
            "resources/load-volume.toml",
            "terminalsAndIcons/icon.png",
            "terminalsAndIcons/icon.svg",
            "terminalsAndIcons/port.png",
            "terminalsAndIcons/port.svg",
            "terminalsAndIcons/terminalsAndIcons.xml",
        ]
        assert archive.read("resources/load-volume.toml").decode() == SCENES["load-volume"]
        assert b"BSD" in archive.read("documentation/licenses/license.txt")


@both
@pytest.mark.parametrize("kind", SCENES)
def test_the_scene_comes_back(kind: str, fmi: int, tmp_path: Path) -> None:
    archive = open_fmu(build_fmu(small_scene(kind), tmp_path / "x.fmu", fmi=fmi))
    assert archive.fmi == fmi
    assert (archive.scene.name, archive.scene.text) == (kind, SCENES[kind])


def test_files_that_a_scene_names_travel_with_it(tmp_path: Path) -> None:
    scene = tmp_path / "wavy.toml"
    force = '{ signal = "sine", amplitude = 800, frequency = 0.5 }'
    scene.write_text(SCENES["load"].replace(force, '{ signal = "csv", file = "waves/heave.csv" }'))
    (tmp_path / "waves").mkdir()
    (tmp_path / "waves" / "heave.csv").write_text("0,0\n1,50\n2,20\n")
    archive = open_fmu(build_fmu(scene, tmp_path / "wavy.fmu"))
    assert archive.scene.signals["u_m1"](0.5) == 25.0


def test_default_places() -> None:
    scene = load_scene("free-12-air")
    assert default_path(scene, 2) == Path("build/free-12-air.fmu")
    assert default_path(scene, 3) == Path("build/free-12-air-fmi3.fmu")


def test_a_name_that_begins_with_a_digit_still_names_a_binary(tmp_path: Path) -> None:
    path = build_fmu(Scene.from_text(SCENES["air"], name="60-links"), tmp_path / "x.fmu")
    assert "binaries/linux64/cable_60_links.so" in zipfile.ZipFile(path).namelist()
    assert validate_fmu(str(path)) == []


def test_what_cannot_be_built(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="fmi = 1: 2 or 3 is expected"):
        build_fmu("free-12-air", tmp_path / "x.fmu", fmi=1)
    with pytest.raises(SceneError, match='no scene "free" ships'):
        build_fmu("free", tmp_path / "x.fmu")
    with pytest.raises(OptionError, match="is a folder, a file name is expected"):
        build_fmu("free-12-air", tmp_path)
    assert list(tmp_path.iterdir()) == []


# --- reading ---


def test_what_is_no_fmu_of_ours(tmp_path: Path) -> None:
    good = build_fmu(small_scene("load"), tmp_path / "good.fmu")
    text = tmp_path / "text.fmu"
    text.write_text("an FMU it is not")
    empty = tmp_path / "empty.fmu"
    zipfile.ZipFile(empty, "w").close()
    for path, says in (
        (tmp_path / "none.fmu", "none.fmu: there is no such file"),
        (tmp_path, "there is no such file"),
        (text, "text.fmu: is not an FMU"),
        (empty, "empty.fmu: its modelDescription.xml cannot be read"),
    ):
        with pytest.raises(FmuError, match=says):
            open_fmu(path)
    for changes, without, says in (
        ({b'generationTool="cablefmu': b'generationTool="other'}, "", "was not made by cablefmu"),
        ({b'modelName="load"': b'modelName="../load"'}, "", "was not made by cablefmu"),
        ({}, ".toml", "was not made by cablefmu"),
        ({b"</ModelVariables>": b""}, "", "modelDescription.xml cannot be read"),
    ):
        with pytest.raises(FmuError, match=says):
            open_fmu(rewrite(good, changes, tmp_path, without))


@pytest.mark.parametrize("seed", range(60))
def test_a_damaged_archive_is_refused_in_words(seed: int, tmp_path: Path) -> None:
    """Bytes flipped anywhere: an `FmuError`, or an archive whose every member passed its checksum."""
    path = build_fmu(small_scene("load"), tmp_path / "x.fmu")
    content = bytearray(path.read_bytes())
    dice = random.Random(seed)
    # Half of the damage goes where the directory and the small members are.
    for _ in range(dice.randint(1, 5)):
        content[dice.randrange(len(content)) if dice.random() < 0.5 else -dice.randint(1, 2000)] = dice.randrange(256)
    path.write_bytes(content)
    try:
        said = f"{path}: {open_fmu(path).scene.text}"
    except FmuError as error:
        said = str(error)
    assert said.startswith(f"{path}: ")
    assert "is not an FMU" in said or "damaged" in said or said.endswith(SCENES["load"])
