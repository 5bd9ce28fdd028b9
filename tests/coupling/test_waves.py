"""Seas in couplings: built from their table, and the same whichever way the models are stepped."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.coupling import couple
from cablefmu.coupling.description import Coupling
from cablefmu.coupling.engines import run_with
from cablefmu.coupling.system import opened
from cablefmu.errors import CouplingError

TEXT = """
[coupling]
stop_time = 6
step = 0.1
algorithm = "jacobi"
extrapolation = 1

[[model]]
name = "sea"
[model.waves]
kind = "airy"
height = 1.6
period = 5
ramp = 2
outputs = ["elevation", "velocity"]

[[model]]
name = "buoyancy"
partner = "spring"
parameters = { stiffness = 500.0, damping = 100.0 }

[[model]]
name = "cable"
scene = "free-12-water"
inputs = { F_cx = 0.0, F_cy = 0.0 }

[[connection]]
from = "sea.elevation[1]"
to = "buoyancy.y_b"
gain = -1.0                # the spring's y is down

[[connection]]
from = "sea.vy[1]"
to = "buoyancy.v_b"

[[connection]]
from = "cable.y_m1"
to = "buoyancy.y_a"

[[connection]]
from = "cable.v_m1"
to = "buoyancy.v_a"

[[connection]]
from = "buoyancy.F_a"
to = "cable.u_m1"
"""


LATE = {"jacobi": 2e-2, "gauss-seidel": 1e-2, "iterated": 1e-6}
"""What extrapolation over a step leaves of the spring's force, twice what was measured; iterated inputs agree."""


@pytest.mark.parametrize("algorithm", LATE)
def test_a_sea_lifts_a_floater(algorithm: str) -> None:
    result = couple(Coupling.from_text(TEXT.replace('"jacobi"', f'"{algorithm}"'), name="x"))
    time = result["time"].values
    s = np.clip(time / 2.0, 0.0, 1.0)
    expected = (10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5) * 0.8 * np.cos(2.0 * np.pi / 5.0 * time)
    assert np.abs(result["sea.elevation[1]"].values - expected).max() < 1e-12
    sunk = result["cable.y_m1"].values + expected
    faster = result["cable.v_m1"].values - result["sea.vy[1]"].values
    force = -500.0 * sunk - 100.0 * faster
    assert np.abs(force - result["buoyancy.F_a"].values).max() < LATE[algorithm] * np.abs(force).max()


OTHERS = """
[coupling]
stop_time = 6
step = 0.1

[[model]]
name = "sea"
[model.waves]
kind = "jonswap"
significant_height = 2
peak_period = 7
duration = 600
outputs = ["elevation", "velocity"]

[[model]]
name = "plate"
partner = "spring"
parameters = { drag = 300.0 }
inputs = { y_a = 0.0, v_a = 0.0, y_b = 0.0 }

[[connection]]
from = "sea.vy[1]"
to = "plate.v_b"
"""


@pytest.mark.parametrize("engine", ["libcosim", "fmpy-ssp"])
def test_other_engines_have_the_same_sea(engine: str) -> None:
    """But for their times, which differ in the last digits: libcosim counts nanoseconds, FMPy adds up steps."""
    with opened(Coupling.from_text(OTHERS, name="x")) as system:
        own, other = run_with("own", system), run_with(engine, system)
    for name in ("sea.elevation[1]", "sea.vx[1]", "sea.vy[1]"):
        expected = own[name].values[1:]
        assert np.abs(expected).max() > 0.2
        assert np.abs(other[name].values - expected).max() < 1e-12


def test_a_mistake_in_a_seas_table_is_one_of_the_coupling() -> None:
    with pytest.raises(CouplingError, match=r"sea\.waves\.height = 99\.0: waves 39\.\d* m long break from"):
        couple(Coupling.from_text(TEXT.replace("height = 1.6", "height = 99"), name="x"))


def test_a_sea_by_itself_runs_in_another_engine() -> None:
    """Without a connection: SSP's schema has no empty list of them."""
    text = OTHERS.partition('[[model]]\nname = "plate"')[0]
    with opened(Coupling.from_text(text, name="alone")) as system:
        own, other = run_with("own", system), run_with("fmpy-ssp", system)
    expected = own["sea.vy[1]"].values[1:]
    assert np.abs(expected).max() > 0.2
    assert np.abs(other["sea.vy[1]"].values - expected).max() < 1e-12
