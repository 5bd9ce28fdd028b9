"""Three more digits change nothing but the rounding."""

from __future__ import annotations

import numpy as np
import pytest

from cablefmu.cable import Terminal, Top
from cablefmu.reference.extended import extended_acceleration, extended_outputs
from cablefmu.reference.long_double import long_double_acceleration, long_double_outputs
from tests.random_cables import random_cable, random_inputs, random_state

FINE = np.finfo(np.longdouble).eps < 1e-18


@pytest.mark.skipif(not FINE, reason="long doubles are doubles here")
@pytest.mark.parametrize("top", Top)
@pytest.mark.parametrize("terminal", Terminal)
def test_they_are_those_of_fifty_digits(terminal: Terminal, top: Top) -> None:
    rng = np.random.default_rng(41)
    cable = random_cable(rng, 8, terminal, water=True, top=top)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    exact = extended_acceleration(cable, q, v, inputs).astype(np.longdouble)
    found = long_double_acceleration(cable, q, v, inputs)
    # 19 digits less the condition of I, up to 1e4 at 8 links
    assert np.max(np.abs(found - exact)) < 1e-15 * np.max(np.abs(exact))
    values = long_double_outputs(cable, q, v, inputs)
    for name, value in extended_outputs(cable, q, v, inputs).items():
        assert float(values[name]) == pytest.approx(float(value), rel=1e-12)
