"""The FMUs of a coupling: built or found, unpacked, and what their descriptions say of them."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree as ET

from fmpy import extract, read_model_description
from fmpy.model_description import BaseUnit, ModelDescription, ModelVariable
from pythonfmu import FmuBuilder

from ..errors import FmuError, UserError
from ..fmu.archive import build_fmu, open_fmu
from ..fmu.python_slave import partner_script, without_traces
from ..fmu.vessel import build_vessel
from ..fmu.waves import build_waves
from ..scene import Scene, load_scene
from ..scene_mistakes import Mistake, nearest
from ..signals import Constant
from ..vessel import Vessel
from ..waves import Waves
from .description import Coupling
from .schema import ModelSpec, Value

__all__ = ["PARTNERS", "Model", "Unit", "open_models", "wrong_values"]

REAL = ("Real", "Float64")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as an FMU defines it: exponents of the base units, and its size in them."""

    name: str
    exponents: tuple[int, ...]
    factor: float
    offset: float


@dataclass(frozen=True)
class Model:
    """One [[model]] with its FMU."""

    spec: ModelSpec
    path: Path
    folder: Path
    """Where the FMU is unpacked."""
    description: ModelDescription
    scene: Scene | None = None
    constants: Mapping[str, float] = field(default_factory=dict)
    """Constant inputs: of the file, or of its scene."""

    @property
    def name(self) -> str:
        return self.spec.name

    @property
    def fmi(self) -> int:
        return int(self.description.fmiVersion.split(".")[0])

    @cached_property
    def variables(self) -> dict[str, ModelVariable]:
        return {variable.name: variable for variable in self.description.modelVariables}

    def names(self, causality: str) -> list[str]:
        """Scalar real variables of this causality."""
        return [
            name for name, v in self.variables.items()
            if v.causality == causality and v.type in REAL and not v.dimensions
        ]  # fmt: skip

    @property
    def can_roll_back(self) -> bool:
        """Whether its complete state can be taken and put back."""
        return bool(self.description.coSimulation.canGetAndSetFMUstate)  # FMPy's name for both versions

    @property
    def can_vary_step(self) -> bool:
        return bool(self.description.coSimulation.canHandleVariableCommunicationStepSize)

    def slopes(self, name: str) -> list[str]:
        """Inputs that are the first and second derivative of an input, by the names that FMI has for such."""
        named = (f"der({name})", f"der({name},2)")
        return [slope for slope in named if slope in self.variables and self.variables[slope].causality == "input"]

    def interpolates(self, name: str) -> bool:
        """Whether an input may change inside a step: by its derivatives (FMI 2), or when asked for (FMI 3)."""
        if self.slopes(name):
            return True
        offered = self.description.coSimulation
        if self.fmi == 2:
            return bool(offered.canInterpolateInputs)
        return bool(offered.providesIntermediateUpdate) and name in self._updated

    @cached_property
    def _updated(self) -> set[str]:
        """Variables that can be set inside a step; FMPy does not read that attribute."""
        root = ET.parse(self.folder / "modelDescription.xml").getroot()
        return {v.attrib["name"] for v in root.iter() if v.get("intermediateUpdate") in ("true", "1")}

    def feedthrough(self, output: str) -> list[str]:
        """Inputs that an output depends on at once; all, where the description leaves it open."""
        inputs = self.names("input")
        for unknown in self.description.outputs:
            if unknown.variable.name == output and unknown.dependencies is not None:
                named = {variable.name for variable in unknown.dependencies}
                return [name for name in inputs if name in named]
        return inputs if self.spec.feedthrough else []

    def unit(self, name: str) -> Unit | None:
        """Of a variable; None where its FMU says nothing of it."""
        variable = self.variables[name]
        said = variable.unit or (variable.declaredType.unit if variable.declaredType else None)
        for unit in self.description.unitDefinitions:
            if unit.name == said:
                base = unit.baseUnit or BaseUnit()
                exponents = tuple(int(getattr(base, b) or 0) for b in ("kg", "m", "s", "A", "K", "mol", "cd", "rad"))
                return Unit(unit.name, exponents, float(base.factor or 1.0), float(base.offset or 0.0))
        return None

    def nominal(self, name: str) -> float:
        """Typical size of a variable; 1 where its FMU does not say it."""
        said = self.variables[name].nominal
        return abs(float(said)) if said is not None and float(said) else 1.0

    def terminal(self, name: str) -> dict[str, str]:
        """Variables of a terminal by the names of its members.

        Raises
        ------
        LookupError
            If there is none; with the names of those that there are.
        """
        file = self.folder / "terminalsAndIcons" / "terminalsAndIcons.xml"
        root = ET.parse(file).getroot() if file.is_file() else ET.Element("none")
        terminals = {terminal.attrib["name"]: terminal for terminal in root.iter("Terminal")}
        if name not in terminals:
            raise LookupError(nearest(name, terminals) if terminals else "its FMU has none")
        members = terminals[name].iter("TerminalMemberVariable")
        return {
            member.attrib.get("memberName", member.attrib["variableName"]): member.attrib["variableName"]
            for member in members
        }


def open_models(
    coupling: Coupling, folder: Path, mistakes: list[Mistake], platforms: Collection[str] | None
) -> dict[str, Model]:
    """Build (for these machines) or find every FMU, unpack it into `folder`; what is wrong is added to `mistakes`."""
    models: dict[str, Model] = {}
    for k, spec in enumerate(coupling.spec.model, start=1):
        try:
            model = _open(coupling, spec, folder, platforms)
        except (UserError, _RefusedError) as error:
            key = next(key for key in ("scene", "fmu", "partner", "vessel", "waves") if getattr(spec, key) is not None)
            mistakes.append(Mistake(f"model {k}.{key}", str(error)))  # which says what was named
            continue
        mistakes += [Mistake(f"model {k}.{key}", text, value) for key, text, value in wrong_values(model)]
        models[spec.name] = model
    return models


class _RefusedError(Exception):
    """One sentence on why an FMU cannot be had."""


def _open(coupling: Coupling, spec: ModelSpec, folder: Path, platforms: Collection[str] | None) -> Model:
    target, scene = folder / f"{spec.name}.fmu", None
    if spec.scene is not None:
        named = coupling.folder / spec.scene
        scene = load_scene(named if spec.scene.endswith(".toml") else spec.scene)
        path = build_fmu(scene, target, fmi=spec.fmi or 2, platforms=platforms)
    elif spec.partner is not None:
        path = _build_partner(spec.partner, target)
    elif spec.vessel is not None:
        path = build_vessel(_vessel(coupling, spec), target)
    elif spec.waves is not None:
        path = build_waves(Waves.from_table(spec.waves, name=spec.name, source=f"{spec.name}.waves"), target)
    else:
        assert spec.fmu is not None
        path = coupling.folder / spec.fmu
    if spec.fmi is not None and scene is None:
        raise _RefusedError("fmi is for scenes, whose FMUs are built; leave it out")
    description = _read(path)
    scene = scene or _scene_in(path)
    extract(str(path), unzipdir=str(folder / spec.name))
    constants = dict(spec.inputs)
    if scene is not None:
        held = {name: signal for name, signal in scene.signals.items() if isinstance(signal, Constant)}
        constants = {name: signal(0.0) for name, signal in held.items()} | constants
    return Model(spec, path, folder / spec.name, description, scene, constants)


def _read(path: Path) -> ModelDescription:
    if not path.is_file():
        raise _RefusedError(f"{path}: there is no such file")
    try:
        description = read_model_description(str(path), validate=False)
    except Exception as error:  # FMPy raises what its parsers raise
        raise _RefusedError(f"{path}: is not an FMU that can be read ({error})") from None
    if not description.fmiVersion.startswith(("2.", "3.")) or description.coSimulation is None:
        raise _RefusedError(f"{path}: Co-Simulation of FMI 2 or 3 is expected")
    return description


def _scene_in(path: Path) -> Scene | None:
    """The scene that an FMU of ours was made of; None for everybody else's."""
    try:
        return open_fmu(path).scene
    except FmuError:
        return None


PARTNERS = ("spring", "wave_force")
"""Partner FMUs that ship as scripts and are built as they are."""


def _vessel(coupling: Coupling, spec: ModelSpec) -> Vessel:
    """Bodies take the slopes of their inputs as inputs of their own, unless the table says otherwise."""
    table = spec.vessel or {}
    given = {"extrapolation": "given"} if table.get("kind") in ("body", "floating", "excitation") else {}
    return Vessel.from_table({**given, **table}, name=spec.name, folder=coupling.folder, source=f"{spec.name}.vessel")


def _build_partner(name: str, target: Path) -> Path:
    if name not in PARTNERS:
        raise _RefusedError(f'no partner "{name[:60]}" ships; {nearest(name, PARTNERS)}')
    with tempfile.TemporaryDirectory(prefix="cablefmu-") as folder:
        script = Path(folder) / f"{name}.py"
        script.write_bytes(partner_script(name))
        with without_traces(name):
            return Path(FmuBuilder.build_FMU(script, dest=target))


def wrong_values(model: Model) -> list[tuple[str, str, object]]:
    """Parameters and constant inputs that the FMU does not have, or not in that kind."""
    wrong: list[tuple[str, str, object]] = []
    settable = [n for n, v in model.variables.items() if v.causality != "input" and _can_be_set(v)]
    for name, value in model.spec.parameters.items():
        if name not in settable:
            said = nearest(name, settable) if settable else "its FMU has none"
            wrong.append((f"parameters.{name}", f"there is no such parameter or start value; {said}", value))
            continue
        refused = _refusal(model.variables[name], value)
        if refused:
            wrong.append((f"parameters.{name}", refused, value))
    inputs = model.names("input")
    for name, number in model.spec.inputs.items():
        if name not in inputs:
            said = nearest(name, inputs) if inputs else "its FMU has none"
            wrong.append((f"inputs.{name}", f"there is no such real input; {said}", number))
    return wrong


def _can_be_set(variable: ModelVariable) -> bool:
    if variable.dimensions or variable.variability == "constant" or variable.causality == "structuralParameter":
        return False
    return variable.causality == "parameter" or variable.initial in ("exact", "approx")


def _refusal(variable: ModelVariable, value: Value) -> str | None:
    """Why the value is none of this variable's."""
    if variable.type == "Enumeration":
        items = [item.name for item in variable.declaredType.items]
        return None if value in items else f"one of {', '.join(items)} is expected"
    expected = {"Boolean": (bool, "true or false"), "String": (str, "a text")}
    kind, text = expected.get(variable.type, ((int, float), "a number"))
    if variable.type not in (*REAL, *expected) and not isinstance(value, bool):
        kind, text = int, "a whole number"
    is_number = not isinstance(value, bool)
    if not isinstance(value, kind) or not (variable.type == "Boolean" or is_number):
        return f"{text} is expected"
    return None if isinstance(value, str) else _out_of_range(variable, float(value))


def _out_of_range(variable: ModelVariable, value: float) -> str | None:
    unit = f" [{variable.unit}]" if variable.unit else ""
    if not math.isfinite(value):
        return f"a finite number{unit} is expected"
    if variable.min is not None and value < float(variable.min):
        return f"at least {float(variable.min):g}{unit} is expected"
    if variable.max is not None and value > float(variable.max):
        return f"at most {float(variable.max):g}{unit} is expected"
    return None
