"""The doctor's self-check: errors are measured, and what fails, dies or never ends does not hide the rest."""

from __future__ import annotations

import os
import time
from importlib import import_module

import pytest

from cablefmu.doctor_check import AGREEMENT, Check, coupling_error, run_apart, scene_error
from cablefmu.errors import OptionError


def right() -> float:
    return 1e-9


def wrong() -> float:
    return 0.5


def refused() -> float:
    raise OptionError("a sentence")


def broken() -> float:
    raise ZeroDivisionError("no sentence")


def dies() -> float:
    os.abort()


def hangs() -> float:
    time.sleep(600.0)
    return 0.0


def test_the_next_check_runs_whatever_the_one_before_did() -> None:
    checks: list[Check] = [(f.__name__, 1e-6, f) for f in (right, wrong, refused, broken, dies, right)]
    findings = list(run_apart(checks))
    assert [finding.what for finding in findings] == [name for name, _, _ in checks]
    assert [finding.failure for finding in findings] == [
        None,
        "wrong: 0.5 m from the dense model (1e-06 allowed)",
        "refused: a sentence",
        "broken: ZeroDivisionError: no sentence",
        "dies: its process died, or had no end in 120 s",
        None,
    ]


def test_a_check_without_end_is_given_up() -> None:
    findings = list(run_apart([("hangs", 1.0, hangs)], limit=0.2))
    assert [finding.failure for finding in findings] == ["hangs: its process died, or had no end in 0.2 s"]


@pytest.mark.parametrize("interface", ["cs", "me"])
def test_error_of_a_scene_is_that_of_its_solver(interface: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not zero, as of something compared with itself; and large where the FMU is another cable's."""
    assert 1e-12 < scene_error(2, interface) < AGREEMENT
    module = import_module("cablefmu.simulate")  # by its attribute the package has the function
    simulate = module.simulate
    monkeypatch.setattr(module, "simulate", lambda *a, **k: simulate(*a, **k, parameters={"Cd": 1.3}))
    assert scene_error(2, interface) > 10.0 * AGREEMENT


def test_error_of_a_coupling_is_that_of_its_steps() -> None:
    assert coupling_error() == pytest.approx(3e-4, rel=0.5)
