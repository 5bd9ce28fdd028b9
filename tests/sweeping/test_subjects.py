"""What a sweep runs: values reach FMUs and models, and everything that decides on results is in the identity."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cablefmu.coupling import couple
from cablefmu.coupling.description import Coupling
from cablefmu.errors import OptionError
from cablefmu.fmu.archive import build_fmu
from cablefmu.sweeping.description import make_sweep
from cablefmu.sweeping.subjects import Package, packages_of
from tests.fmu_helpers import SCENES

COUPLING = """
[coupling]
stop_time = 1
step = 0.05
[[model]]
name = "cable"
scene = "small.toml"
[[model]]
name = "vessel"
inputs = { F_x = 0.0, F_y = 0.0 }
[model.vessel]
kind = "body"
m_x = 20000
m_y = 20000
k_y = 8000
y_0 = 0.5
static_load_y = 1000
"""
CONNECTION = '[[connection]]\nfrom = "vessel.{0}"\nto = "cable.{0}_1"\n'
COUPLED = COUPLING + "".join(map(CONNECTION.format, ("x", "y", "vx", "vy", "ax", "ay")))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "small.toml").write_text(SCENES["moved"])
    (tmp_path / "c.toml").write_text(COUPLED)
    return tmp_path


def packages(folder: Path, **tables: Any) -> list[Package]:
    asked = tables or {"coupling": "c.toml", "grid": {"vessel.y_0": [1]}}
    return packages_of(make_sweep(asked, name="s", folder=folder))


def test_a_coupling_gives_what_its_file_with_these_values_gives(folder: Path) -> None:
    (package,) = packages(folder)
    with closing(package.open()) as subject:
        before = subject.run({})
        found = subject.run({"vessel.y_0": 1.0, "cable.Cd": 2.0})
        after = subject.run({})
    edited = COUPLED.replace("y_0 = 0.5", "y_0 = 1.0").replace(
        'scene = "small.toml"', 'scene = "small.toml"\nparameters = { Cd = 2.0 }'
    )
    alone = couple(Coupling.from_text(edited, name="c", folder=folder))
    names = [output.name for output in subject.outputs]
    np.testing.assert_array_equal(found.values, np.column_stack([alone[name] for name in names]))
    np.testing.assert_array_equal(before.values, after.values)
    assert np.abs(found.values - before.values).max() > 0.1


@pytest.mark.parametrize(("name", "value", "message"), [
    ("vessel.y_0", 1.0, None),
    ("cable.F_cx", 1.0, None),
    ("cable.solver", "implicit", None),
    ("cable.solver", "fast", "set cable.solver=fast: one of automatic, explicit, implicit is expected"),
    ("y_0", 1.0, "set y_0: MODEL.NAME is expected, with a model of cable, vessel"),
    ("ship.y_0", 1.0, "set ship.y_0: MODEL.NAME is expected"),
    ("vessel.z_0", 1.0, "set vessel.z_0=1.0: there is no such parameter or start value"),
    ("cable.x_1", 1.0, "set cable.x_1: it is an input that something is connected to"),
    ("cable.F_cx", "much", "set cable.F_cx=much: a number is expected"),
    ("vessel.m_x", -1.0, "set vessel.m_x=-1.0: at least"),
])  # fmt: skip
def test_what_a_coupling_s_case_may_set(name: str, value: float | str, message: str | None, folder: Path) -> None:
    (package,) = packages(folder)
    with closing(package.open()) as subject:
        if message is None:
            subject.check(name, value)
            return
        with pytest.raises(OptionError) as refused:
            subject.check(name, value)
    assert str(refused.value).startswith(message)


def test_the_identity_is_of_all_that_decides(folder: Path) -> None:
    def scenes(**run: Any) -> str:
        return packages(folder, scenes=["small.toml"], grid={"Cd": [1]}, run=run)[0].identity

    def coupled() -> str:
        return packages(folder)[0].identity

    def shipped() -> str:
        return packages(folder, coupling="wave-and-plate", grid={"wave.period": [8]})[0].identity

    assert shipped() == shipped(), "it has models in Python, whose archives are never the same twice"
    first = (scenes(), coupled())
    assert (scenes(), coupled()) == first
    assert scenes(fmi=3) != first[0]
    (folder / "small.toml").write_text(SCENES["moved"].replace("length = 20", "length = 21"))
    assert scenes() != first[0]
    assert coupled() != first[1]


def test_an_fmu_is_taken_as_it_is(folder: Path) -> None:
    build_fmu(folder / "small.toml", folder / "small.fmu", fmi=3)
    (package,) = packages(folder, scenes=["small.fmu"], grid={"Cd": [1]})
    with closing(package.open()) as subject:
        assert subject.run({"Cd": 1.5}).times[-1] == 2.0
    with pytest.raises(OptionError, match=r"fmi = 2: small\.fmu is an FMU, which has its version"):
        packages(folder, scenes=["small.fmu"], grid={"Cd": [1]}, run={"fmi": 2})
    with pytest.raises(OptionError, match=r"none\.fmu: cannot be read"):
        packages(folder, scenes=["none.fmu"], grid={"Cd": [1]})
