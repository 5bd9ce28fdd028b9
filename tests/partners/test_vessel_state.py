"""Vessels under hosts: states that leave no trace, refusals in words, several of them in one process."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException

from tests.fmu_helpers import Host
from tests.partners.vessels import BODY, SINES, Build, builder, refused, write_csv


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """build(name=..., **table): folder of that vessel's FMU."""
    return builder(tmp_path_factory.mktemp("vessels"))


# --- state ---


@pytest.fixture(scope="module")
def kinds(build: Build, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One vessel of every kind, the body with all ways to go on within a step."""
    times = np.arange(41) * 0.25
    file = write_csv(tmp_path_factory.mktemp("csv") / "m.csv", times, np.sin(times), np.cos(times))
    bodies = {f"body-{e}": build(**BODY, extrapolation=e, name=f"body-{e}") for e in (0, 1, 2, "given")}
    waves = {
        f"{kind}-{e}": build(kind=kind, body="buoy", extrapolation=e, name=f"{kind}-{e}")
        for kind, e in (("floating", 2), ("excitation", "given"))
    }
    return {"sines": build(**SINES), "csv": build(kind="csv", file=file), **bodies, **waves}


WAVES = ("floating-2", "excitation-given")
KINDS = ("sines", "csv", "body-0", "body-1", "body-2", "body-given", *WAVES)


def pull(host: Host, t: float) -> None:
    """A value for whatever inputs there are."""
    host.set_all({name: 1.0e4 * np.sin(3.0 * t + k) for k, name in enumerate(host.names("input"))})


def bits(host: Host) -> bytes:
    return np.array(host.get(*host.reference)).tobytes()


@pytest.mark.parametrize("kind", KINDS)
def test_a_step_repeated_a_hundred_times_leaves_no_trace(kind: str, kinds: dict[str, Path]) -> None:
    def start(host: Host) -> None:
        host.initialize()
        for k in range(4):
            pull(host, k * 0.1)
            host.step(k * 0.1, 0.1)

    def finish(host: Host) -> list[bytes]:
        rows = []
        for k in range(4, 10):
            pull(host, k * 0.1)
            host.step(k * 0.1, 0.1)
            rows.append(bits(host))
        return rows

    with Host(kinds[kind]) as once, Host(kinds[kind]) as often:
        start(once)
        start(often)
        taken = often.take()
        before = often.image_of(taken)
        for trial in range(100):
            pull(often, 7.0 * trial)  # other forces, other step sizes, more steps than one
            often.step(0.4, 0.1 + 0.001 * trial)
            often.step(0.5 + 0.001 * trial, 0.05)
            often.put(taken)
        assert often.save() == before
        often.free(taken)
        assert finish(often) == finish(once)


@pytest.mark.parametrize("kind", KINDS)
def test_serialized_state_goes_on_in_another_instance_with_the_same_bits(kind: str, kinds: dict[str, Path]) -> None:
    with Host(kinds[kind]) as first, Host(kinds[kind]) as second:
        first.initialize()
        for k in range(3):
            pull(first, k * 0.1)
            first.step(k * 0.1, 0.1)
        image = first.save()
        second.load(image)
        assert second.save() == image and bits(second) == bits(first)
        for host in (first, second):
            pull(host, 5.0)
            host.step(0.30000000000000004, 0.2)
        assert bits(second) == bits(first)


def test_parameters_are_part_of_a_state(kinds: dict[str, Path]) -> None:
    with Host(kinds["body-0"]) as saved, Host(kinds["body-0"]) as other:
        image = saved.initialize(m_x=1.0e5, x_0=0.5).save()
        other.load(image)
        assert other.get("m_x", "x", "ax") == [1.0e5, 0.5, -0.05]


def test_a_state_that_is_damaged_or_of_another_vessel_is_refused(kinds: dict[str, Path]) -> None:
    with Host(kinds["body-0"]) as host:
        image = bytearray(host.initialize().save())
    image[len(image) // 2] ^= 1
    with Host(kinds["body-0"]) as host:
        refused(host, "the state is damaged", host.load, bytes(image))
    with Host(kinds["sines"]) as host:
        foreign = host.initialize().save()
    with Host(kinds["body-0"]) as host:
        refused(host, "the state is of another vessel", host.load, foreign)


# --- refusals ---


MISTAKES: dict[str, tuple[Callable[[Host], object], str]] = {
    "NaN": (lambda host: host.set(F_x=float("nan")), "F_x = nan at t = 0.3 s: a finite number is expected"),
    "infinity": (lambda host: host.set(F_y=float("-inf")), "F_y = -inf at t = 0.3 s: a finite number is expected"),
    "too late": (lambda host: host.set(m_x=1.0), "m_x = 1.0 at t = 0.3 s: parameters are fixed once initialization"),
    "output": (lambda host: host.set(ax=1.0), "ax = 1.0 at t = 0.3 s: it is calculated and cannot be set"),
    "no step": (lambda host: host.step(0.3, 0.0), "doStep at t = 0.3 s: communication step 0.0 s; a number above 0"),
    "NaN step": (lambda host: host.step(0.3, float("nan")), "communication step nan s; a number above 0"),
    "too short": (lambda host: host.step(0.3, 1e-18), "step 1e-18 s; a number above 0 that moves time on"),
    "NaN point": (lambda host: host.step(float("nan"), 0.1), "communication point nan s is not where the last step"),
    "elsewhere": (lambda host: host.step(0.4, 0.1), "communication point 0.4 s is not where the last step ended"),
    "too strong": (
        lambda host: (host.set(F_y=1e308), host.step(0.3, 1e3)), "the step leads to no finite number; the force is too"
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_are_refused_in_words(mistake: str, kinds: dict[str, Path], capfd: pytest.CaptureFixture[str]) -> None:
    make, says = MISTAKES[mistake]
    with Host(kinds["body-1"]) as host:
        host.initialize()
        host.step(0.0, 0.3)
        refused(host, says, make, host)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [("m_x", 0.0, "above 0"), ("c_y", -1.0, "0 or more"), ("k_x", -1.0, "0 or more"), ("x_0", np.nan, "finite")],
)
def test_parameters_without_sense_are_refused(name: str, value: float, says: str, kinds: dict[str, Path]) -> None:
    with Host(kinds["body-0"]) as host:
        refused(host, f"{name} = {value} at t = 0 s: a", host.set_all, {name: value})
        assert says in host.messages[-1]


def test_a_step_past_the_stop_time_is_refused(kinds: dict[str, Path]) -> None:
    with Host(kinds["sines"]) as host:
        host.fmu.setupExperiment(startTime=0.0, stopTime=0.5)
        host.fmu.enterInitializationMode()
        host.fmu.exitInitializationMode()
        host.step(0.0, 0.5)
        refused(host, "communication step 0.1 s leads past the stop time, 0.5 s", host.step, 0.5, 0.1)


def test_a_run_that_ends_early_does_not_look_like_one_that_ended_well(build: Build, tmp_path: Path) -> None:
    """simulate_fmu stops without a word when pythonfmu discards a step; so a vessel does not discard."""
    times = np.arange(5.0)
    folder = build(kind="csv", file=write_csv(tmp_path / "m.csv", times, times, times))
    assert len(simulate_fmu(str(folder), stop_time=4.0, output_interval=0.5)) == 9
    with pytest.raises(FMICallException):
        simulate_fmu(str(folder), stop_time=5.0, output_interval=0.5)


def test_a_refusal_leaves_the_process_sound(kinds: dict[str, Path]) -> None:
    """pythonfmu gives up its references twice after an error: unless the vessel adds some, memory is freed in use."""
    (module,) = (kinds["body-0"] / "resources" / "slavemodule.txt").read_text().split()

    def references() -> int:
        gc.collect()
        return sys.getrefcount(sys.modules[module].Vessel)

    def mistaken() -> None:
        with Host(kinds["body-0"]) as host:
            refused(host, "F_x = nan", host.set, F_x=float("nan"))

    mistaken()
    before = references()
    for _ in range(20):
        mistaken()
    assert references() == before


def test_reset_goes_back_to_the_start(kinds: dict[str, Path]) -> None:
    with Host(kinds["body-2"]) as host:
        start = host.get(*host.reference)
        host.initialize(m_x=1.0, F_x=50.0).step(0.0, 0.1)
        host.fmu.reset()
        assert host.get(*host.reference) == start


def test_vessels_in_one_process_do_not_touch_each_other(kinds: dict[str, Path], build: Build) -> None:
    """Of all kinds, two of them of one name: step by step beside each other as each by itself."""
    folders = [*kinds.values(), build(**(BODY | {"m_x": 1.0e5}), name="vessel"), build(**SINES, name="vessel")]

    def stepped(hosts: list[Host]) -> list[list[bytes]]:
        for host in hosts:
            host.initialize()
        rows: list[list[bytes]] = [[] for _ in hosts]
        for k in range(5):
            for host, row in zip(hosts, rows, strict=True):
                pull(host, k * 0.1)
                host.step(k * 0.1, 0.1)
                row.append(bits(host))
        for host in hosts:
            host.fmu.freeInstance()
        return rows

    together = stepped([Host(folder) for folder in folders])
    assert together == [rows for folder in folders for rows in stepped([Host(folder)])]
    assert len({tuple(rows) for rows in together}) == len(folders) - 1  # sines are there twice
