"""Seas as tables: units, kinds, and all mistakes at once."""

from __future__ import annotations

import sys
import tomllib

import numpy as np
import pytest

from cablefmu import OptionError, Waves, WavesError
from cablefmu.errors import UserError
from cablefmu.waves import AiryTable, JonswapTable

AIRY = {"kind": "airy", "height": 2.0, "period": 8.0}
SEA = {"kind": "jonswap", "significant_height": 3.0, "peak_period": 9.0}


def test_a_sea_in_units() -> None:
    made = Waves.from_table(
        tomllib.loads("""
        kind = "jonswap"
        significant_height = "250 cm"
        peak_period = "8 s"
        gamma = 2
        seed = 12
        duration = "1 h"
        depth = "0.12 km"
        direction = "180 deg"
        ramp = "1 min"
        points = [{ x = "10 m", y = 2 }, {}]
        outputs = ["acceleration", "elevation"]
        """),
        name="storm",
    )
    table = made.table
    assert made.name == "storm" and isinstance(table, JonswapTable)
    assert (table.significant_height, table.peak_period, table.gamma, table.seed) == (2.5, 8.0, 2.0, 12)
    assert (table.duration, table.depth, table.direction, table.ramp) == (3600.0, 120.0, np.pi, 60.0)
    assert [(point.x, point.y) for point in table.points] == [(10.0, 2.0), (0.0, 0.0)]
    assert table.outputs == ("elevation", "acceleration")


def test_what_a_sea_does_not_say() -> None:
    table = Waves.from_table(SEA).table
    assert isinstance(table, JonswapTable)
    assert (table.gamma, table.seed, table.duration, table.outputs) == (3.3, 1, 10_800.0, ("elevation",))
    assert (table.depth, table.bottom, table.ramp, table.gravity) == (None, np.inf, 0.0, 9.81)


def test_period_frequency_and_length_are_three_ways_to_say_one_thing() -> None:
    by_period = Waves.from_table(AIRY | {"depth": 20.0})
    length = 2.0 * np.pi / by_period.train.k[0]
    for given in ({"frequency": 0.125}, {"length": length}):
        train = Waves.from_table({"kind": "airy", "height": 2.0, "depth": 20.0} | given).train
        assert train.period == pytest.approx(8.0, rel=1e-14)
        assert train.k[0] == pytest.approx(by_period.train.k[0], rel=1e-14)
    assert isinstance(by_period.table, AiryTable) and by_period.table.phase == 0.0


EVERY = "airy, stokes, fenton, jonswap, pierson-moskowitz"

MISTAKES: dict[str, tuple[object, list[str]]] = {
    "no table": ([1], ["sea.toml: waves: a table is expected"]),
    "no kind": ({}, [f"sea.toml: waves.kind: this key is missing; allowed: {EVERY}"]),
    "other kind": ({"kind": "johnswap"}, ['sea.toml: waves.kind = "johnswap": the nearest is "jonswap"; allowed: ']),
    "regular": (
        {"kind": "airy", "height": -2, "period": 3, "length": "9 s", "gamma": 1, "direction": "90 deg", "ramp": -1},
        [
            "sea.toml: waves: period and length contradict each other: exactly one of period, frequency, length",
            'sea.toml: waves.direction = "90 deg": waves travel along x: 0 (to the right) or "180 deg" is expected',
            "sea.toml: waves.ramp = -1: a time must be 0 or greater",
            "sea.toml: waves.height = -2: a length must be greater than 0",
            'sea.toml: waves.length = "9 s": a length [m] is expected',
            "sea.toml: waves.gamma = 1: unknown key; ",
        ],
    ),
    "irregular": (
        {"kind": "jonswap", "peak_period": "3 m", "gamma": 0.5, "seed": 1.5, "depth": -3},
        [
            "sea.toml: waves.depth = -3: a length must be greater than 0",
            "sea.toml: waves.significant_height: this key is missing; a length [m] is expected",
            'sea.toml: waves.peak_period = "3 m": a time [s] is expected',
            "sea.toml: waves.seed = 1.5: a whole number from 0 to 9007199254740991 is expected",
            "sea.toml: waves.gamma = 0.5: a peakedness (a plain number) must be from 1 to 10",
        ],
    ),
    "order": (AIRY | {"kind": "stokes", "order": 6}, ["waves.order = 6: a whole number from 1 to 5 is expected"]),
    "order is no truth": (AIRY | {"kind": "fenton", "order": True}, ["waves.order = true: a whole number from 1"]),
    "outputs": (
        AIRY | {"outputs": ["pressure"]},
        ['waves.outputs = ["pressure"]: a list of some of these is expected: elevation, velocity, acceleration'],
    ),
    "no outputs": (AIRY | {"outputs": []}, ["waves.outputs = []: a list of some of these is expected"]),
    "outputs in lists": (AIRY | {"outputs": [["velocity"]]}, ["waves.outputs = "]),
    "no points": (AIRY | {"points": []}, ["waves.points = []: a list with 1 to 100 points is expected"]),
    "points": (AIRY | {"points": [{"x": 1}, {"z": 1}]}, ["waves.points, entry 2.z = 1: unknown key; allowed: x, y"]),
    "below the seabed": (
        AIRY | {"depth": 20, "points": [{"y": 20}, {"y": "21 m"}]},
        ["waves.points, entry 2.y = 21.0: this is below the seabed at 20 m"],
    ),
    "airy breaks": (
        {"kind": "airy", "height": 15, "length": 100},
        ["waves.height = 15.0: waves 100 m long break from 14.2 m on; a lower or a longer one is expected"],
    ),
    "airy breaks in shallow water": (
        {"kind": "airy", "height": 1, "length": 100, "depth": 1},
        ["waves.height = 1.0: waves 100 m long break from 0.89"],
    ),
    "stokes breaks": (
        {"kind": "stokes", "height": 15, "length": 100}, ["waves.height = 15.0: waves 100 m long break from 14.2 m on"]
    ),
    "stokes in shallow water": (
        {"kind": "stokes", "height": 2, "length": 100, "depth": 5},
        ["waves.height = 2.0: Stokes waves of this height and 100 m length are not found; they break from about 4.3"],
    ),
    "fenton breaks": (
        {"kind": "fenton", "height": 20, "period": 7}, ["waves.height = 20.0: Fenton waves of this height and "]
    ),
    "a period of no wave": (
        {"kind": "stokes", "height": 0.5, "period": 100, "depth": 2},
        ["Stokes waves of this height and 442.9 m length are not found; they break from about 1.784 m on, and in water "
         'so shallow kind = "fenton" with a high order finds most'],
    ),
    "fenton in shallow water": (
        {"kind": "fenton", "height": 0.5, "length": 100, "depth": 2, "order": 3},
        ["they break from about 1.775 m on, and in water so shallow a higher order finds more"],
    ),
    "a key that is no text": (AIRY | {1: 2}, ["sea.toml: waves: keys are texts, and 1 is none"]),
    "irregular breaks": (
        SEA | {"significant_height": 20},
        ["waves.significant_height = 20.0: waves 126.5 m long break from 17.96 m on; a lower or a longer one"],
    ),
    "short": (SEA | {"duration": "1 min"}, ["waves.duration = 60.0: 20 to 18181 peak periods of 9 s are expected"]),
    "long": (SEA | {"duration": 1e6}, ["waves.duration = 1000000.0: 20 to 18181 peak periods of 9 s are expected"]),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_all_mistakes_are_said_at_once(mistake: str) -> None:
    table, expected = MISTAKES[mistake]
    with pytest.raises(WavesError) as refused:
        Waves.from_table(table, source="sea.toml: waves")
    lines = str(refused.value).splitlines()
    assert len(lines) == len(expected), lines
    for line, start in zip(lines, expected, strict=True):
        assert start in line
    assert isinstance(refused.value, UserError) and refused.value.exit_status == 2


def test_a_library_that_is_missing_is_told_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    """Linear regular waves need none."""
    monkeypatch.setitem(sys.modules, "raschii", None)
    monkeypatch.setitem(sys.modules, "wavespectra", None)
    with pytest.raises(OptionError, match=r"nonlinear waves need raschii: pip install 'cablefmu\[waves\]'"):
        Waves.from_table(AIRY | {"kind": "fenton"})
    with pytest.raises(OptionError, match=r"irregular seas need wavespectra: pip install 'cablefmu\[waves\]'"):
        Waves.from_table(SEA)
    assert Waves.from_table(AIRY).train.period == 8.0
