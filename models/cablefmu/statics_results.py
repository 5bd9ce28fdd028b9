"""Modes and end stiffness as a Dataset and as tables on disk, beside the results of a run."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from .cable import Cable, Floats
from .files import replacing
from .scene import Scene
from .statics import ENDS, Equilibrium, Modes, end_stiffness, equilibrium, modes

__all__ = ["STATICS_GROUPS", "is_over_time", "joined", "read_statics", "statics_dataset", "write_statics"]

STATICS_GROUPS = ("modes", "stiffness")
"""What `record` takes besides variables: both are about the equilibrium for the inputs of the start."""


def statics_dataset(scene: Scene, given: Mapping[str, float | str], wanted: Sequence[str]) -> xr.Dataset:
    """Modes and end stiffness of a scene about its equilibrium for the inputs of the start.

    Parameters
    ----------
    scene
        The scene.
    given
        Values of parameters, inputs and start values by name, as they are set on its FMU.
    wanted
        Of `STATICS_GROUPS`; without any the Dataset is empty.

    Returns
    -------
    xarray.Dataset
        "modes": `frequency` [Hz], `mode_heave`, `mode_surge` where floater 1 has them, `mode_shape` over `mode` and
        `link`; "stiffness": `end_stiffness`
        [N/m] over `end_force` and `end_displacement`.

    Raises
    ------
    RunError
        Where there is no stable equilibrium, or no end stiffness.
    """
    result = xr.Dataset()
    if not wanted:
        return result
    cable = scene.cable
    numbers = {name: float(value) for name, value in given.items() if not isinstance(value, str)}
    inputs = {name: value for name, value in numbers.items() if name in cable.inputs}
    parameters = {name: value for name, value in numbers.items() if name in cable.parameters}
    found = equilibrium(_moved(cable, numbers), inputs, parameters)
    if "modes" in wanted:
        result = joined(result, _modes(modes(found)))
    if "stiffness" in wanted:
        result = joined(result, _stiffness(found))
    return result


def joined(result: xr.Dataset, more: xr.Dataset) -> xr.Dataset:
    """Both in one; what they share, which is links, is the same in both."""
    return result.merge(more, compat="override", join="exact", combine_attrs="override")


def _moved(cable: Cable, given: Mapping[str, float]) -> Cable:
    """With the start values that were given: where the search begins."""
    position = cable.position.copy()
    for k, name in enumerate(cable.coordinate_names):
        position[k] = given.get(name, position[k])
    return replace(cable, position=position)


_OF_FLOATER = {
    "y_m1": ("mode_heave", "Heave", "positive down"),
    "x_m1": ("mode_surge", "Surge", "positive to the right"),
}


def _modes(found: Modes) -> xr.Dataset:
    about = "about the equilibrium for the inputs of the start"
    cable = found.equilibrium.cable
    column = dict(zip(cable.coordinate_names, found.shapes.T, strict=True))
    ends = {
        name: (
            "mode",
            column[key],
            {"units": "m", "long_name": f"{what} of floater 1 {about}, modal mass 1 kg m2, {sign}"},
        )
        for key, (name, what, sign) in _OF_FLOATER.items()
        if key in column
    }
    return xr.Dataset(
        {
            "frequency": (
                "mode", found.frequency, {"units": "Hz", "long_name": f"Undamped natural frequency {about}"},
            ),
            **ends,
            "mode_shape": (
                ("mode", "link"), cable.angles_in(found.shapes.T).T,
                {"units": "rad", "long_name": f"Link angles {about}, modal mass 1 kg m2, positive towards +x"},
            ),
        },
        coords={
            "mode": ("mode", np.arange(1, len(found.pulsation) + 1), {"long_name": "Mode, the slowest first"}),
            "link": ("link", np.arange(1, cable.n + 1), {"long_name": "Link, 1 at the top"}),
            "link_length": ("link", cable.links.length, {"units": "m", "long_name": "Length of the link"}),
        },
    )  # fmt: skip


def _stiffness(found: Equilibrium) -> xr.Dataset:
    told = "Forces on the cable's ends per displacement of them, both held; x right, y down"
    values = (("end_force", "end_displacement"), end_stiffness(found), {"units": "N/m", "long_name": told})
    return xr.Dataset({"end_stiffness": values}, coords={"end_force": list(ENDS), "end_displacement": list(ENDS)})


def is_over_time(variable: xr.DataArray) -> bool:
    """Whether a variable of a result belongs into the table over time."""
    return "time" in variable.dims


def write_statics(result: xr.Dataset, path: Path) -> list[Path]:
    """Write NAME.modes.csv and NAME.stiffness.csv beside the CSV `path`, as far as the result holds them.

    Every number to the last bit; a file is complete before it takes an old one's place.

    Raises
    ------
    OptionError
        If a file cannot be written.
    """
    written = []
    if "frequency" in result:
        of_floater = {key: name for key, (name, _, _) in _OF_FLOATER.items() if name in result}
        shapes = np.column_stack(
            [result["frequency"], *(result[name] for name in of_floater.values()), result["mode_shape"]]
        )
        head = ["mode", "frequency", *of_floater, *(f"theta[{link}]" for link in result["link"].values)]
        rows = [[number, *row] for number, row in zip(result["mode"].values.tolist(), shapes.tolist(), strict=True)]
        written.append(_write(path.with_suffix(".modes.csv"), [head, *rows]))
    if "end_stiffness" in result:
        matrix = result["end_stiffness"].values.tolist()
        rows = [[name, *row] for name, row in zip(ENDS, matrix, strict=True)]
        written.append(_write(path.with_suffix(".stiffness.csv"), [["force", *ENDS], *rows]))
    return written


def read_statics(path: Path) -> dict[str, Floats]:
    """What `write_statics` wrote beside the CSV `path`, as far as it is there: values by the names of variables."""
    values: dict[str, Floats] = {}
    if (modes_file := path.with_suffix(".modes.csv")).is_file():
        head, numbers = _read(modes_file)
        of_floater = {name: numbers[:, head.index(key)] for key, (name, _, _) in _OF_FLOATER.items() if key in head}
        values |= {"frequency": numbers[:, 1], **of_floater, "mode_shape": numbers[:, 2 + len(of_floater) :]}
    if (stiffness_file := path.with_suffix(".stiffness.csv")).is_file():
        values["end_stiffness"] = _read(stiffness_file)[1][:, 1:]
    return values


def _read(path: Path) -> tuple[list[str], Floats]:
    """Head and rows, with zeros for the first column, which counts or names them."""
    with path.open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    numbers = [[0.0, *map(float, row[1:])] for row in rows]
    return head, np.array(numbers).reshape(len(rows), len(head))


def _write(path: Path, rows: Sequence[Sequence[object]]) -> Path:
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([repr(cell) if isinstance(cell, float) else cell for cell in row] for row in rows)
    return path
