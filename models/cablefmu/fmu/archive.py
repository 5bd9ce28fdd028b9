"""The .fmu file: written from a scene, and read back with the scene that travels in it."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path

from fmpy import read_model_description
from fmpy.model_description import ModelDescription

from ..cable import Whole
from ..errors import FmuError, OptionError, SceneError
from ..files import replacing
from ..scene import Scene, load_scene
from ..whole import whole_of
from .description import Experiment, describe, model_identifier
from .documentation import DOCUMENTATION, documentation
from .licence import LICENCE, licence
from .platforms import binaries
from .resource import RESOURCE_NAME, resource_bytes, token_of
from .sources import FOLDER, sources
from .terminals import icon_png, terminals_and_icons
from .variables import Variable, variables_of

__all__ = ["Archive", "build_fmu", "default_path", "open_fmu", "write_zip"]

_ZIP_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can say: two builds are the same to the byte


def default_path(scene: Scene, fmi: int, *, arrays: bool = False) -> Path:
    """Where `build` puts a scene's FMU unless it is told: ./build/NAME.fmu, NAME-fmi3.fmu or NAME-fmi3-arrays.fmu."""
    return Path("build") / f"{scene.name}{'' if fmi == 2 else f'-fmi{fmi}'}{'-arrays' if arrays else ''}.fmu"


def build_fmu(
    scene: Scene | str | Path,
    output: str | Path | None = None,
    *,
    fmi: int | None = None,
    arrays: bool = False,
    platforms: Collection[str] | None = None,
) -> Path:
    """Build a scene's FMU: Model Exchange and Co-Simulation in one archive.

    Parameters
    ----------
    scene
        A scene, the name of one that ships, or the path of a TOML file.
    output
        File to write; by default ./build/NAME.fmu (NAME-fmi3.fmu, NAME-fmi3-arrays.fmu). An existing file is replaced.
    fmi
        Version of FMI, 2 (default) or 3.
    arrays
        Link angles and rates as arrays, and the number of links as a structural parameter n: FMI 3 alone has these.
    platforms
        Machines that it is for, of `cablefmu.fmu.platforms.PLATFORMS`; all by default.

    Returns
    -------
    Path
        Of the archive.

    Raises
    ------
    SceneError
        If the scene is not in order, or with arrays: does not say how its cable is divided into any number of links.
    OptionError
        If `fmi` is neither 2 nor 3, or 2 with arrays, or a platform is unknown, or the file cannot be written.
    """
    fmi = fmi if fmi is not None else 3 if arrays else 2
    if fmi not in (2, 3):
        raise OptionError(f"fmi = {fmi!r}: 2 or 3 is expected")
    if arrays and fmi == 2:
        raise OptionError("fmi = 2: FMI 2 has no arrays; version 3 is expected")
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    path = Path(output) if output is not None else default_path(scene, fmi, arrays=arrays)
    libraries = binaries(fmi, platforms)
    members = _members(scene, fmi, whole_of(scene) if arrays else None, libraries)
    with replacing(path) as temporary:
        write_zip(temporary, members)
    return path


def _members(scene: Scene, fmi: int, whole: Whole | None, libraries: Mapping[str, str]) -> dict[str, bytes]:
    variables = variables_of(scene.cable, scene.dropped_outputs, whole)
    resource = resource_bytes(scene.cable, variables, whole)
    experiment = Experiment(scene.stop_time, scene.step, scene.tolerance)
    package = files("cablefmu") / "binaries"
    identifier = model_identifier(scene.name)
    members = {
        "modelDescription.xml": describe(
            fmi, name=scene.name, description=scene.description, token=token_of(resource), variables=variables,
            experiment=experiment,
        ),
        f"resources/{RESOURCE_NAME}": resource,
        f"resources/{scene.name}.toml": scene.text.encode(),
        DOCUMENTATION: documentation(
            replace(scene, cable=whole.rest_of(scene.cable)) if whole else scene, variables, fmi=fmi,
            file=default_path(scene, fmi, arrays=whole is not None).name,
        ),
        LICENCE: licence(),
        **terminals_and_icons(scene.cable, variables),
        **{f"{FOLDER}/{name}": content for name, content in sources(fmi, identifier).items()},
    }  # fmt: skip
    if fmi == 2:
        members["model.png"] = icon_png()
    for name, content in scene.files.items():
        members[f"resources/{name}"] = content
    for folder, binary in libraries.items():
        members[f"binaries/{folder}/{identifier}{Path(binary).suffix}"] = (package / binary).read_bytes()
    return members


def write_zip(path: Path, members: Mapping[str, bytes]) -> None:
    """Write an archive of these members, the same bytes for the same content."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(members):
            entry = zipfile.ZipInfo(name, date_time=_ZIP_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            entry.create_system = 3
            archive.writestr(entry, members[name])


@dataclass(frozen=True, slots=True)
class Archive:
    """An FMU of ours on disk, with the scene that it was made of."""

    path: Path
    scene: Scene
    fmi: int
    description: ModelDescription

    @property
    def has_arrays(self) -> bool:
        """Whether the number of links is a parameter."""
        return any(variable.causality == "structuralParameter" for variable in self.description.modelVariables)

    def variables(self) -> list[Variable]:
        """What its scene has of variables; those of a twin are fewer."""
        whole = whole_of(self.scene) if self.has_arrays else None
        return variables_of(self.scene.cable, self.scene.dropped_outputs, whole)


def open_fmu(path: str | Path) -> Archive:
    """Read an FMU that `build_fmu` made.

    Raises
    ------
    FmuError
        If the file is missing, is no FMU, is somebody else's, or is damaged.
    """
    path = Path(path)
    if not path.is_file():
        raise FmuError(f"{path}: there is no such file")
    try:
        with zipfile.ZipFile(path) as archive:
            damaged = archive.testzip()
            if damaged:
                raise FmuError(f"{path}: {damaged} in it is damaged")
            names = archive.namelist()
            texts = {name: archive.read(name) for name in names if name.startswith("resources/")}
    # zlib.error: damaged; RuntimeError, NotImplementedError: encrypted or packed in a way that is not ours.
    except (zipfile.BadZipFile, OSError, zlib.error, EOFError, RuntimeError, UnicodeDecodeError) as error:
        raise FmuError(f"{path}: is not an FMU ({error})") from None
    try:
        description = read_model_description(str(path), validate=False)
    except Exception as error:  # FMPy raises what its parsers raise
        raise FmuError(f"{path}: its modelDescription.xml cannot be read ({error})") from None
    return Archive(path, _scene_in(path, description, texts), int(description.fmiVersion.split(".")[0]), description)


def _scene_in(path: Path, description: ModelDescription, resources: dict[str, bytes]) -> Scene:
    name = description.modelName
    text = resources.get(f"resources/{name}.toml")
    if not (description.generationTool or "").startswith("cablefmu") or text is None:
        raise FmuError(f"{path}: was not made by cablefmu; an archive from `cablefmu build` is expected")
    beside = {member.removeprefix("resources/"): content for member, content in _others(resources, name)}
    try:
        return Scene.from_text(text.decode(), name=name, files=beside, source=f"{path}/resources/{name}.toml")
    except (SceneError, UnicodeDecodeError) as error:
        raise FmuError(f"{path}: the scene in it cannot be read by this version.\n{error}") from None


def _others(resources: dict[str, bytes], name: str) -> Iterable[tuple[str, bytes]]:
    own = {f"resources/{RESOURCE_NAME}", f"resources/{name}.toml"}
    return ((member, content) for member, content in resources.items() if member not in own)
