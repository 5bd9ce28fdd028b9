"""A uniform cable before it is divided: what an FMU needs whose number of links is a parameter.

Such an FMU (FMI 3 with arrays) divides the cable itself, by the rules of `assembly`, for any number of links n; with
n links it is to the bit the FMU of the same scene with `links = n`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cablefmu import scene_schema as schema
from cablefmu.assembly import assemble, bending_stiffness
from cablefmu.cable import Whole
from cablefmu.scene import Scene
from cablefmu.scene_mistakes import Mistake, MistakeFoundError, scene_error

__all__ = ["divided", "whole_of"]


def whole_of(scene: Scene) -> Whole:
    """The cable of a scene before it is divided.

    Raises
    ------
    SceneError
        If it is not uniform, or its start shape does not say what another number of links starts from.
    """
    mistakes = list(_obstacles(scene.spec))
    if mistakes:
        raise scene_error(_source(scene), mistakes)
    cable, terminal = scene.spec.cable, scene.spec.terminal
    diameter, density, modulus = _one(cable.diameter), _one(cable.density), _one(cable.young_modulus)
    parameters = {"L": cable.length or 0.0, "D": diameter, "rho_cable": density}
    if modulus:
        parameters["EI"] = float(bending_stiffness(np.array([modulus]), np.array([diameter]))[0])
    angle = _angle(scene.spec)
    if angle is not None:
        parameters["theta_start"] = angle
    if isinstance(terminal, schema.LoadTable):
        return Whole(parameters, preloads=(), place=(0.0, 0.0))
    top = scene.spec.top
    own = () if isinstance(top, schema.MotionTopTable) else ("static_load", "static_pull")
    held = {name: getattr(top, name) is None for name in own} | {"static_load_2": True, "static_pull_2": True}
    preloads = tuple(name for name, follows in held.items() if follows and name in scene.cable.parameters)
    return Whole(parameters, preloads=preloads, place=terminal.position)


def divided(scene: Scene, n: int, given: Mapping[str, float]) -> Scene:
    """The scene whose file says what an FMU with arrays was told: n links, and parameters of the whole cable.

    For scenes that have a `whole_of`. What the scene derived and the FMU has as a parameter stays as it was.

    Raises
    ------
    SceneError
        If no rest shape of so many links joins the ports.
    """
    whole = whole_of(scene)
    told = whole.parameters | {name: value for name, value in given.items() if name in whole.parameters}
    cable: dict[str, Any] = {"links": n, "length": told["L"], "diameter": told["D"], "density": told["rho_cable"]}
    if "EI" in told:
        cable |= {"young_modulus": None, "joint_stiffness": told["EI"] / (told["L"] / n)}
    update: dict[str, Any] = {"cable": scene.spec.cable.model_copy(update=cable)}
    if whole.preloads:
        update |= _hung_in(scene.spec, given)
    own = [name for name in ("static_load", "static_pull") if name in scene.cable.parameters]
    kept: dict[str, Any] = {name: scene.cable.parameters[name] for name in own if name not in whole.preloads}
    update["top"] = scene.spec.top.model_copy(update=kept)
    if "theta_start" in told:
        update["shape"] = schema.StraightShape.model_construct(kind="straight", angle=told["theta_start"])
    spec = scene.spec.model_copy(update=update)
    try:
        return replace(scene, spec=spec, cable=assemble(scene.name, spec, scene.signals))
    except MistakeFoundError as found:
        raise scene_error(_source(scene), [found.mistake]) from None


def _hung_in(spec: schema.Spec, given: Mapping[str, float]) -> dict[str, Any]:
    """What a rest shape depends on besides the cable: gravity, water, and what hangs at its end."""
    update: dict[str, Any] = {"gravity": given.get("g", spec.gravity)}
    if spec.water is not None:
        update["water"] = spec.water.model_copy(update={"density": given.get("rho_w", spec.water.density)})
    if isinstance(spec.terminal, schema.AnchorSpringTable):
        keys = {"m_c": "mass", "rho_c": "density", "V_c": "volume"}
        told = {keys[name]: value for name, value in given.items() if name in keys}
        update["terminal"] = spec.terminal.model_copy(update=told)
    return update


def _source(scene: Scene) -> str:
    return str(scene.path or f"{scene.name}.toml")


def _angle(spec: schema.Spec) -> float | None:
    """Of a straight cable [rad]; None for a rest shape between two ports."""
    if isinstance(spec.shape, schema.CatenaryShape):
        return None
    return spec.shape.angle if isinstance(spec.shape, schema.StraightShape) else 0.0


def _one(value: float | tuple[float, ...] | None) -> float:
    return value if isinstance(value, float) else 0.0


def _obstacles(spec: schema.Spec) -> Iterator[Mistake]:
    """Everything in a scene that another number of links would not know what to do with."""
    cable, water, terminal, shape = spec.cable, spec.water, spec.terminal, spec.shape
    per_link = (
        ("cable.link_length", cable.link_length, "cable.length"),
        ("cable.link_mass", cable.link_mass, "cable.density"),
        ("water.drag_per_link", water.drag_per_link if water else None, "water.Cd"),
    )
    for key, value, instead in per_link:
        if value is not None:
            text = f"it is per link, and arrays leave the number of links open; {instead} is expected"
            yield Mistake(key, text, list(value) if isinstance(value, tuple) else value)
    uniform = {
        "cable.diameter": cable.diameter, "cable.density": cable.density, "cable.young_modulus": cable.young_modulus,
        "cable.joint_stiffness": cable.joint_stiffness, "cable.joint_damping": cable.joint_damping,
        "water.Cd": water.Cd if water else None,
    }  # fmt: skip
    for key, value in uniform.items():
        if isinstance(value, tuple):
            yield Mistake(key, "arrays leave the number of links open; one value for all links is expected")
    if isinstance(shape, schema.AnglesShape):
        text = "arrays leave the number of links open, and these angles do not; allowed: straight, hanging, catenary"
        yield Mistake("shape.kind", text, shape.kind)
    elif isinstance(terminal, schema.AnchorMassTable | schema.PinTable | schema.MotionEndTable) and not isinstance(
        shape, schema.CatenaryShape
    ):
        text = "arrays leave the number of links open, and so where this shape ends; allowed: catenary"
        yield Mistake("shape.kind", text, shape.kind)
