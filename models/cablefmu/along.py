"""What is found along the cable once a run is over: where its nodes are, and how hard every link is pulled.

Neither is a variable of the FMU, whose size and speed do not depend on them. Nodes follow from the recorded angles,
pulls from the recorded states and inputs by the kernel's own right-hand side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from .cable import Cable, Floats, Top
from .kernel import KernelModel

__all__ = ["ALONG", "along_of", "node_positions", "picture_needs", "states_for"]

ALONG = ("nodes", "tensions")
"""What `record` takes besides variables: `node_x`, `node_y` over (time, node), and `tension` over (time, link)."""

_RATES = {"y_m1": "v_m1", "x_m1": "vx_m1"}


def picture_needs(cable: Cable) -> tuple[str, ...]:
    """What a run must record for the places of the nodes: link angles and where the top is."""
    top = {Top.FLOATER: ("y_m1",), Top.FREE: ("x_m1", "y_m1"), Top.MOTION: ("x_1", "y_1")}[cable.top]
    return ("theta", *top)


def states_for(cable: Cable, wanted: Sequence[str]) -> tuple[str, ...]:
    """Variables that a run must record so that `along_of` finds what is wanted of `ALONG`."""
    names: list[str] = []
    if "nodes" in wanted:
        names += picture_needs(cable)
    if "tensions" in wanted:
        names += [*_halves(cable)[0], *_halves(cable)[1], *cable.inputs]
    return tuple(dict.fromkeys(names))


def _halves(cable: Cable) -> tuple[list[str], list[str]]:
    """q and dq/dt by the names of their parts."""
    places = list(dict.fromkeys(name.partition("[")[0] for name in cable.coordinate_names))
    return places, [_RATES.get(name, "omega") for name in places]


def along_of(recorded: xr.Dataset, cable: Cable, given: Mapping[str, float | str], wanted: Sequence[str]) -> xr.Dataset:
    """Nodes and pulls of a run.

    Parameters
    ----------
    recorded
        Of that run, with the variables of `states_for`.
    cable
        The scene's.
    given
        What was set on its FMU; parameters among it count.
    wanted
        Of `ALONG`; without any the Dataset is empty.

    Returns
    -------
    xarray.Dataset
        `node_x`, `node_y` [m] over (time, node), P_0 ... P_n; `tension` [N] over (time, link): the larger of the pulls
        at both ends of a link, -R_i . e_i and -R_{i+1} . e_i, so that its largest along the cable is `tension_max`.
    """
    result = xr.Dataset()
    if "nodes" in wanted:
        numbers = np.arange(cable.n + 1)
        result = result.assign_coords(node=("node", numbers, {"long_name": "Node, 0 at the top, i below link i"}))
        for name, values, sign in zip(("x", "y"), node_positions(recorded), ("to the right", "down"), strict=True):
            text = f"Every node: {name}, {sign}, from the rest position of the top joint"
            result[f"node_{name}"] = (("time", "node"), values, {"units": "m", "long_name": text})
    if "tensions" in wanted:
        text = "Every link: pull along it, at that of its ends where it is larger; negative where it is pressed"
        pull = link_tensions(recorded, cable, given)
        result = result.assign_coords({name: recorded[name] for name in ("link", "link_length")})
        result["tension"] = (("time", "link"), pull, {"units": "N", "long_name": text})
    return result.assign_coords(time=recorded["time"]) if result.variables else result


def node_positions(result: xr.Dataset) -> tuple[Floats, Floats]:
    """Positions of P_0 ... P_n over time, as they were recorded or from recorded angles.

    Parameters
    ----------
    result
        With `node_x` and `node_y`, or with `theta` over (time, link) and where the top is, as
        `simulate(..., record=picture_needs(cable))` gives them.

    Returns
    -------
    x, y
        Each of shape (times, n + 1) [m]; P_0 = (x_m1, y_m1) or (x_1, y_1), P_i = P_{i-1} + l_i (sin th_i, cos th_i).
    """
    if "node_x" in result and "node_y" in result:
        return result["node_x"].values, result["node_y"].values
    length, theta = result["link_length"].values, result["theta"].values
    nothing = np.zeros(len(theta))
    x, y = (
        next((result[name].values for name in names if name in result), nothing)[:, None]
        + np.hstack([nothing[:, None], np.cumsum(length * along(theta), axis=1)])
        for names, along in ((("x_m1", "x_1"), np.sin), (("y_m1", "y_1"), np.cos))
    )
    return x, y


def link_tensions(recorded: xr.Dataset, cable: Cable, given: Mapping[str, float | str]) -> Floats:
    """The larger of the pulls at both ends of every link, shape (times, n) [N]; arguments as for `along_of`."""
    numbers = {name: float(value) for name, value in given.items() if name in cable.parameters}
    model = KernelModel(replace(cable, parameters=cable.parameters | numbers))
    states = np.hstack([_columns(recorded, name) for half in _halves(cable) for name in half])
    inputs = [recorded[name].values for name in cable.inputs]
    pulls = [
        model.pulls(state, model.forces(dict(zip(cable.inputs, (values[k] for values in inputs), strict=True))))
        for k, state in enumerate(states)
    ]
    both: Floats = np.reshape(pulls, (len(states), cable.n, 2))
    return np.asarray(both.max(axis=-1))


def _columns(recorded: xr.Dataset, name: str) -> Floats:
    return np.asarray(recorded[name].values.reshape(recorded.sizes["time"], -1))
