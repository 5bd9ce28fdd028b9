"""Vessel and cable in one system: the scene that a coupling of a body with a cable whose top it moves amounts to.

The vessel is m q'' + c q' + k q = F + external - static_load along x and y, F being the cable's force on it. A floater
that heaves and surges is the same with one mass for both, so its scene has the vessel's springs, dampers and loads, and
starts where the vessel does. It is integrated as a whole: nothing is exchanged, extrapolated or late.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .assembly import assemble
from .cable import Initial
from .coupling.connections import Variable
from .coupling.models import Model
from .coupling.system import System
from .scene import Scene
from .scene_inputs import InputsTable
from .scene_schema import FloaterTopTable, MotionTopTable
from .signals import Constant
from .vessel import BodyTable, Vessel

__all__ = ["NAMES", "NotOneError", "whole_scene"]

NAMES = {"x_m1": "x", "y_m1": "y"}
"""Outputs of the whole scene by those of the vessel; the cable's have their own names."""

_THERE = {f"{prefix}{axis}": f"{prefix}{axis}_1" for prefix in ("", "v", "a") for axis in "xy"}
_BACK = {f"F_1{axis}": f"F_{axis}" for axis in "xy"}


class NotOneError(Exception):
    """Why a coupling is not known to be a single scene; one sentence."""


def whole_scene(system: System) -> tuple[Scene, str, str]:
    """The scene, and what the coupling calls its vessel and its cable.

    Raises
    ------
    NotOneError
        If the coupling is not one body vessel, with one mass for both directions, that moves the top of one cable.
    """
    vessel, cable = _pair(system)
    table = Vessel.from_table(vessel.spec.vessel).table
    scene = cable.scene
    if not isinstance(table, BodyTable) or scene is None or not isinstance(scene.spec.top, MotionTopTable):
        raise NotOneError("a vessel of kind body and a scene with a top that is given are expected")
    if vessel.spec.parameters or cable.spec.parameters:
        raise NotOneError("parameters are set beside the vessel's table and the scene's file")
    if table.m_x != table.m_y:
        raise NotOneError(f"m_x = {table.m_x:g} kg and m_y = {table.m_y:g} kg differ, and a floater has one mass")
    if scene.cable.initial is not Initial.SHAPE:
        raise NotOneError("the cable starts from an equilibrium that is found under its given top")
    return _with_floater(scene, table, cable), vessel.name, cable.name


def _pair(system: System) -> tuple[Model, Model]:
    """Vessel and cable, connected by motion and force and nothing else."""
    models = list(system.models.values())
    vessels = [model for model in models if model.spec.vessel is not None]
    cables = [model for model in models if model.spec.scene is not None]
    if len(models) != 2 or len(vessels) != 1 or len(cables) != 1:
        raise NotOneError("one vessel and one scene are expected, and nothing else")
    vessel, cable = vessels[0], cables[0]
    there = {(Variable(vessel.name, a), Variable(cable.name, b), 1.0, 0.0) for a, b in _THERE.items()}
    back = {(Variable(cable.name, a), Variable(vessel.name, b), 1.0, 0.0) for a, b in _BACK.items()}
    if {(c.source, c.target, c.gain, c.offset) for c in system.connections} != there | back:
        raise NotOneError("the vessel's motion to the cable's top and F_1x, F_1y back, as they are, are expected")
    return vessel, cable


def _with_floater(scene: Scene, table: BodyTable, model: Model) -> Scene:
    top = FloaterTopTable(
        kind="floater", mass=table.m_y, stiffness=table.k_y, damping=table.c_y,
        static_load=table.static_load_y - table.external_y, stiffness_horizontal=table.k_x,
        damping_horizontal=table.c_x, static_pull=table.static_load_x - table.external_x,
    )  # fmt: skip
    spec = scene.spec.model_copy(update={"top": top, "inputs": InputsTable()})
    cable = assemble(scene.name, spec, {})
    angles = scene.cable.position  # of a cable whose top is given there is nothing else
    position = np.concatenate([[table.y_0], angles, [table.x_0]])
    velocity = np.concatenate([[table.vy_0], np.zeros(len(angles)), [table.vx_0]])
    held = {name: model.constants.get(name, 0.0) for name in cable.inputs}
    start = {name: value for name, value in held.items() if value}
    cable = replace(cable, position=position, velocity=velocity, input_start=start)
    return replace(scene, spec=spec, cable=cable, signals={name: Constant(value) for name, value in held.items()})
