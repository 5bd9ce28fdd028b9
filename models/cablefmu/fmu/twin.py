"""The twin: an FMU of the same scene that the dense reference model computes, built by pythonfmu.

The slave itself is fmu_src/partners/twin.py, which travels in the package's binaries/partners.
"""

from __future__ import annotations

import json
from pathlib import Path

from .. import __version__
from ..cable import Initial
from ..errors import FmuError, SceneError
from ..files import check_writable, replacing
from ..scene import Scene, load_scene
from .archive import write_zip
from .description import Experiment, describe, model_identifier
from .documentation import DOCUMENTATION, documentation
from .licence import LICENCE, slave_licence
from .python_slave import partner_script, slave_description, slave_members
from .resource import token_of
from .variables import Kind, Variable, variables_of

__all__ = ["build_twin", "scene_of_twin", "twin_variables"]

_ORIGIN = "twin.json"
"""Resource that says which scene it is, and of which version of this package."""

_REMARK = (
    "Twin for checking: computed by the dense reference model under scipy. The host's Python must have"
    f" cablefmu {__version__} installed. Inputs are held over a communication step."
)


def twin_variables(scene: Scene) -> list[Variable]:
    """The native FMU's variables, by the same references, less its time and what belongs to its own algorithms."""
    variables = variables_of(scene.cable, scene.dropped_outputs)
    own = (Kind.TIME, Kind.SOLVER, Kind.SOLVER_CHOICE, Kind.STATICS)
    return [variable for variable in variables if variable.kind not in own]


def build_twin(scene: Scene | str | Path, output: str | Path | None = None) -> Path:
    """Build a scene's twin: an FMI 2 Co-Simulation FMU that shares no computation with the native one.

    Parameters
    ----------
    scene
        A scene, the name of one that ships, or the path of a TOML file.
    output
        File to write; by default ./build/NAME-twin.fmu. An existing file is replaced.

    Returns
    -------
    Path
        Of the archive. The Python of its host must have this version of `cablefmu` installed.

    Raises
    ------
    SceneError
        If the scene is not in order, or starts from an equilibrium, which the reference model does not look for.
    OptionError
        If the file cannot be written.
    """
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    if scene.cable.initial is Initial.EQUILIBRIUM:
        raise SceneError(
            f'{scene.name}: run.initial = "equilibrium": a twin starts from the shape; "shape" is expected for a twin'
        )
    name = f"{scene.name}-twin.fmu"
    path = Path(output) if output is not None else Path("build") / name
    check_writable(path)
    members = _packed(scene)
    members["modelDescription.xml"] = _description(scene, token_of(b"".join(members[name] for name in sorted(members))))
    members[DOCUMENTATION] = documentation(scene, twin_variables(scene), fmi=2, file=name, twin=_REMARK)
    members[LICENCE] = slave_licence()
    with replacing(path) as temporary:
        write_zip(temporary, members)
    return path


def scene_of_twin(resources: Path) -> Scene:
    """The scene in the resources of a twin.

    Raises
    ------
    FmuError
        If another version of this package built the twin: its variables may have other references.
    """
    origin = json.loads((resources / _ORIGIN).read_text(encoding="utf-8"))
    built_by = origin["cablefmu"]
    if built_by != __version__:
        raise FmuError(f"the twin was built by cablefmu {built_by}, installed is {__version__}; build it again")
    return load_scene(resources / f"{origin['scene']}.toml")


def _packed(scene: Scene) -> dict[str, bytes]:
    """The slave with the scene's files."""
    beside = {
        f"{scene.name}.toml": scene.text.encode(),
        _ORIGIN: json.dumps({"cablefmu": __version__, "scene": scene.name}).encode(),
        **scene.files,
    }
    return slave_members(partner_script("twin"), module=f"twin_{model_identifier(scene.name)}", beside=beside)


def _description(scene: Scene, token: str) -> bytes:
    """The native FMU's, of Co-Simulation only."""
    native = describe(
        2, name=scene.name, description=f"{scene.description}. {_REMARK}", token=token,
        variables=twin_variables(scene), experiment=Experiment(scene.stop_time, scene.step, scene.tolerance),
    )  # fmt: skip
    return slave_description(native, keeps_state=False)
