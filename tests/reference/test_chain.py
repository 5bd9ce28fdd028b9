"""The sums that every equation uses, and what a cable's parameters turn into."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Drag, Terminal
from cablefmu.reference.chain import chain_of, sum_below
from tests.random_cables import random_cable


def test_sum_below_leaves_out_the_link_itself() -> None:
    assert sum_below(np.array([1.0, 2.0, 4.0])) == pytest.approx([6.0, 4.0, 0.0])
    assert sum_below(np.array([5.0])) == pytest.approx([0.0])


def test_carried_masses_by_hand() -> None:
    cable = random_cable(np.random.default_rng(0), 3, Terminal.LOAD, water=False)
    links = replace(cable.links, mass=np.array([2.0, 4.0, 8.0]))
    chain = chain_of(replace(cable, links=links, parameters=cable.parameters | {"m_c": 10.0}))
    assert chain.carried_mass == pytest.approx([1 + 4 + 8 + 10, 2 + 8 + 10, 4 + 10])
    assert chain.carried_wet_mass == pytest.approx(chain.carried_mass)


def test_drag_of_a_steel_cable_link_is_the_tables_200() -> None:
    """1/2 x 1000 kg/m^3 x 1.0 x 0.02 m x 20 m = 200 N s^2/m^2 [Table 6.1]."""
    cable = random_cable(np.random.default_rng(0), 12, Terminal.LOAD, water=True, uneven=False)
    links = replace(cable.links, drag_area=np.full(12, 0.02 * 20.0))
    water = cable.parameters | {"rho_w": 1000.0, "Cd": 1.0}
    assert chain_of(replace(cable, links=links, parameters=water)).drag == pytest.approx(np.full(12, 200.0))


def test_drag_per_link_stands_as_it_is() -> None:
    cable = random_cable(np.random.default_rng(0), 4, Terminal.LOAD, water=True, drag=Drag.PER_LINK)
    assert np.array_equal(chain_of(cable).drag, cable.links.drag)


@pytest.mark.parametrize("given", [{"rho_c": 7850.0}, {"V_c": 60.0 / 7850.0}])
def test_load_weighs_less_in_water(given: dict[str, float]) -> None:
    cable = random_cable(np.random.default_rng(0), 2, Terminal.LOAD, water=False)
    water = cable.parameters | {"m_c": 60.0, "rho_w": 1000.0} | given
    assert chain_of(replace(cable, parameters=water)).end_wet_mass == pytest.approx(60.0 * (1 - 1000 / 7850))
    assert chain_of(cable).end_wet_mass == cable.parameters["m_c"]
