"""documentation/index.html: valid, self-contained, complete, and true of the FMU that it is in."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree as ET

import html5lib
import numpy as np
import pytest
from fmpy import read_model_description

from cablefmu import scene_schema
from cablefmu.fmu.archive import build_fmu, default_path
from cablefmu.fmu.documentation import DOCUMENTATION, documentation
from cablefmu.fmu.listing import number
from cablefmu.fmu.variables import ENUMERATIONS, variables_of
from cablefmu.scene import Scene, load_scene, shipped_scenes
from tests.fmu_helpers import KINDS, SCENES, from_equilibrium, small_scene

both = pytest.mark.parametrize("fmi", [2, 3])
_TEXT = "{http://www.w3.org/1999/xhtml}"


@dataclass
class Page:
    """An archive's page, parsed; the parser refuses what HTML 5 does not allow."""

    path: Path

    @cached_property
    def text(self) -> str:
        with zipfile.ZipFile(self.path) as archive:
            return archive.read(DOCUMENTATION).decode()

    @cached_property
    def root(self) -> ET.Element:
        parsed: ET.Element = html5lib.HTMLParser(strict=True).parse(self.text)
        return parsed

    def all(self, tag: str) -> list[ET.Element]:
        return list(self.root.iter(_TEXT + tag))

    def words(self, *titles: str) -> str:
        """What sections say, by their headings."""
        found = [s for s in self.all("section") if "".join(s[0].itertext()) in titles]
        assert len(found) == len(titles)
        return "\n".join("".join(section.itertext()) for section in found)

    def listed(self) -> dict[str, tuple[str, str, str]]:
        """Variable -> causality, unit, value; every one of a row for all links. None twice."""
        found: dict[str, tuple[str, str, str]] = {}
        (section,) = [s for s in self.all("section") if s.get("id") == "variables"]
        causality = ""
        for element in section:
            said = "".join(element.itertext())
            if element.tag == _TEXT + "p" and said.startswith("Causality"):
                causality = re.split(r"[ .]", said)[1]
            if element.tag != _TEXT + "table":
                continue
            columns = ["".join(cell.itertext()) for cell in element.iter(_TEXT + "th")]
            for row in list(element.iter(_TEXT + "tr"))[1:]:
                cells = ["".join(cell.itertext()) for cell in row.iter(_TEXT + "td")]
                value = cells[2] if "Value" in columns else ""
                for name in expanded(cells[0]):
                    assert name not in found
                    found[name] = causality, cells[1], value
        return found


def expanded(names: str) -> list[str]:
    """All of "theta[1] … theta[5]"."""
    first, _, last = names.partition(" … ")
    if not last:
        return [first]
    low, high = (int(re.findall(r"\[(\d+)\]", name)[0]) for name in (first, last))
    return [first.replace(f"[{low}]", f"[{k}]") for k in range(low, high + 1)]


def page_of(scene: Scene, folder: Path, fmi: int, *, arrays: bool = False) -> Page:
    path = folder / default_path(scene, fmi, arrays=arrays).name
    return Page(build_fmu(scene, path, fmi=fmi, arrays=arrays))


Pages = Callable[[str, int], Page]


@pytest.fixture(scope="module")
def shipped(tmp_path_factory: pytest.TempPathFactory) -> Pages:
    """shipped(name, fmi): the page of a shipped scene, parsed once."""
    folder = tmp_path_factory.mktemp("pages")
    return cache(lambda name, fmi: page_of(load_scene(name), folder, fmi))


@both
@pytest.mark.parametrize("name", shipped_scenes())
def test_every_shipped_scene_has_a_valid_page_that_needs_nothing_else(name: str, fmi: int, shipped: Pages) -> None:
    page = shipped(name, fmi)
    assert [element for tag in ("script", "link", "img", "iframe", "object") for element in page.all(tag)] == []
    assert re.findall(r"https?:|@import|url\(|\bsrc=", page.text) == []
    assert re.findall(r"\b(nan|inf|none)\b", page.text.partition("</style>")[2], re.IGNORECASE) == []
    identifiers = [element.get("id") for element in page.root.iter() if element.get("id")]
    assert len(set(identifiers)) == len(identifiers)
    with zipfile.ZipFile(page.path) as archive:
        members = set(archive.namelist())
    targets = [str(anchor.get("href")) for anchor in page.all("a")]
    assert "licenses/license.txt" in targets
    for target in targets:
        if target.startswith("#"):
            assert target[1:] in identifiers
        else:
            beside = PurePosixPath("documentation")
            assert str(beside.parent / target[3:] if target.startswith("../") else beside / target) in members


@both
@pytest.mark.parametrize("name", shipped_scenes())
def test_every_variable_is_listed_once_with_what_the_description_says(name: str, fmi: int, shipped: Pages) -> None:
    assert_variables_are_listed(shipped(name, fmi))


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_are_listed_and_explained(kind: str, tmp_path: Path) -> None:
    page = page_of(small_scene(kind), tmp_path, 3, arrays=True)
    assert_variables_are_listed(page)
    assert page.listed()["n"] == ("structuralParameter", "–", "5")
    assert f'"{kind}-fmi3-arrays.fmu"' in page.words("How to run it")
    assert "is EI over li" in page.words("Equations")
    assert "k_joint" not in page.text
    follows = kind not in ("air", "load", "load-volume", "moved", "between")
    assert ("static_load is worked out at the start" in page.words("Limits")) == follows
    assert "The number of links n is 1 to 10,000" in page.words("Limits")


def assert_variables_are_listed(page: Page) -> None:
    described = {v.name: v for v in read_model_description(str(page.path)).modelVariables}
    listed = page.listed()
    assert set(listed) == set(described)
    for variable, (causality, unit, value) in listed.items():
        expected = described[variable]
        assert causality == expected.causality
        plain = {" ": ".", "²": "2", "³": "3"}
        assert "".join(plain.get(letter, letter) for letter in unit).replace("–", "1") == (expected.unit or "1")
        if expected.start is None:
            assert value == ""
        elif expected.type == "Enumeration":
            assert ENUMERATIONS[variable].value_of(value) == int(expected.start)
        elif "…" not in value:
            assert value == number(float(expected.start))


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_scene_does_not_have_is_not_mentioned(kind: str, tmp_path: Path) -> None:
    page = page_of(small_scene(kind), tmp_path, 2)
    said = page.words("The scene", "Equations", "Limits").lower()
    mentions = {
        "water": kind != "air", "drag": kind != "air", "submerged": kind != "air", "ρ": kind != "air",
        "load's": kind in ("air", "load", "load-volume", "moved"), "anchor": kind.startswith("anchor"),
        "pin": kind in ("pin", "surge"), "floater 2": kind == "floater", "equilibrium": False,
        "springs": kind in ("anchor-spring", "floater", "surge"), "vessel": kind in ("moved", "between"),
        "floater 1": kind not in ("moved", "between"), "surges": kind == "surge",
        "static_load": kind not in ("moved", "between"), "static_pull is": kind == "surge",
    }  # fmt: skip
    assert {word: bool(re.search(rf"(?<![a-z]){word}", said)) for word in mentions} == mentions


@pytest.mark.parametrize("kind", KINDS)
def test_a_start_from_equilibrium_is_told(kind: str, tmp_path: Path) -> None:
    page = page_of(from_equilibrium(small_scene(kind)), tmp_path, 3)
    assert "near which the equilibrium is sought" in page.words("The scene")
    assert "starts from the stable equilibrium" in page.words("Solver")
    assert {"statics.residual", "statics.iterations"} < set(page.listed())


@both
@pytest.mark.parametrize("kind", KINDS)
def test_the_example_runs(
    kind: str, fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = page_of(small_scene(kind), tmp_path, fmi)
    (code,) = [element for element in page.all("code") if element.get("class") == "language-python"]
    monkeypatch.chdir(tmp_path)
    done: dict[str, object] = {}
    exec(compile("".join(code.itertext()), "example", "exec"), done)
    result = done["result"]
    assert isinstance(result, np.ndarray)
    outputs = [name for name in read_names(page.path) if name in scene_schema.OUTPUTS][:4]
    assert result.dtype.names == ("time", *outputs)
    assert result["time"][-1] == 2.0
    if "y_m1" in outputs:  # 1 kN on 600 kg
        assert np.max(result["y_m1"]) > 0.1
    elif kind == "between":  # the other end rests, but for the step's second order
        np.testing.assert_allclose(result["y_c"], 12.9, rtol=0, atol=1e-3)
    else:
        assert np.ptp(result["x_c"]) > 0.1
    assert outputs[0] in capsys.readouterr().out


def read_names(path: Path) -> list[str]:
    return [variable.name for variable in read_model_description(str(path)).modelVariables]


def test_signals_of_the_scene_are_told(tmp_path: Path) -> None:
    force = '{ signal = "sine", amplitude = 800, frequency = 0.5 }'
    for signal, words in (
        (force, "u_m1: 800 N · sin(2π · 0.5 Hz · t)"),
        ("-250", "u_m1: −250 N"),
        ('{ signal = "steps", times = [0, 1.5], values = [-2000, 0] }', "u_m1: −2000 N from 0 s, 0 N from 1.5 s"),
        ('{ signal = "csv", file = "x.csv" }', "u_m1: 3 samples from 0 s to 2 s, linear between"),
        ("0", None),
    ):
        text = SCENES["load"].replace(force, signal)
        files = {"x.csv": b"0,0\n1,50\n2,20\n"} if "csv" in signal else None
        said = page_of(Scene.from_text(text, name="x", files=files), tmp_path, 2).words("How to run it")
        assert (words in said) if words else ("u_m1:" not in said)


def test_a_thousand_links_take_no_more_room_than_five() -> None:
    scene = small_scene("load")
    cable = scene.cable
    links = replace(cable.links, **{name: np.full(1000, getattr(cable.links, name)[0]) for name in _PER_LINK})
    many = replace(cable, links=links, position=np.zeros(1001), velocity=np.zeros(1001))
    pages = [
        documentation(replace(scene, cable=one), variables_of(one), fmi=3, file="x.fmu") for one in (cable, many)
    ]  # fmt: skip
    assert len(pages[1]) < len(pages[0]) + 10_000
    assert b"<code>theta[1]</code> \xe2\x80\xa6 <code>theta[1000]</code>" in pages[1]


_PER_LINK = ("length", "mass", "inertia", "volume", "joint_stiffness", "joint_damping", "drag_area", "drag")


def test_texts_of_the_user_are_escaped(tmp_path: Path) -> None:
    text = SCENES["air"].replace("Five links, small and quick", "A < B & <script>alert(1)</script>")
    page = page_of(Scene.from_text(text, name="x"), tmp_path, 2)
    assert page.all("script") == []
    assert "A < B & <script>alert(1)</script>." in "".join(page.root.itertext())


def test_the_checker_sees_mistakes() -> None:
    """That it says nothing of ours means something."""
    with pytest.raises(html5lib.html5parser.ParseError):
        html5lib.HTMLParser(strict=True).parse("<!DOCTYPE html><html><head><title>x</title></head><body><p></b></body>")
