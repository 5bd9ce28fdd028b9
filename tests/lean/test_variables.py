"""What a scene does not have is in neither version's description, and no accessor of the resource file leads to it."""

from __future__ import annotations

import struct
from collections import Counter
from pathlib import Path

import pytest
from fmpy import read_model_description

from cablefmu.cable import Top
from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.resource import resource_bytes
from cablefmu.fmu.table import table
from cablefmu.fmu.variables import Kind, variables_of
from cablefmu.scene import Scene
from tests.lean.features import ENDS, FEATURES, scene_pair


def described(scene: Scene, folder: Path, fmi: int) -> list[str]:
    """Names in the order of the archive's modelDescription.xml, as FMPy reads them; in FMI 2 time is none."""
    path = build_fmu(scene, folder / f"{scene.name}-{fmi}.fmu", fmi=fmi)
    names = [variable.name for variable in read_model_description(str(path), validate=False).modelVariables]
    return names if fmi == 3 else ["time", *names]


def accessed(scene: Scene) -> list[str]:
    """What the resource file's accessors lead to, read as the kernel reads it: (kind, index) pairs at its end."""
    variables = variables_of(scene.cable, scene.dropped_outputs)
    content = resource_bytes(scene.cable, variables)
    surges = scene.cable.top is Top.FREE
    q = [
        "y_m1",
        *(f"theta[{i}]" for i in range(1, 6)),
        *["x_m1"][:surges],
    ]  # with a place for a heave that there is not
    states = [*q, "v_m1", *(f"omega[{i}]" for i in range(1, 6)), *["vx_m1"][:surges]]
    rows = table()
    names = {
        Kind.TIME: ["time"], Kind.PARAMETER: list(rows.parameters), Kind.INPUT: list(rows.inputs), Kind.STATE: states,
        Kind.DERIVATIVE: [f"der({name})" for name in states], Kind.OUTPUT: list(rows.outputs),
        Kind.SOLVER: list(rows.solver), Kind.SOLVER_CHOICE: ["solver"], Kind.STATICS: list(rows.statics),
    }  # fmt: skip
    pairs = struct.iter_unpack("<II", content[-8 * len(variables) :])
    return [names[Kind(kind)][index] for kind, index in pairs]


def present(scene: Scene) -> set[str]:
    """Parameters whose bit is set in the resource file: those alone can differ from what the scene says."""
    (bits,) = struct.unpack_from("<Q", resource_bytes(scene.cable, []), 24)
    return {name for name, row in table().parameters.items() if bits >> row.slot & 1}


@pytest.mark.parametrize("name", FEATURES | ENDS)
def test_a_scene_without_a_feature_has_none_of_its_variables(tmp_path: Path, name: str) -> None:
    """The lists differ by exactly the feature's variables, in FMI 2, in FMI 3 and in the accessors."""
    feature = (FEATURES | ENDS)[name]
    having, lacking = scene_pair(name)
    for fmi in (2, 3):
        whole, rest = described(having, tmp_path, fmi), described(lacking, tmp_path, fmi)
        assert Counter(whole) - Counter(rest) == Counter(feature.gone)
        assert Counter(rest) - Counter(whole) == Counter(feature.come)
        assert whole == accessed(having)
        assert rest == accessed(lacking)
    for scene in (having, lacking):
        assert present(scene) == set(accessed(scene)) & set(table().parameters)


@pytest.mark.parametrize("name", ["y_m1", "v_m1"])
def test_a_state_that_is_no_output_is_only_a_state(name: str) -> None:
    having, _ = scene_pair("water")
    dropped = {v.name: v.causality for v in variables_of(having.cable, [name])}
    assert dropped[name] == "local"
    assert (
        list(dropped.values()).count("output")
        == len(table().outputs) - len(having.cable.absent_outputs) + len(table().solver) - 1
    )
