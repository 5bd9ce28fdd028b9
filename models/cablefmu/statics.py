"""Statics: where a cable rests, how it swings about that, and how stiff it is between its ends.

All of it in the kernel's O(n). A state of rest is a stable equilibrium under constant inputs: forces balance and the
tangent stiffness is positive definite. An anchor that is held by its mass alone stands still here, as a pin does: of
itself it would rest nowhere but below the floater. A vessel that moves an end stands still where its inputs have it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.sparse.linalg import LinearOperator, eigsh

from .cable import Cable, Floats, Terminal, Top
from .errors import OptionError, RunError
from .fmu.table import table
from .kernel import KernelModel, StaticsStatus
from .scene import Scene, load_scene
from .scene_inputs import FOLLOWING

__all__ = ["ENDS", "Equilibrium", "Modes", "What", "end_stiffness", "equilibrium", "modes"]

ENDS = ("x_top", "y_top", "x_end", "y_end")
"""Displacements of the cable's ends in the order of `end_stiffness`; x to the right, y down."""

MOST_MODES = 500
_DENSE = 200
"""Coordinates up to which all modes are worked out at once."""
_HELD = 1e20
"""Stiffness that does not let the top move [N/m]: no cable comes near it."""
_SINGULAR = 1e-12
"""Share of the larger compliance below which the smaller is rounding."""


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A cable at rest. SI; x to the right, y down, angles from the downward vertical, positive towards +x."""

    cable: Cable
    """With the parameters that were given; an anchor of mass as a pin where it stands"""
    inputs: Mapping[str, float]
    """Constant forces that it rests under, by name [N], and where vessels are [m]"""
    q: Floats
    """As `Cable.position`: heave of floater 1, link angles, surge, as far as there are any, shape (coordinates,)
    [m, rad]"""
    forces: Floats
    """Force through every node on what is below it, from the top joint to the terminal, shape (n + 1, 2) [N]"""
    residual: float
    """Largest acceleration left [m/s^2, rad/s^2]"""
    iterations: int
    """that the search took"""

    @property
    def heave(self) -> float:
        """Displacement of floater 1, or of the vessel at the top, positive down [m]."""
        return self.top[1]

    @property
    def top(self) -> tuple[float, float]:
        """Position of the top joint (x, y) [m]."""
        return _top_of(self.cable, self.q, self.inputs)

    @property
    def angles(self) -> Floats:
        """Link angles, shape (n,) [rad]."""
        return self.cable.angles_in(self.q)

    @property
    def points(self) -> Floats:
        """The nodes from the top joint to the terminal, shape (n + 1, 2) [m]."""
        top = np.array([self.top])
        return np.cumsum(np.vstack([top, self.cable.links.length[:, None] * self._along]), axis=0)

    @property
    def terminal(self) -> tuple[float, float]:
        """Position of the terminal (x, y) [m]."""
        x, y = self.points[-1]
        return float(x), float(y)

    @property
    def tensions(self) -> Floats:
        """Pull along every link at its upper and lower end, shape (n, 2) [N]; negative in compression."""
        upper = -np.sum(self.forces[:-1] * self._along, axis=1)
        lower = -np.sum(self.forces[1:] * self._along, axis=1)
        return np.column_stack([upper, lower])

    @property
    def _along(self) -> Floats:
        return np.column_stack([np.sin(self.angles), np.cos(self.angles)])


@dataclass(frozen=True, eq=False)
class Modes:
    """Small undamped motions about an equilibrium, the slowest first."""

    equilibrium: Equilibrium
    pulsation: Floats
    """shape (modes,) [rad/s]"""
    shapes: Floats
    """As `Equilibrium.q` of each, shape (modes, coordinates) [m, rad], per sqrt(kg) m: modal masses are 1 kg m^2"""

    @property
    def frequency(self) -> Floats:
        """shape (modes,) [Hz]"""
        return self.pulsation / (2.0 * np.pi)


What = Scene | Cable | Equilibrium | str | Path
"""What can be asked about: a scene, its name or path, a cable, or an equilibrium that was found before."""


def equilibrium(
    what: What, inputs: Mapping[str, float] | None = None, parameters: Mapping[str, float] | None = None
) -> Equilibrium:
    """Find a stable equilibrium near the start shape.

    Parameters
    ----------
    what
        A scene, the name of one that ships, the path of a TOML file, a cable, or an equilibrium to start from.
    inputs
        Constant forces by name [N], and where vessels are [m]; those of the start where one is not named.
    parameters
        Values of the cable's parameters by name, SI. What a scene derived at build time stays.

    Raises
    ------
    SceneError
        If the scene is not in order.
    OptionError
        An input or parameter that this cable does not have, or a value out of range.
    RunError
        If the forces cannot be balanced, or hold the cable nowhere.
    """
    cable, forces = _cable_of(what, inputs or {}, parameters or {})
    model = KernelModel(cable)
    found = model.equilibrium(cable.position, forces)
    if found.status is not StaticsStatus.OK:
        why = "the forces could not be balanced"
        if found.status is StaticsStatus.NOT_FINITE:
            why = "forces or angles went beyond the range of numbers"
        left = (
            f"the largest acceleration left is {found.residual:.3g} m/s2 or rad/s2; " if found.residual < 1e300 else ""
        )
        raise RunError(
            f"no stable equilibrium was found near the start shape: {why} in {found.iterations} iterations; {left}"
            "other inputs, parameters or start angles are expected"
        )
    rest = model.rest(found.q, forces)
    return Equilibrium(cable, forces, found.q, rest.forces, found.residual, found.iterations)


def modes(
    what: What,
    inputs: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    *,
    count: int = 6,
) -> Modes:
    """Find natural frequencies and mode shapes about a stable equilibrium, without drag and dampers.

    Parameters
    ----------
    what, inputs, parameters
        As for `equilibrium`; an equilibrium is taken as it is unless something else is given.
    count
        How many, the slowest first; fewer where the cable has fewer.

    Raises
    ------
    SceneError, OptionError, RunError
        As `equilibrium` does, OptionError for a count that is not 1 to 500, RunError where rounding hides the modes.

    Notes
    -----
    K shape = pulsation^2 M shape with the tangent stiffness K and the inertia matrix M; a pinned end stays where it is.
    Long cables: Lanczos on the inverse of K (ARPACK's shift and invert about 0), each step of which is one O(n) solve.
    """
    if not 1 <= count <= MOST_MODES:
        raise OptionError(f"count = {count}: 1 to {MOST_MODES} modes are expected")
    found = _settled(what, inputs, parameters)
    model = KernelModel(found.cable)
    model.rest(found.q, found.inputs)
    squares, shapes = (_dense_modes if found.cable.n < _DENSE else _sparse_modes)(model, found, count)
    if not np.all(squares > 0.0):
        raise RunError(
            "the slowest modes drown in rounding: stiffnesses and forces are too many orders of magnitude apart"
        )
    largest = np.argmax(np.abs(shapes), axis=1)
    signs = np.sign(shapes[np.arange(len(shapes)), largest])
    return Modes(found, np.sqrt(squares), shapes * signs[:, None])


def end_stiffness(
    what: What, inputs: Mapping[str, float] | None = None, parameters: Mapping[str, float] | None = None
) -> Floats:
    """Find the forces that it takes to move the ends of a cable at rest a little, both being held.

    Parameters
    ----------
    what, inputs, parameters
        As for `modes`.

    Returns
    -------
    array, shape (4, 4) [N/m]
        Forces on the cable at (top x, top y, terminal x, terminal y) per displacement of the same; symmetric.
        Of the cable alone: what holds its ends (floaters, springs, masses) is not in it.

    Raises
    ------
    SceneError, OptionError, RunError
        As `equilibrium` does, and RunError for a cable that is straight between its ends: links do not stretch.

    Notes
    -----
    With the top fixed and the end let go under the force F that holds it, as a dead load, the tangent stiffness K of
    the angles and J = dP_n/dth give the end's compliance C = J K^-1 J^T, from two solves with unit forces. As weights
    do not change with place, moving both ends alike takes no force, and of k = C^-1 all else follows:
    [[k, -k], [-k, k]].
    """
    found = _settled(what, inputs, parameters)
    cable, forces = _with_a_free_end(found)
    model = KernelModel(cable)
    model.rest(cable.position, forces)
    negative = model.factor(stiffness=1.0, mass=0.0)
    unit = _end_jacobian(cable, cable.position)
    unit[:, 0] = 0.0  # the top does not move
    compliance = np.array([unit @ model.solve(force).change for force in unit]) if negative >= 0 else np.zeros((2, 2))
    compliance = 0.5 * (compliance + compliance.T)
    sizes = np.sort(np.abs(np.linalg.eigvalsh(compliance)))
    if not (np.all(np.isfinite(compliance)) and sizes[0] > _SINGULAR * sizes[1]):
        raise RunError(
            "the cable is straight between its ends, and its links do not stretch: there is no end stiffness along it"
        )
    k = np.linalg.inv(compliance)
    return np.block([[k, -k], [-k, k]])


# --- what is asked about ---


def _cable_of(
    what: What, inputs: Mapping[str, float], parameters: Mapping[str, float]
) -> tuple[Cable, dict[str, float]]:
    """The cable with its parameters, an anchor of mass as a pin, and all its inputs."""
    if isinstance(what, Equilibrium):
        cable, forces = replace(what.cable, position=what.q), dict(what.inputs)
    else:
        cable = what if isinstance(what, Cable) else (what if isinstance(what, Scene) else load_scene(what)).cable
        # At rest a vessel stands still.
        forces = {name: 0.0 if name in FOLLOWING else cable.input_start.get(name, 0.0) for name in cable.inputs}
    for name, value in parameters.items():
        _check_parameter(cable, name, value)
    for name in FOLLOWING:
        if inputs.get(name, 0.0) != 0.0:
            place = FOLLOWING[name][0]
            raise OptionError(f"input {name} = {inputs[name]}: at rest a vessel stands still; {place} says where")
    cable = replace(cable, parameters=cable.parameters | dict(parameters))
    if cable.terminal is Terminal.ANCHOR_MASS:
        x, y = _end_of(cable, cable.position, forces | dict(inputs))
        left = {name: value for name, value in cable.parameters.items() if name != "m_c"}
        cable = replace(cable, terminal=Terminal.PIN, rest_position=(x, y), parameters=left)
    return cable, forces | dict(inputs)


def _check_parameter(cable: Cable, name: str, value: float) -> None:
    if name not in cable.parameters:
        raise OptionError(f"parameter {name}: this cable has no such parameter; it has {', '.join(cable.parameters)}")
    row = table().parameters[name]
    if not np.isfinite(value):
        raise OptionError(f"parameter {name} = {value}: a finite number [{row.unit}] is expected")
    if value < float(row.least) or (row.least == "+0" and value == 0.0):
        expected = "a number above 0" if row.least == "+0" else f"a number of {row.least} or more"
        raise OptionError(f"parameter {name} = {value}: {expected} [{row.unit}] is expected")


def _settled(what: What, inputs: Mapping[str, float] | None, parameters: Mapping[str, float] | None) -> Equilibrium:
    if isinstance(what, Equilibrium) and not inputs and not parameters:
        return what
    return equilibrium(what, inputs, parameters)


def _top_of(cable: Cable, q: Floats, inputs: Mapping[str, float]) -> tuple[float, float]:
    """P_0, of a floater in q and of a vessel among the inputs [m]."""
    x, y = replace(cable, position=q, input_start=dict(inputs)).start_of_top
    return float(x), float(y)


def _end_of(cable: Cable, q: Floats, inputs: Mapping[str, float]) -> tuple[float, float]:
    length, angles = cable.links.length, cable.angles_in(q)
    x, y = _top_of(cable, q, inputs)
    return x + float(length @ np.sin(angles)), y + float(length @ np.cos(angles))


def _end_jacobian(cable: Cable, q: Floats) -> Floats:
    """dP_n/dq, shape (2, coordinates)."""
    length, angles = cable.links.length, cable.angles_in(q)
    of_links = np.array([length * np.cos(angles), -length * np.sin(angles)])
    heave = [] if cable.top is Top.MOTION else [[[0.0], [1.0]]]
    surge = [[[1.0], [0.0]]] if cable.top is Top.FREE else []
    return np.hstack([*heave, of_links, *surge])


# --- modes ---


def _dense_modes(model: KernelModel, found: Equilibrium, count: int) -> tuple[Floats, Floats]:
    """Squared pulsations, and shapes in rows."""
    units = np.eye(found.cable.coordinates)
    stiffness = np.array([model.product(unit, stiffness=1.0, mass=0.0) for unit in units])
    mass = np.array([model.product(unit, stiffness=0.0, mass=1.0) for unit in units])
    is_held = found.cable.terminal in (Terminal.PIN, Terminal.MOTION)
    basis = null_space(_end_jacobian(found.cable, found.q)) if is_held else units
    if basis.shape[1] == 0:
        return np.empty(0), np.empty((0, found.cable.coordinates))
    k, m = (basis.T @ (0.5 * (matrix + matrix.T)) @ basis for matrix in (stiffness, mass))
    squares, shapes = eigh(k, m, subset_by_index=(0, min(count, len(k)) - 1))
    return squares, (basis @ shapes).T


def _sparse_modes(model: KernelModel, found: Equilibrium, count: int) -> tuple[Floats, Floats]:
    """The same for many coordinates. Solutions hold a pinned end by themselves, so that no basis is needed."""
    size = found.cable.coordinates
    if model.factor(stiffness=1.0, mass=0.0) != 0:
        raise RunError(
            "the tangent stiffness at this equilibrium is not positive definite; there are no modes about it"
        )

    def operator(apply: Callable[[Floats], Floats]) -> LinearOperator:
        return LinearOperator((size, size), matvec=lambda v: apply(np.ravel(v)), dtype=np.float64)

    inverse = operator(lambda force: model.solve(force).change)
    squares, shapes = eigsh(
        operator(lambda change: model.product(change, stiffness=1.0, mass=0.0)),
        k=min(count, size - 3),
        M=operator(lambda change: model.product(change, stiffness=0.0, mass=1.0)),
        sigma=0.0,
        OPinv=inverse,
        v0=model.solve(np.random.default_rng(0).standard_normal(size)).change,
    )
    order = np.argsort(squares)
    return squares[order], shapes.T[order]


# --- end stiffness ---


def _with_a_free_end(found: Equilibrium) -> tuple[Cable, dict[str, float]]:
    """The cable in the same shape with its top fixed at y = 0, its end free under the force that holds it."""
    kept = ("g", "rho_w", "Cd", "k_joint", "c_joint")
    given = found.cable.parameters
    mass = float(found.cable.links.mass[-1])  # any that is not out of proportion: it weighs, and is made up for
    top, end = -found.forces[0], -found.forces[-1]
    cable = replace(
        found.cable,
        top=Top.FLOATER,
        terminal=Terminal.LOAD,
        rest_position=(0.0, 0.0),
        parameters={name: given[name] for name in kept if name in given}
        | {"M_1": 1.0, "k_m1": _HELD, "c_m1": 0.0, "static_load": float(top[1]), "m_c": mass},
        inputs=("u_m1", "F_cx", "F_cy"),
        position=np.append(0.0, found.angles),
    )
    return cable, {"F_cx": float(end[0]), "F_cy": float(end[1]) - mass * given["g"]}
