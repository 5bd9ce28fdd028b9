"""The page where people look at it: Debian's Chromium, a window and a phone, no network."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser

from cablefmu.cable import Floats
from cablefmu.view import Motion, write_page
from tests.view.chromium import PHONE, Opened, browser, opened
from tests.view.made import made_motion
from tests.view.test_page import EVIL

pytestmark = pytest.mark.system

ONE = made_motion("calm", links=12, times=101)
"""Ten seconds."""
OTHER = made_motion("rough", links=7, times=40, step=0.15, lag=1.5)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as started:
        yield started


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    write_page([ONE], folder / "one.html")
    write_page([ONE, OTHER], folder / "two.html")
    return folder


@pytest.fixture
def one(chromium: Browser, pages: Path) -> Iterator[Opened]:
    """The page of one run in a window; whatever a test does, nothing is complained of and nothing is fetched."""
    with opened(chromium, pages / "one.html") as found:
        yield found
        assert found.complaints == []
        assert found.asked == [(pages / "one.html").as_uri()]


def check_shape(found: Opened, motion: Motion, row: int, k: int = 0) -> None:
    """What is drawn is that row of the data, to half a step of what the page carries."""
    shape = found.call("shape(given)", k)
    for drawn, rows in ((shape["x"], motion.x), (shape["y"], motion.y)):
        np.testing.assert_allclose(drawn, rows[row], rtol=0.0, atol=0.5001 * np.ptp(rows) / 65535)


def picture(found: Opened) -> Floats:
    """The screen, shape (height, width, 3)."""
    found.settled()
    scale = found.page.evaluate("devicePixelRatio")
    image = Image.open(io.BytesIO(found.page.screenshot())).convert("RGB")
    return np.asarray(image.resize((round(image.width / scale), round(image.height / scale))), dtype=float)


def stands_out(found: Opened, k: int = 0) -> list[bool]:
    """Whether, in the middle of each link, there is a colour of its own and none some 12 pixels beside it.

    Of links that no sign at an end hides.
    """
    screen, nodes = picture(found), np.array(found.pixels_of(k))
    middles, along = 0.5 * (nodes[1:] + nodes[:-1]), np.diff(nodes, axis=0)
    seen = np.min([np.hypot(*(middles - end).T) for end in (nodes[0], nodes[-1])], axis=0) > 24.0
    middles, along = middles[seen], along[seen]
    assert len(middles) > 3
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]

    def colourful(places: Floats) -> Floats:
        across, down = np.rint(places - 0.5).astype(int).T
        return np.ptp(screen[down, across], axis=1)

    on, off = colourful(middles), np.maximum(colourful(middles + 12 * normal), colourful(middles - 12 * normal))
    return list((on > 60.0) & (off < 60.0))


def test_it_opens_at_the_start_standing(one: Opened) -> None:
    assert one.call("shape()")["time"] == 0.0
    assert not one.call("isPlaying()")
    check_shape(one, ONE, 0)
    assert all(stands_out(one))
    assert one.page.inner_text("#value-x_c-0") == f"{ONE.x[0, -1]:.6g}"


def test_it_plays_and_stops_at_a_recorded_moment(one: Opened) -> None:
    one.page.click("#play")
    one.wait("cablefmu.shape().time > 0.55")
    assert one.call("isPlaying()") and one.page.inner_text("#play") == "Pause"
    one.wait("document.getElementById('rate').textContent.endsWith('pictures/s')")
    one.page.click("#play")
    time = one.call("shape()")["time"]
    row = round(time / 0.1)
    assert time == ONE.time[row] and row >= 5
    check_shape(one, ONE, row)
    one.settled()
    assert one.call("shape()")["time"] == time, "it stands"


def test_speed_is_what_it_says(one: Opened) -> None:
    """Time goes on by the clock however fast the machine paints: between two answers as much as lies between them."""
    one.page.select_option("#speed", "2")
    one.page.click("#play")
    one.wait("cablefmu.shape().time > 0")
    now = "() => [performance.now() / 1000, cablefmu.shape().time]"
    clock, begun = one.page.evaluate(now)
    one.page.wait_for_timeout(2000)
    later, reached = one.page.evaluate(now)
    assert (reached - begun) / (later - clock) == pytest.approx(2.0, rel=0.2), "to a few pictures"


def test_the_counter_counts_no_more_than_the_screen_shows(one: Opened) -> None:
    """Also of a page that was stopped and started again at once."""
    ticks, rate = one.page.evaluate(
        """async () => {
          let ticks = 0;
          for (let k = 0; k < 5; k++) { cablefmu.play(); cablefmu.pause(); }
          const count = () => { ticks++; requestAnimationFrame(count); };
          cablefmu.play();
          await new Promise((done) => setTimeout(done, 500));
          requestAnimationFrame(count);
          const begun = performance.now();
          await new Promise((done) => setTimeout(done, 1200));
          return [ticks / (performance.now() - begun) * 1000, cablefmu.rate()];
        }"""
    )
    assert 1.0 < rate < 1.3 * ticks + 3.0, "a machine in use is uneven; pictures counted twice would be twice as many"


def test_it_stops_at_the_end_and_starts_again_from_there(one: Opened) -> None:
    one.call("seek(9.8)")
    one.call("play()")
    one.wait("!cablefmu.isPlaying()")
    check_shape(one, ONE, 100)
    assert one.page.inner_text("#clock") == "10.00 s"
    one.page.click("#play")
    one.wait("cablefmu.shape().time > 0 && cablefmu.shape().time < 5")


@pytest.mark.parametrize("row", [17, 64, 100])
def test_scrubbing_shows_the_shape_of_that_time(one: Opened, row: int) -> None:
    one.page.locator("#time").fill(str(row))
    assert one.call("shape()")["time"] == ONE.time[row]
    check_shape(one, ONE, row)
    assert all(stands_out(one))
    for value in ONE.values:
        assert float(one.page.inner_text(f"#value-{value.name}-0")) == pytest.approx(value.values[row], rel=1e-5)
    assert one.page.get_attribute("#time", "aria-valuetext") == f"{ONE.time[row]:.2f} s"


def test_a_drag_of_the_slider_scrubs(one: Opened) -> None:
    box = one.page.locator("#time").bounding_box()
    assert box
    one.page.mouse.move(box["x"] + 8, box["y"] + box["height"] / 2)
    one.page.mouse.down()
    one.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, steps=5)
    one.page.mouse.up()
    assert one.call("shape()")["time"] == pytest.approx(5.0, abs=0.2)


def test_keys(one: Opened) -> None:
    press = one.page.keyboard.press

    def time() -> float:
        return float(one.call("shape()")["time"])

    for key, row in (
        ("ArrowRight", 1), ("ArrowRight", 2), ("Shift+ArrowRight", 12), ("ArrowLeft", 11), ("Shift+ArrowLeft", 1),
        ("End", 100), ("ArrowRight", 100), ("Home", 0), ("ArrowLeft", 0),
    ):  # fmt: skip
        press(key)
        assert time() == ONE.time[row], key
    press("Space")
    assert one.call("isPlaying()")
    press("Space")
    assert not one.call("isPlaying()")
    press("ArrowUp")
    assert one.page.input_value("#speed") == "2"
    press("ArrowDown")
    press("ArrowDown")
    assert one.page.input_value("#speed") == "0.5"
    whole = one.call("view()")
    press("+")
    closer = one.call("view()")
    assert np.ptp(closer["x"]) == pytest.approx(np.ptp(whole["x"]) / 1.25)
    press("-")
    assert one.call("view()")["x"] == pytest.approx(whole["x"])
    press("+")
    press("0")
    assert one.call("view()") == whole
    assert one.page.is_checked("#colours")
    press("t")
    assert not one.page.is_checked("#colours")


def test_a_key_that_presses_a_button_does_no_more(one: Opened) -> None:
    one.page.focus("#play")
    one.page.keyboard.press("Space")
    assert one.call("isPlaying()"), "played once, and not stopped again by the same key"
    one.page.focus("#time")
    one.page.keyboard.press("Home")
    assert one.call("shape()")["time"] == 0.0 and not one.call("isPlaying()")
    one.page.keyboard.press("ArrowRight")
    assert one.call("shape()")["time"] == ONE.time[1], "one step, though the slider knows that key as well"


def scale(found: Opened) -> tuple[float, float]:
    """Metres in a pixel, across and down."""
    view = found.call("view()")
    return (view["x"][1] - view["x"][0]) / view["width"], (view["y"][0] - view["y"][1]) / view["height"]


def test_all_of_the_motion_is_seen_in_its_proportions(one: Opened) -> None:
    view = one.call("view()")
    assert view["x"][0] < ONE.x.min() and ONE.x.max() < view["x"][1]
    assert view["y"][1] < ONE.y.min() and ONE.y.max() < view["y"][0], "y downward"
    across, down = scale(one)
    assert across == pytest.approx(down, rel=1e-9)
    fills = max(np.ptp(ONE.x) / (across * view["width"]), np.ptp(ONE.y) / (down * view["height"]))
    assert 0.85 < fills < 0.95


def test_wheel_and_mouse_zoom_and_move(one: Opened) -> None:
    box = one.page.locator("#plot").bounding_box()
    assert box
    one.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    before, whole = scale(one)[0], one.call("view()")
    one.page.mouse.wheel(0, -300)
    one.settled()
    across, down = scale(one)
    assert across < 0.9 * before and across == pytest.approx(down, rel=1e-6)
    one.page.mouse.wheel(0, 300)
    one.settled()
    seen = one.call("view()")["x"]
    one.page.mouse.down()
    one.page.mouse.move(box["x"] + box["width"] / 2 - 100, box["y"] + box["height"] / 2, steps=4)
    one.page.mouse.up()
    one.settled()
    moved = np.subtract(seen, one.call("view()")["x"]) / scale(one)[0]
    np.testing.assert_allclose(moved, -100.0, atol=1.0)
    assert all(stands_out(one)), "drawn where the axes say"
    one.page.click("#whole")
    assert one.call("view()") == whole


def test_another_size_of_the_window_keeps_proportions(one: Opened) -> None:
    one.page.set_viewport_size({"width": 800, "height": 600})
    one.settled()
    across, down = scale(one)
    assert across == pytest.approx(down, rel=1e-9)
    view = one.call("view()")
    assert view["x"][0] < ONE.x.min() and ONE.y.max() < view["y"][0], "all of it is seen, as before"
    one.page.click("#closer")
    near = scale(one)[0]
    one.page.set_viewport_size({"width": 1100, "height": 700})
    one.settled()
    assert scale(one)[0] == pytest.approx(near, rel=1e-9), "a closer look stays as close"
    assert scale(one)[1] == pytest.approx(near, rel=1e-9)


def test_tension_has_colours_and_without_them_the_run_its_own(one: Opened) -> None:
    def middle() -> Floats:
        nodes = np.array(one.pixels_of())
        across, down = np.rint(0.5 * (nodes[3] + nodes[4]) - 0.5).astype(int)
        return picture(one)[down, across]

    coloured = middle()
    one.page.uncheck("#colours")
    plain = middle()
    np.testing.assert_allclose(plain, [0x0B, 0x6F, 0xB8], atol=25.0)
    assert np.abs(coloured - plain).max() > 50.0
    one.page.check("#colours")
    np.testing.assert_allclose(middle(), coloured, atol=1.0)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark(chromium: Browser, pages: Path, scheme: str) -> None:
    with opened(chromium, pages / "one.html", color_scheme=scheme) as found:
        screen = picture(found)
        assert (screen[5, 5].mean() < 60.0) == (scheme == "dark")
        assert all(stands_out(found))
        label = found.page.evaluate("Bokeh.documents[0].get_model_by_name('plot').left[0].axis_label_text_color")
        style = "getComputedStyle(document.documentElement)"
        assert label == found.page.evaluate(f"{style}.getPropertyValue('--faint').trim()")
        assert found.complaints == []


def test_on_a_phone(chromium: Browser, pages: Path) -> None:
    with opened(chromium, pages / "two.html", **PHONE) as found:
        assert found.page.evaluate("document.documentElement.scrollWidth") <= 390, "nothing to the side"
        stage = found.page.locator(".stage").bounding_box()
        play = found.page.locator("#play").bounding_box()
        assert stage and play and stage["height"] > 350
        assert play["y"] + play["height"] < 844, "the button is seen without scrolling"
        assert play["height"] >= 40, "as large as a finger"
        found.page.tap("#play")
        found.wait("cablefmu.shape().time > 0.2")
        found.page.tap("#play")
        assert not found.call("isPlaying()")
        assert all(stands_out(found))
        assert found.complaints == []


def test_fingers_move_and_pinch(chromium: Browser, pages: Path) -> None:
    with opened(chromium, pages / "one.html", **PHONE) as found:
        box = found.page.locator("#plot").bounding_box()
        assert box
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        touch = found.page.context.new_cdp_session(found.page)

        def fingers(kind: str, *places: tuple[float, float]) -> None:
            points = [{"x": px, "y": py, "id": i} for i, (px, py) in enumerate(places)]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

        seen = found.call("view()")["x"]
        fingers("touchStart", (x, y))
        for k in range(1, 7):
            fingers("touchMove", (x + 10 * k, y))
        fingers("touchEnd")
        found.settled()
        assert np.subtract(seen, found.call("view()")["x"]) / scale(found)[0] == pytest.approx(60.0, abs=15.0)
        before = scale(found)[0]
        fingers("touchStart", (x, y - 30), (x, y + 30))
        for k in range(1, 7):
            fingers("touchMove", (x, y - 30 - 10 * k), (x, y + 30 + 10 * k))
        fingers("touchEnd")
        found.settled()
        across, down = scale(found)
        assert across < 0.8 * before, "closer"
        assert across == pytest.approx(down, rel=1e-6)
        assert found.page.evaluate("visualViewport.scale") == 1.0, "the cable, and not the page"
        assert found.complaints == []


def test_two_runs_each_at_the_same_time(chromium: Browser, pages: Path) -> None:
    """Every 0.1 s to 10 s, every 0.15 s to 5.85 s: between its own moments a run goes straight, and then it stands."""
    with opened(chromium, pages / "two.html") as found:
        for time, row, other in ((0.0, 0, 0), (0.3, 3, 2), (4.5, 45, 30), (8.0, 80, 39)):
            found.call("seek(given)", time)
            check_shape(found, ONE, row)
            check_shape(found, OTHER, other, 1)
        assert found.page.inner_text("#value-x_c-1") == f"{OTHER.x[39, -1]:.6g}"
        found.call("seek(0.15)")
        check_shape(found, OTHER, 1, 1)
        between = found.call("shape(0)")["x"]
        np.testing.assert_allclose(between, 0.5 * (ONE.x[1] + ONE.x[2]), rtol=0.0, atol=np.ptp(ONE.x) / 65535)
        assert all(stands_out(found, 0)) and all(stands_out(found, 1))
        assert not found.page.is_checked("#colours")
        assert found.complaints == []


def test_a_run_that_ended_early_is_shown_to_there(chromium: Browser, tmp_path: Path) -> None:
    write_page([ONE, replace(OTHER, ended_early="the cable broke")], tmp_path / "early.html")
    with opened(chromium, tmp_path / "early.html") as found:
        words = found.page.locator("#ended-1")
        assert words.inner_text() == "rough ended early, at t = 5.85 s: the cable broke"
        reached = "document.getElementById('ended-1').hasAttribute('data-reached')"
        found.call("seek(5)")
        assert not found.page.evaluate(reached)
        found.call("seek(6)")
        assert found.page.evaluate(reached), "it stands out from then on"


def test_words_of_a_file_never_run(chromium: Browser, tmp_path: Path) -> None:
    write_page([replace(ONE, name=EVIL, description=EVIL, source=EVIL, ended_early=EVIL)], tmp_path / "evil.html")
    with opened(chromium, tmp_path / "evil.html") as found:
        assert found.page.evaluate("window.stolen") is None
        assert EVIL in found.page.inner_text("h1")
        assert found.complaints == []
        add = "document.body.append(Object.assign(document.createElement('script'), {text: 'stolen = 3'}))"
        found.page.evaluate(add)
        assert found.page.evaluate("window.stolen") is None, "nor would it from elsewhere"
        assert "Content Security Policy" in found.complaints[0]


def test_a_single_moment_and_no_water(chromium: Browser, tmp_path: Path) -> None:
    """A run that broke down at its start has one row; a straight cable has no width."""
    still = made_motion("still", links=1, times=1, water=False, tensions=False)
    write_page([replace(still, x=np.zeros((1, 2)))], tmp_path / "still.html")
    with opened(chromium, tmp_path / "still.html") as found:
        found.page.keyboard.press("ArrowRight")
        found.page.keyboard.press("Space")
        found.settled()
        assert found.call("shape()") == {"time": 0.0, "x": [0.0, 0.0], "y": pytest.approx(still.y[0].tolist())}
        assert not found.call("isPlaying()")
        assert scale(found)[0] == pytest.approx(scale(found)[1])
        assert found.complaints == []
