"""The page as a text: self-contained, small, honest about what it carries, and safe whatever a file says."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cablefmu.errors import OptionError
from cablefmu.view import check_page, view_page, write_page
from tests.test_pages import Reader
from tests.view.made import made_motion
from tests.view.test_arrays import counted

EVIL = '</script><script>window.stolen = 1</script><img src=x onerror="window.stolen = 2">'


@pytest.fixture(scope="module")
def page() -> str:
    return view_page([made_motion("mine", end="pin")])


def carried(page: str, name: str) -> Any:
    found = re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found.group(1))


def test_it_carries_the_run(page: str) -> None:
    motion = made_motion("mine")
    (run,) = carried(page, "runs")
    for name, numbers in (("x", motion.x), ("y", motion.y), ("tension", motion.tension)):
        np.testing.assert_allclose(counted(run[name]), numbers, rtol=0.0, atol=0.5001 * np.ptp(numbers) / 65535)
    times = np.frombuffer(base64.b64decode(run["time"]["data"]))
    np.testing.assert_array_equal(times, motion.time)
    values = {v["name"]: np.frombuffer(base64.b64decode(v["values"]["data"])) for v in run["values"]}
    assert [*values] == ["y_m1", "x_c", "y_c", "tension_max"]
    np.testing.assert_array_equal(values["tension_max"], motion.tension.max(axis=1))
    assert (run["top_marker"], run["end_marker"]) == ("square", "triangle")
    extent = carried(page, "extent")
    assert extent["right"] == motion.x.max() and extent["bottom"] == motion.y.max()


def test_numbers_beside_have_names_and_units(page: str) -> None:
    for name, unit in (("y_m1", "m"), ("x_c", "m"), ("tension_max", "N")):
        assert f'{name} <span class="unit">[{unit}]</span>' in page
        assert page.count(f'id="value-{name}-0"') == 1
    assert "■ floater" in page and "▲ anchor" in page and "surface at y = 0" in page
    assert "surface" not in view_page([made_motion(water=False)]).partition("</aside>")[0].partition("<aside")[2]


def test_controls_say_what_they_are(page: str) -> None:
    reader = Reader()
    reader.feed(page)
    controls = [attrs for tag, attrs in reader.tags if tag in ("button", "input", "select")]
    assert {c["id"] for c in controls} == {"play", "time", "speed", "wider", "closer", "whole", "colours"}
    for control in controls:
        labelled = "aria-label" in control or control["id"] in ("play", "whole", "colours")  # these have words
        assert labelled, control
    (stage,) = [attrs for _, attrs in reader.tags if attrs.get("class") == "stage"]
    assert stage["tabindex"] == "0" and stage["aria-label"]


def test_it_fetches_nothing_and_runs_its_own_scripts_alone(page: str) -> None:
    reader = Reader()
    reader.feed(page)
    assert not {"link", "img", "iframe", "object"} & {tag for tag, _ in reader.tags}
    assert not [attrs for _, attrs in reader.tags if "src" in attrs]
    policy = next(attrs["content"] or "" for tag, attrs in reader.tags if tag == "meta" and "http-equiv" in attrs)
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe-eval" not in policy and "http" not in policy
    assert "'unsafe-inline'" not in policy.partition("style-src")[0]
    run = re.findall(r'<script(?: type="module")?>(.*?)</script>', page, re.DOTALL)
    digests = {base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in run}
    assert set(re.findall(r"'sha256-([^']+)'", policy)) == digests and len(digests) == 2


def test_words_from_files_stay_words() -> None:
    evil = replace(made_motion(EVIL), description=EVIL, source=EVIL, ended_early=EVIL)
    text = view_page([evil])
    assert EVIL not in text and "<img" not in text
    assert text.count("<script") == view_page([made_motion()]).count("<script")
    value = replace(evil.values[0], name='"><b>', unit="<i>", text='"><u>')
    odd = view_page([replace(evil, values=(value,))])
    assert not re.search("<(b|i|u)>", re.sub(r"<script.*?</script>", "", odd, flags=re.DOTALL))


def test_the_largest_case_stays_below_three_megabytes() -> None:
    """110 links and 620 frames, with tensions; alone, and with a second run in the same picture."""
    motion = made_motion(links=110, times=620, step=0.025, length=240.0)
    assert len(view_page([motion]).encode()) < 2_000_000
    assert len(view_page([motion, made_motion("other", links=110, times=620, lag=1.0)]).encode()) < 3_000_000


def test_two_runs_have_a_column_each() -> None:
    one, other = made_motion("calm"), made_motion("rough", lag=1.0, tensions=False)
    text = view_page([one, other])
    assert "<h1>calm and rough</h1>" in text
    assert len(carried(text, "runs")) == 2 and carried(text, "runs")[1]["tension"] is None
    assert all(text.count(f'id="value-x_c-{k}"') == 1 for k in (0, 1))
    assert re.search(r'id="colours">', text), "runs are told apart by colour until tensions are asked for"
    assert re.search(r'id="colours" checked>', view_page([one]))
    with pytest.raises(OptionError, match="not 3"):
        view_page([one, other, one])
    with pytest.raises(OptionError, match="not 0"):
        view_page([])


def test_without_tensions_there_is_nothing_to_switch() -> None:
    assert 'id="colours"' not in view_page([made_motion(tensions=False)]).partition("<script")[0]


def test_a_run_that_ended_early_says_so() -> None:
    text = view_page([replace(made_motion("mine"), ended_early="the cable broke")])
    assert "mine ended early, at t = 2 s: the cable broke</p>" in text
    assert 'class="ended"' not in view_page([made_motion()]).partition("<script")[0]


def test_the_file_is_the_page(tmp_path: Path, page: str) -> None:
    write_page([made_motion("mine", end="pin")], tmp_path / "new" / "x.html")
    written = (tmp_path / "new" / "x.html").read_text(encoding="utf-8")
    assert written.startswith("<!DOCTYPE html>") and carried(written, "runs") == carried(page, "runs")


def test_places_that_cannot_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "dir.html").mkdir()
    with pytest.raises(OptionError, match="is a folder"):
        check_page(tmp_path / "dir.html")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(OptionError, match=r"cablefmu\[view\]"):
        check_page(tmp_path / "x.html")
