"""A scene with everything that it can have at once, and the same without one thing: what must be gone with it."""

from __future__ import annotations

from dataclasses import dataclass

from cablefmu.fmu.table import table
from cablefmu.scene import Scene
from tests.fmu_helpers import SCENES, from_equilibrium, small_scene

__all__ = ["ENDS", "FEATURES", "Feature", "scene_pair"]

_SPRING = ("k_cH", "c_cH", "k_cV", "c_cV", "static_load_2", "static_pull_2")
_FLOATER = ("M_2", "k_m2V", "c_m2V", "k_m2H", "c_m2H", "static_load_2", "static_pull_2", "u_m2")


@dataclass(frozen=True)
class Feature:
    """Two scenes by their texts, and the difference of their lists of variables."""

    having: str
    """A small scene's kind"""
    lacking: str
    """The same scene's text without the feature: another kind, or the kind with edits"""
    gone: tuple[str, ...]
    """Variables that only the first has"""
    edits: tuple[tuple[str, str], ...] = ()
    """(old, new) in the second's text"""
    come: tuple[str, ...] = ()
    """Variables that only the second has: a terminal is always of one kind"""
    equilibrium: bool = False
    """Whether the first starts from equilibrium"""


def _drop(*names: str) -> tuple[tuple[str, str], ...]:
    return (("[inputs]", f"[outputs]\ndrop = {list(names)!r}\n[inputs]"),)


_ABSENT = small_scene("load").cable.absent_outputs
_PLAIN_OUTPUTS = tuple(name for name in table().outputs if name not in _ABSENT | {"y_m1", "v_m1"})
_LOAD_TO_ANCHOR = ("m_c", "rho_c", "I_Rc", "F_cx", "F_cy")

FEATURES = {
    "water": Feature("load", "air", ("rho_w", "Cd", "rho_c")),
    "drag by coefficient": Feature(
        "load", "load", ("Cd",), edits=(("Cd = 1.0", f"drag_per_link = {[0.0] * 5}"),)
    ),
    "terminal spring": Feature("anchor-spring", "load", _SPRING, edits=(), come=("I_Rc", "F_cx", "F_cy")),
    "second floater": Feature("floater", "load", _FLOATER, come=("m_c", "rho_c", "I_Rc", "F_cy")),
    "pin": Feature("load", "pin", _LOAD_TO_ANCHOR),
    "joint stiffness": Feature("load", "load", ("k_joint",), edits=(("young_modulus = 8e10", "young_modulus = 0.0"),)),
    "joint damping": Feature("load", "load", ("c_joint",), edits=(("joint_damping = 2.8", "joint_damping = 0.0"),)),
    "rotary inertia": Feature("load", "load", ("I_Rc",), edits=(("rotary_inertia = 50\n", ""),)),
    "input u_m2": Feature(
        "floater", "anchor-spring", ("u_m2", "F_cx", "M_2", "k_m2V", "c_m2V", "k_m2H", "c_m2H"),
        come=("m_c", "rho_c", "k_cH", "c_cH", "k_cV", "c_cV"),
    ),
    "input F_cx": Feature("floater", "floater", ("F_cx",), edits=(("horizontal_force = true\n", ""),)),
    "inputs of a load": Feature("load", "anchor-mass", ("F_cx", "F_cy", "I_Rc", "rho_c")),
    **{f"output {name}": Feature("load", "load", (name,), edits=_drop(name)) for name in _PLAIN_OUTPUTS},
    **{f"output {name}": Feature("load", "load", (name,), edits=_drop(name)) for name in table().solver},
    "outputs solver.*": Feature(
        "load", "load", tuple(table().solver), edits=(("[inputs]", "[outputs]\nsolver = false\n[inputs]"),)
    ),
    "outputs statics.*": Feature("load", "load", tuple(table().statics), equilibrium=True),
    "everything that can go": Feature(
        "load", "air", ("rho_w", "Cd", "rho_c", "I_Rc", "k_joint", "c_joint", *_PLAIN_OUTPUTS, *table().solver),
        edits=(
            ("young_modulus = 8e10", "young_modulus = 0.0"), ("joint_damping = 2.8", "joint_damping = 0.0"),
            ("rotary_inertia = 50\n", ""), *_drop(*_PLAIN_OUTPUTS, *table().solver),
        ),
    ),
}  # fmt: skip


_FLOATER_1 = ("M_1", "k_m1", "c_m1", "static_load", "u_m1", "y_m1", "v_m1", "der(y_m1)", "der(v_m1)")


def _of_vessel(end: int) -> tuple[str, ...]:
    inputs = tuple(f"{kind}{axis}_{end}" for kind in ("", "v", "a") for axis in "xy")
    return (*inputs, f"F_{end}x", f"F_{end}y", f"m_{end}xx", f"m_{end}xy", f"m_{end}yy")


ENDS = {
    "surge": Feature(
        "surge", "pin", ("k_m1H", "c_m1H", "static_pull", "u_m1x", "x_m1", "vx_m1", "der(x_m1)", "der(vx_m1)")
    ),
    "vessel at the top": Feature("moved", "load", _of_vessel(1), come=_FLOATER_1),
    "vessels at both ends": Feature("between", "pin", (*_of_vessel(1), *_of_vessel(2)), come=_FLOATER_1),
}
"""Ends in place of others, which have costs of their own."""


def scene_pair(name: str) -> tuple[Scene, Scene]:
    """With the feature and without."""
    feature = (FEATURES | ENDS)[name]
    text = SCENES[feature.lacking]
    for old, new in feature.edits:
        if text.count(old) != 1:
            raise ValueError(f"{feature.lacking}: {old!r} should stand there once")
        text = text.replace(old, new)
    having = small_scene(feature.having)
    return from_equilibrium(having) if feature.equilibrium else having, Scene.from_text(text, name="lacking")
