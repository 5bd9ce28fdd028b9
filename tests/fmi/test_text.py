"""Numbers in messages: written without printf, to seven digits."""

from __future__ import annotations

import random

import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import Host

PLAIN = {
    1.0: "1",
    0.5: "0.5",
    10.0: "10",
    1234567.0: "1234567",
    100000.0: "100000",
    0.001: "0.001",
    0.05: "0.05",
    12.25: "12.25",
    99999999.0: "1e+8",
    1e22: "1e+22",
    2.5e-7: "2.5e-7",
    5e-324: "4.940656e-324",
    1.7976931348623157e308: "1.797693e+308",
}


def written(host: Host, value: float) -> str:
    """As the refusal of a negative mass writes it."""
    message = host.refusal(host.set, m_c=-value)
    return message.removeprefix("m_c = -").partition(" at t = ")[0]


@pytest.mark.parametrize(("value", "text"), PLAIN.items())
def test_numbers_read_as_people_write_them(value: float, text: str, unpacked: Unpacked) -> None:
    with Host(unpacked("load", 2)) as host:
        assert written(host, value) == text


def test_numbers_read_back_to_seven_digits(unpacked: Unpacked) -> None:
    dice = random.Random(1)
    with Host(unpacked("load", 2)) as host:
        for _ in range(500):
            value = dice.uniform(1.0, 10.0) * 10.0 ** dice.randint(-300, 300)
            assert float(written(host, value)) == pytest.approx(value, rel=5.1e-7)
