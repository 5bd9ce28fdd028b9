"""The compiled kernel without an FMU: its right-hand side, statics, and a cable linearised about a state of rest.

The library is named kernel and lies beside the FMU's own; it never travels in an archive. Vectors are as long
as q of `Cable`: the top's coordinates [m] and the link angles [rad], forces likewise [N], [N m]; x right, y down.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from importlib.resources import as_file
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .cable import Cable, Drag, Floats, Terminal, Top
from .errors import OptionError, RunError
from .fmu.platforms import PLATFORMS, this_platform
from .fmu.platforms import library as library_of
from .fmu.table import table
from .fmu.variables import outputs_of

__all__ = ["BINDINGS", "KernelModel", "Rest", "Search", "Solution", "StaticsStatus", "library"]

_POINTER, _INT, _DOUBLE = ctypes.c_void_p, ctypes.c_int, ctypes.c_double
_ARRAY = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")

BINDINGS: dict[str, tuple[Any, ...]] = {
    "kernel_new": (_POINTER, _INT, _INT, _INT, _INT, ctypes.c_uint64, _ARRAY, _ARRAY, _ARRAY),
    "kernel_free": (None, _POINTER),
    "kernel_derivatives": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "kernel_outputs": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "kernel_pulls": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "kernel_equilibrium": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "kernel_rest": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    "kernel_factor": (_INT, _POINTER, _DOUBLE, _DOUBLE),
    "kernel_solve": (None, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "kernel_catenary": (_INT, _INT, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    "kernel_product": (None, _POINTER, _DOUBLE, _DOUBLE, _ARRAY, _ARRAY),
}
"""Function -> (type of the result, types of the arguments)."""

_WOUND_UP = "q: angles within 1.6e6 rad are expected"


class StaticsStatus(IntEnum):
    """How a search for equilibrium ended; the numbers are those of statics.h."""

    OK = 0
    NO_BALANCE = 1
    NOT_FINITE = 2


@dataclass(frozen=True, slots=True)
class Search:
    """What a search for equilibrium found."""

    status: StaticsStatus
    q: Floats
    """Where it ended, shape as q [m, rad]"""
    residual: float
    """Largest acceleration left there [m/s^2, rad/s^2]"""
    iterations: int


@dataclass(frozen=True, slots=True)
class Rest:
    """What acts at a state of rest."""

    forces: Floats
    """R through every node, on what is below it, shape (n + 1, 2) [N]; the last is what the terminal gives"""
    acceleration: Floats
    """What is not balanced, shape as q [m/s^2, rad/s^2]"""


@dataclass(frozen=True, slots=True)
class Solution:
    """Of a linear system."""

    change: Floats
    """shape as q"""
    through: Floats
    """The force that a pinned end takes for it, shape (2,) [N]; zeros for other ends"""


@cache
def library() -> ctypes.CDLL:
    """The library with every function of `BINDINGS` typed.

    Raises
    ------
    RunError
        Where the package has none for this machine.
    """
    machine = this_platform()
    source = library_of("kernel", machine) if machine in PLATFORMS else None
    if source is None or not source.is_file():
        raise RunError(f"this installation has no compiled kernel for {machine}; statics and modes need it")
    with as_file(source) as path:
        loaded = ctypes.CDLL(str(path))
    for name, (result, *arguments) in BINDINGS.items():
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    return loaded


class KernelModel:
    """One cable in the kernel.

    Parameters
    ----------
    cable
        Its parameters are read once, here.

    Raises
    ------
    RunError
        Where the package has no kernel for this machine, or there is no memory.
    """

    def __init__(self, cable: Cable) -> None:
        rows, links = table(), cable.links
        self.cable = cable
        # the order of LinkColumn in model.h; the library keeps a pointer to it
        self._links = np.array([
            links.length, links.mass, links.inertia, links.volume,
            links.joint_stiffness, links.joint_damping, links.drag_area, links.drag,
        ], dtype=np.float64)  # fmt: skip
        self._library = library()
        self._handle = self._library.kernel_new(
            cable.n,
            list(Top).index(cable.top),
            list(Terminal).index(cable.terminal),
            list(Drag).index(cable.drag),
            sum(1 << rows.parameters[name].slot for name in cable.parameters),
            np.array([cable.parameters.get(name, 0.0) for name in rows.parameters], dtype=np.float64),
            np.array(cable.rest_position, dtype=np.float64),
            self._links,
        )
        if not self._handle:
            raise RunError("out of memory")

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._library.kernel_free(self._handle)

    def forces(self, inputs: Mapping[str, float]) -> Floats:
        """Inputs by name [N] as `derivatives` and `outputs` take them: a slot for every input that any scene may have.

        Raises
        ------
        OptionError
            An input that the cable does not have, or a value that is not finite.
        """
        return self._inputs(inputs)

    def derivatives(self, x: Floats, forces: Floats) -> Floats:
        """Evaluate x' = f(x, u) as the FMU does, for x = (q, v) and `forces` as above.

        NaN where `x` is not finite or an angle is beyond 1.6e6 rad: an integrator's trial step that went too far.

        Raises
        ------
        OptionError
            A wrong shape.
        """
        if x.shape != (2 * self.cable.coordinates,):
            raise OptionError(f"x: shape ({2 * self.cable.coordinates},) is expected, got {x.shape}")
        padded = self._padded(x)
        derivative = np.empty_like(padded)
        if not self._library.kernel_derivatives(self._handle, padded, forces, derivative):
            derivative.fill(np.nan)
        return self.cable.unpadded(derivative)

    def outputs(self, x: Floats, forces: Floats) -> dict[str, float]:
        """Evaluate every output that the cable has by its FMI name, for x and `forces` as `derivatives` takes them.

        Raises
        ------
        OptionError
            A wrong shape, a value that is not finite, or an angle beyond 1.6e6 rad.
        """
        values = np.zeros(len(table().outputs))
        if not self._library.kernel_outputs(self._handle, self._state(x), forces, values):
            raise OptionError(_WOUND_UP)
        rows = table().outputs
        return {name: float(values[rows[name].slot]) for name in outputs_of(self.cable)}

    def pulls(self, x: Floats, forces: Floats) -> Floats:
        """Evaluate the pull in every link for x and `forces` as `derivatives` takes them.

        Returns
        -------
        Shape (n, 2) [N]: -R_i . e_i at its upper end and -R_{i+1} . e_i at its lower one; negative where it is pressed.

        Raises
        ------
        OptionError
            A wrong shape, a value that is not finite, or an angle beyond 1.6e6 rad.
        """
        ends = np.empty((2, self.cable.n))
        if not self._library.kernel_pulls(self._handle, self._state(x), forces, ends):
            raise OptionError(_WOUND_UP)
        return ends.T.copy()

    def equilibrium(self, q: ArrayLike, inputs: Mapping[str, float]) -> Search:
        """Search for a stable equilibrium near `q` under inputs by name [N].

        Raises
        ------
        OptionError
            A wrong shape, a value that is not finite, or an angle beyond 1.6e6 rad.
        """
        found, figures = self._vector("q", q).copy(), np.zeros(2)
        status = self._library.kernel_equilibrium(self._handle, self._inputs(inputs), found, figures)
        if status < 0:
            raise OptionError(_WOUND_UP)
        return Search(StaticsStatus(status), self.cable.unpadded(found), float(figures[0]), int(figures[1]))

    def rest(self, q: ArrayLike, inputs: Mapping[str, float]) -> Rest:
        """Linearise about `q` at rest under inputs by name [N]; what follows is about this state.

        Raises
        ------
        OptionError
            A wrong shape, a value that is not finite, or an angle beyond 1.6e6 rad.
        """
        padded = self._vector("q", q)
        force, acceleration = np.zeros((2, self.cable.n + 1)), np.zeros_like(padded)
        arrays = self._inputs(inputs), padded
        if not self._library.kernel_rest(self._handle, *arrays, force, acceleration):
            raise OptionError(_WOUND_UP)
        return Rest(force.T.copy(), self.cable.unpadded(acceleration))

    def factor(self, *, stiffness: float, mass: float) -> int:
        """Factorise stiffness K + mass M in O(n); how many eigenvalues are negative, or -1 where it is singular.

        K is the tangent stiffness with the loads that stay as they are, M the inertia matrix.
        """
        return int(self._library.kernel_factor(self._handle, stiffness, mass))

    def solve(self, force: ArrayLike) -> Solution:
        """(stiffness K + mass M) change = force by the last `factor`, in O(n); a pinned end does not move.

        Raises
        ------
        OptionError
            A wrong shape, or a value that is not finite.
        """
        padded = self._vector("force", force)
        change, through = np.zeros_like(padded), np.zeros(2)
        self._library.kernel_solve(self._handle, padded, change, through)
        return Solution(self.cable.unpadded(change), through)

    def product(self, change: ArrayLike, *, stiffness: float, mass: float) -> Floats:
        """(stiffness K + mass M) change in O(n); what a pinned end takes is not in it.

        Raises
        ------
        OptionError
            A wrong shape, or a value that is not finite.
        """
        padded = self._vector("change", change)
        force = np.zeros_like(padded)
        self._library.kernel_product(self._handle, stiffness, mass, padded, force)
        return self.cable.unpadded(force)

    def _state(self, x: Floats) -> Floats:
        if x.shape != (2 * self.cable.coordinates,) or not np.all(np.isfinite(x)):
            raise OptionError(f"x: {2 * self.cable.coordinates} finite numbers are expected")
        return self._padded(x)

    def _vector(self, name: str, given: ArrayLike) -> Floats:
        vector = np.ascontiguousarray(given, dtype=np.float64)
        if vector.shape != (self.cable.coordinates,):
            raise OptionError(f"{name}: shape ({self.cable.coordinates},) is expected, got {vector.shape}")
        if not np.all(np.isfinite(vector)):
            raise OptionError(f"{name}: finite numbers are expected")
        return self._padded(vector)

    def _padded(self, vector: Floats) -> Floats:
        return np.ascontiguousarray(self.cable.padded(vector))

    def _inputs(self, inputs: Mapping[str, float]) -> Floats:
        """One slot for every input that any scene may have."""
        for name, force in inputs.items():
            if name not in self.cable.inputs:
                allowed = ", ".join(self.cable.inputs) or "none"
                raise OptionError(f"input {name}: this cable has no such input; it has {allowed}")
            if not np.isfinite(force):
                unit = table().inputs[name].unit
                raise OptionError(f"input {name} = {force}: a finite number [{unit}] is expected")
        return np.array([inputs.get(name, 0.0) for name in table().inputs], dtype=np.float64)
