"""An FMU that is opened once gives in every run what a run of its own gives, to the bit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from cablefmu.errors import OptionError
from cablefmu.fmu.archive import build_fmu
from cablefmu.runner import Runner
from cablefmu.simulate import simulate
from tests.fmu_helpers import small_scene

CASES: list[Mapping[str, float | str]] = [
    {}, {"M_1": 900.0}, {"F_cx": 1e300}, {"u_m1": 50.0, "solver": "implicit"}, {"M_1": 900.0}, {},
]  # fmt: skip
"""One that fails in the middle, and some twice: nothing of a run is left for the next."""


@pytest.mark.parametrize(("fmi", "interface"), [(2, "cs"), (3, "cs"), (2, "me")])
def test_runs_do_not_know_of_each_other(fmi: int, interface: str, tmp_path: Path) -> None:
    path = build_fmu(small_scene("load"), tmp_path / "load.fmu", fmi=fmi)
    runner = Runner(path, tmp_path / "fmu", interface=interface, stop_time=1.0, step=0.25)
    names = [variable.name for variable in runner.outputs]
    for given in CASES:
        ended = runner.run(given)
        if "F_cx" in given:
            assert ended.failure is not None
            assert len(ended.recording.times) <= 1
            continue
        assert ended.failure is None
        alone = simulate(path, interface=interface, stop_time=1.0, step=0.25, parameters=given)
        np.testing.assert_array_equal(ended.recording.times, alone["time"])
        np.testing.assert_array_equal(ended.recording.rows, np.column_stack([alone[name] for name in names]))
    runner.close()


def test_an_fmu_with_arrays_changes_its_number_of_links(tmp_path: Path) -> None:
    path = build_fmu(small_scene("load"), tmp_path / "load.fmu", arrays=True)
    runner = Runner(path, tmp_path / "fmu", stop_time=0.5)
    for n in (5, 40, 7):
        alone = simulate(path, stop_time=0.5, parameters={"n": n})
        recording = runner.run({"n": n}).recording
        place = [variable.name for variable in recording.variables].index("x_c")
        assert [row[place] for row in recording.rows] == alone["x_c"].values.tolist()
    runner.close()


def test_what_cannot_be_set_is_refused_before_a_run(tmp_path: Path) -> None:
    runner = Runner(build_fmu(small_scene("load"), tmp_path / "load.fmu"), tmp_path / "fmu")
    runner.check("M_1", 700.0)
    for name, value in (("M", 1.0), ("M_1", -1.0), ("M_1", "heavy"), ("x_c", 1.0), ("solver", "fast")):
        with pytest.raises(OptionError, match=f"set {name}"):
            runner.check(name, value)
    runner.close()
