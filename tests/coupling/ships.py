"""A vessel on springs that moves a cable of 6 links by the motion port, as a coupling that ships does."""

from __future__ import annotations

from pathlib import Path

from cablefmu.coupling import load_coupling
from cablefmu.coupling.description import Coupling

STOP = 2.4
NAMES = ("vessel.x", "vessel.y", "cable.x_c", "cable.y_c")
"""Positions of both"""

SCENE = """
format = 1
description = "6 links with a load under a ship"
[cable]
links = 6
length = "30 m"
diameter = "20 mm"
density = "7850 kg/m^3"
young_modulus = "80 GPa"
joint_damping = "2.8 N m s/rad"
[water]
Cd = 1.0
[top]
kind = "motion"
[terminal]
kind = "load"
mass = "50 kg"
density = "7850 kg/m^3"
[shape]
kind = "hanging"
[run]
stop_time = "2.4 s"
"""


def small(folder: Path, *, mass: float = 4000.0) -> Coupling:
    """A vessel and a cable of 6 links and 124 kg with its load; the vessel's periods are about 3 s."""
    (folder / "ship.toml").write_text(SCENE, encoding="utf-8")
    text = load_coupling("moored-vessel").text
    body = f"""kind = "body"
m_x = {mass}
m_y = {mass}
k_x = {4.0 * (mass + 100.0)}
k_y = {5.0 * (mass + 100.0)}
c_x = {0.2 * mass}
c_y = {0.3 * mass}
x_0 = 1.0
y_0 = -0.5
vx_0 = 0.2
static_load_y = 900.0
external_x = 50.0"""
    head, _, rest = text.partition("[model.vessel]")
    tail = rest[rest.index("[[model]]") :]
    text = f"{head}[model.vessel]\n{body}\n\n{tail}"
    for old, new in (("towed-40", "ship.toml"), ('"16 s"', str(STOP))):
        assert old in text
        text = text.replace(old, new)
    return Coupling.from_text(text, name="small", folder=folder)
