"""A movie has the pictures that it should, of the moments that it should."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from cablefmu.errors import OptionError
from cablefmu.view.movie import MOVIES, Picture, along, check_movie, movie_times, write_movie
from tests.view.made import made_motion

SIZE = (640, 560)


def test_a_gif_has_a_picture_for_every_moment(tmp_path: Path) -> None:
    write_movie([made_motion(times=6)], tmp_path / "x.gif", speed=1.0)
    with Image.open(tmp_path / "x.gif") as movie:
        assert (movie.n_frames, movie.size) == (11, SIZE), "0.5 s, 20 in a second, both ends"
        durations, pictures = [], []
        for k in range(movie.n_frames):
            movie.seek(k)
            durations.append(movie.info["duration"])
            pictures.append(np.asarray(movie.convert("RGB"), dtype=float))
    assert set(durations) == {50}
    assert all(np.abs(b - a).max() > 100.0 for a, b in pairwise(pictures)), "it moves"
    assert list(tmp_path.iterdir()) == [tmp_path / "x.gif"], "and leaves nothing else"


def test_an_mp4_has_as_many(tmp_path: Path) -> None:
    motions = [made_motion("calm", times=6), made_motion("rough", times=4, lag=1.0)]
    write_movie(motions, tmp_path / "x.mp4", speed=0.5)
    decode = ["-i", str(tmp_path / "x.mp4"), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    decoded = subprocess.run([imageio_ffmpeg.get_ffmpeg_exe(), *decode], capture_output=True, check=True)
    assert re.search(rb"Video: h264 .*yuv420p.* 640x560.* 20 fps", decoded.stderr)
    pictures = np.frombuffer(decoded.stdout, dtype=np.uint8).reshape(-1, SIZE[1], SIZE[0], 3).astype(float)
    assert len(pictures) == 21
    assert np.abs(np.diff(pictures, axis=0)).max(axis=(1, 2, 3)).min() > 30.0, "it moves"


def test_moments_are_even_and_end_with_the_longest_run() -> None:
    motions = [made_motion(times=6), made_motion(times=8)]
    times = movie_times(motions, 2.0)
    np.testing.assert_allclose(np.diff(times)[:-1], 0.1)
    assert times[0] == 0.0 and times[-1] == motions[1].time[-1] == pytest.approx(0.7)


def test_the_picture_is_of_its_moment() -> None:
    motion = made_motion("mine", times=6)
    picture = Picture([motion])
    picture.show(0.2)
    (cable,), ((top, end),) = picture.cables, picture.ends
    nodes = np.vstack([cable.get_segments()[0][:1], [segment[1] for segment in cable.get_segments()]])
    np.testing.assert_allclose(nodes, np.column_stack([motion.x[2], motion.y[2]]), rtol=1e-12, atol=1e-12)
    assert motion.tension is not None
    np.testing.assert_allclose(cable.get_array(), motion.tension[2])
    assert top.get_xydata().tolist() == [pytest.approx([motion.x[2, 0], motion.y[2, 0]])]
    assert end.get_xydata().tolist() == [pytest.approx([motion.x[2, -1], motion.y[2, -1]])]
    assert (top.get_marker(), end.get_marker()) == ("s", "o")
    axes, colours = picture.figure.axes
    assert axes.get_title() == "mine: t = 0.20 s" and colours.get_ylabel() == "tension [N]"
    assert axes.get_xlabel() == "x [m], to the right" and axes.get_ylabel() == "y [m], down"
    assert axes.yaxis_inverted() and axes.get_aspect() == 1.0
    picture.show(0.25)
    between = [motion.x[2:4, 1].mean(), motion.y[2:4, 1].mean()]
    np.testing.assert_allclose(cable.get_segments()[0][1], between)


def test_two_runs_are_told_apart_by_colour_and_name() -> None:
    motions = [made_motion("calm"), made_motion("rough", lag=1.0, water=False)]
    (axes,) = Picture(motions).figure.axes
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["calm", "rough"]
    colors = {tuple(line.get_color()[0]) for line in axes.collections if len(line.get_color())}
    assert len(colors) == 2


@pytest.mark.parametrize("water", [True, False])
def test_the_surface_is_drawn_in_water_alone(water: bool) -> None:
    axes = Picture([made_motion(water=water, tensions=False)]).axes
    surfaces = [line for line in axes.lines if len(line.get_ydata()) == 2 and not np.any(line.get_ydata())]
    assert len(surfaces) == len(axes.patches) == int(water)


def test_a_run_that_is_over_stands_still_and_says_why() -> None:
    motion = replace(made_motion("mine", times=6), ended_early="the cable broke")
    picture = Picture([motion, made_motion(times=20)])
    picture.show(0.4)
    assert picture.axes.get_title() == "mine and made: t = 0.40 s"
    picture.show(1.5)
    assert picture.axes.get_title() == "mine and made: t = 1.50 s\nmine ended early, at t = 0.5 s"
    np.testing.assert_allclose(picture.cables[0].get_segments()[-1][1], [motion.x[-1, -1], motion.y[-1, -1]])


def test_between_two_moments_it_goes_straight() -> None:
    time, rows = np.array([1.0, 2.0, 4.0]), np.array([[0.0, 1.0], [2.0, 5.0], [6.0, 1.0]])
    expected = {0.0: [0, 1], 1.0: [0, 1], 1.5: [1, 3], 2.0: [2, 5], 3.0: [4, 3], 4.0: [6, 1], 9.0: [6, 1]}
    for t, row in expected.items():
        np.testing.assert_array_equal(along(time, rows, t), row)
    np.testing.assert_array_equal(along(time[:1], rows[:1], 5.0), [0.0, 1.0])


@pytest.mark.parametrize(
    ("speed", "message"),
    [(0.0, "positive"), (-1.0, "positive"), (float("nan"), "positive"), (0.01, r"4001 pictures.*3000.*0\.013 or more")],
)
def test_speeds_that_cannot_be(speed: float, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        movie_times([made_motion()], speed)


def test_what_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "dir.gif").mkdir()
    with pytest.raises(OptionError, match="is a folder"):
        check_movie(tmp_path / "dir.gif")
    present = {"matplotlib"}
    monkeypatch.setattr("importlib.util.find_spec", lambda name: name if name in present else None)
    with pytest.raises(OptionError, match=r"cablefmu\[movie\]"):
        check_movie(tmp_path / "x.mp4")
    check_movie(tmp_path / "x.gif")
    present.clear()
    for suffix in MOVIES:
        with pytest.raises(OptionError, match=r"cablefmu\[plot\]"):
            check_movie(tmp_path / f"x{suffix}")
