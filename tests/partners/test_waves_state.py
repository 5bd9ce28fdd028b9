"""Seas under hosts: the same bits for every consumer, states that leave no trace, refusals in words."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy._core import _multiarray_umath as umath

from tests.fmu_helpers import Host
from tests.partners.seas import AIRY, ALL, FENTON, JONSWAP, SHORT, Build, builder, made_by_the_class, values
from tests.partners.vessels import refused


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """build(name=..., **table): folder of that sea's FMU."""
    return builder(tmp_path_factory.mktemp("seas"))


@pytest.fixture(scope="module")
def kinds(build: Build) -> dict[str, Path]:
    return {
        "airy": build(**AIRY, outputs=ALL, ramp=5.0), "fenton": build(**FENTON, outputs=ALL),
        "jonswap": build(**SHORT, outputs=ALL, ramp=5.0),
    }  # fmt: skip


KINDS = ("airy", "fenton", "jonswap")
NAMES = ("elevation", "vx", "vy", "ax", "ay")
TIMES = np.arange(0.0, 40.0, 0.5)


def of_point(number: int) -> list[str]:
    return [f"{name}[{number}]" for name in NAMES]


# --- the same sea ---


def test_every_consumer_has_the_same_bits(build: Build) -> None:
    """Two instances with other steps, other neighbours and other questions, and the Python class by itself."""
    here, there = {"x": 25.0, "y": 4.0}, {"x": -60.0}
    sea = JONSWAP | {"ramp": 15.0}
    first = build(**sea, points=[here, there], outputs=ALL)
    second = build(**sea, points=[{"x": 1.0}, there, here], outputs=ALL)
    expected = values(first, of_point(1), TIMES)
    assert np.array_equal(values(second, of_point(3), TIMES), expected)
    long_steps = values(second, list(reversed(of_point(3))), TIMES[::8])
    assert np.array_equal(long_steps[:, ::-1], expected[::8])
    assert np.array_equal(made_by_the_class(first, of_point(1), TIMES), expected)
    alone = build(**sea, points=[here], outputs=["acceleration"])
    assert np.array_equal(values(alone, ["ax[1]", "ay[1]"], TIMES), expected[:, 3:])


RUN = """
import os, sys
from fmpy import simulate_fmu
from numpy._core import _multiarray_umath as umath
assert not any(umath.__cpu_features__[name] for name in os.environ["NPY_DISABLE_CPU_FEATURES"].split())
rows = simulate_fmu(sys.argv[1], stop_time=20.0, output_interval=0.5, output=sys.argv[2:])
print(" ".join(float(v).hex() for row in rows for v in list(row)[1:]))
"""


def test_processors_do_not_change_a_bit(build: Build) -> None:
    """In other processes, one of which has numpy use none of this machine's faster instructions."""
    folder = build(**JONSWAP, outputs=ALL)
    times = np.arange(0.0, 20.5, 0.5)
    expected = [value.hex() for value in values(folder, of_point(1), times).ravel().tolist()]
    features = [name for name in umath.__cpu_dispatch__ if umath.__cpu_features__[name]]
    for disabled in ("", " ".join(features)):
        environment = os.environ | {"NPY_DISABLE_CPU_FEATURES": disabled}
        command = [sys.executable, "-c", RUN, str(folder), *of_point(1)]
        ran = subprocess.run(command, capture_output=True, text=True, env=environment)
        assert ran.returncode == 0, ran.stderr
        assert ran.stdout.split() == expected


# --- state ---


@pytest.mark.parametrize("kind", KINDS)
def test_a_step_repeated_a_hundred_times_leaves_no_trace(kind: str, kinds: dict[str, Path]) -> None:
    def go_on(host: Host) -> list[list[float]]:
        rows = []
        for k in range(4, 10):
            host.step(k * 0.7, 0.7)
            rows.append(host.get(*of_point(1)))
        return rows

    with Host(kinds[kind]) as once, Host(kinds[kind]) as often:
        for host in (once, often):
            host.initialize()
            for k in range(4):
                host.step(k * 0.7, 0.7)
        taken = often.take()
        before = often.image_of(taken)
        for trial in range(100):
            often.step(2.8, 0.1 + 0.01 * trial)
            often.get(*of_point(1))
            often.put(taken)
        assert often.save() == before
        often.free(taken)
        assert go_on(often) == go_on(once)


@pytest.mark.parametrize("kind", KINDS)
def test_serialized_state_goes_on_in_another_instance_with_the_same_bits(kind: str, kinds: dict[str, Path]) -> None:
    """Parameters that were set are part of it."""
    with Host(kinds[kind]) as first, Host(kinds[kind]) as second:
        name = "seed" if kind == "jonswap" else "phase"
        second.get(*of_point(1))  # so that it has worked out what its own parameters say
        first.initialize(**{name: 2.0})
        first.step(0.0, 3.1)
        image = first.save()
        second.load(image)
        assert second.save() == image and second.get(name) == [2.0]
        for host in (first, second):
            host.step(3.1, 0.2)
        assert first.get(*of_point(1)) == second.get(*of_point(1))


def test_a_state_that_is_damaged_or_of_another_sea_is_refused(kinds: dict[str, Path]) -> None:
    with Host(kinds["airy"]) as host:
        image = host.initialize().save()
    for place in (3, len(image) // 2, len(image) - 2):
        damaged = bytearray(image)
        damaged[place] ^= 1
        with Host(kinds["airy"]) as host:
            refused(host, "the state is damaged, or none of a sea", host.load, bytes(damaged))
    with Host(kinds["airy"]) as host:
        refused(host, "the state is damaged, or none of a sea", host.load, b"")
    with Host(kinds["fenton"]) as host:
        refused(host, "the state is of another sea", host.load, image)


# --- refusals ---


MISTAKES: dict[str, tuple[Callable[[Host], object], str]] = {
    "too late": (lambda host: host.set(ramp=1.0), "ramp = 1.0 at t = 0.3 s: parameters are fixed once initialization"),
    "output": (
        lambda host: host.set_all({"ax[1]": 1.0}), "ax[1] = 1.0 at t = 0.3 s: it is calculated and cannot be set"
    ),
    "no step": (lambda host: host.step(0.3, 0.0), "doStep at t = 0.3 s: communication step 0.0 s; a number above 0"),
    "NaN step": (lambda host: host.step(0.3, float("nan")), "communication step nan s; a number above 0"),
    "NaN point": (lambda host: host.step(float("nan"), 0.1), "communication point nan s is not where the last step"),
    "elsewhere": (lambda host: host.step(0.4, 0.1), "communication point 0.4 s is not where the last step ended"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_are_refused_in_words(mistake: str, kinds: dict[str, Path], capfd: pytest.CaptureFixture[str]) -> None:
    make, says = MISTAKES[mistake]
    with Host(kinds["airy"]) as host:
        host.initialize()
        host.step(0.0, 0.3)
        refused(host, says, make, host)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("kind", "name", "value", "says"),
    [
        ("jonswap", "seed", 1.5, "a whole number is expected"), ("jonswap", "seed", -1.0, "a number from 0 to"),
        ("jonswap", "seed", 2.0**53, "a number from 0 to 9.00719925e+15"), ("jonswap", "ramp", -1.0, "from 0 to 1e+15"),
        ("jonswap", "significant_height", 18.0, "a number from 0 to 17.7"), ("airy", "ramp", np.nan, "a number from 0"),
        ("airy", "height", 9.4, "a number from 0 to 8.18"), ("airy", "phase", 7.0, "a number from -6.28318531 to"),
        ("fenton", "phase", np.inf, "a number from -6.28"),
    ],
)  # fmt: skip
def test_parameters_without_sense_are_refused(
    kind: str, name: str, value: float, says: str, kinds: dict[str, Path]
) -> None:
    with Host(kinds[kind]) as host:
        refused(host, f"{name} = {value} at t = 0 s: ", host.set_all, {name: value})
        assert says in host.messages[-1]


def test_a_step_past_the_stop_time_is_refused(kinds: dict[str, Path]) -> None:
    with Host(kinds["airy"]) as host:
        host.fmu.setupExperiment(startTime=0.0, stopTime=0.5)
        host.fmu.enterInitializationMode()
        host.fmu.exitInitializationMode()
        host.step(0.0, 0.5)
        refused(host, "communication step 0.1 s leads past the stop time, 0.5 s", host.step, 0.5, 0.1)


def test_a_sea_of_no_height_is_flat(kinds: dict[str, Path]) -> None:
    assert not values(kinds["jonswap"], of_point(1), TIMES, significant_height=0.0).any()
    assert json.loads((kinds["jonswap"] / "resources" / "waves.json").read_text())["height"] == "significant_height"
