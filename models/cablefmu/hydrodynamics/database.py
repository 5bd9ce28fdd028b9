"""A body's hydrodynamic coefficients over frequency, read from NetCDF.

fmu_src/hydrodynamics/compute.py makes such files by Capytaine; another program may do the same. SI, x right, y down.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files

import numpy as np
import numpy.typing as npt
import xarray as xr

from ..cable import Floats

__all__ = ["SHIPPED", "DatabaseError", "Hydrodynamics", "read_database", "shipped_database"]

SHIPPED = ("buoy", "barge")
"""Bodies that ship."""

AXES = ("x", "y")
FEWEST_FREQUENCIES = 10
LARGEST_COUPLING = 0.01
"""Of surge and heave, as a part of the larger of what either has by itself: bodies alike fore and aft have none."""

_SHAPES = {
    "omega": ("omega",),
    "added_mass": ("omega", "dof", "radiating_dof"),
    "radiation_damping": ("omega", "dof", "radiating_dof"),
    "excitation": ("omega", "dof", "complex"),
    "added_mass_at_infinity": ("dof", "radiating_dof"),
    "hydrostatic_stiffness": ("dof",),
    "points": ("points",),
    "mass": (),
}


class DatabaseError(ValueError):
    """One sentence on what is wrong with a file of coefficients."""


@dataclass(frozen=True, eq=False)
class Hydrodynamics:
    """Surge (x) and heave (y) of a body that is alike fore and aft; arrays have the axes last."""

    omega: Floats
    """Angular frequencies, shape (k,), rising [rad/s]."""
    added_mass: Floats
    """Shape (k, 2) [kg]."""
    damping: Floats
    """Radiation damping, shape (k, 2) [N s/m]."""
    excitation: npt.NDArray[np.complex128]
    """X, shape (k, 2) [N/m]: in waves a cos(omega t - k x) the force is Re(X a e^(j omega t))."""
    added_mass_at_infinity: Floats
    """Shape (2,) [kg]."""
    stiffness: Floats
    """Hydrostatic, shape (2,) [N/m]."""
    mass: float
    """Displaced [kg]."""
    points: Floats
    """Where the body wants to know the elevation: places along x about its rest position, rising [m]."""
    gravity: float

    @property
    def memory(self) -> npt.NDArray[np.complex128]:
        """K(j omega) = B + j omega (A - A_infinity), shape (k, 2) [N s/m]."""
        return self.damping + 1j * self.omega[:, None] * (self.added_mass - self.added_mass_at_infinity)

    @property
    def wavenumber(self) -> Floats:
        """Of waves in deep water, shape (k,) [rad/m]."""
        return self.omega**2 / self.gravity


def shipped_database(name: str) -> bytes:
    """The file of a body that ships."""
    return (files("cablefmu") / "hydrodynamics" / "data" / f"{name}.nc").read_bytes()


@lru_cache(maxsize=16)
def read_database(data: bytes) -> Hydrodynamics:
    """Read a body's coefficients.

    Raises
    ------
    DatabaseError
        If it is no classic NetCDF, a variable is missing or has another shape, numbers are not finite or make no sense,
        the water is not deep, or surge and heave are coupled.
    """
    try:
        with xr.open_dataset(io.BytesIO(data), engine="scipy") as opened:
            held = opened.load()
    except Exception:  # scipy and xarray raise what they come across
        raise DatabaseError("this is no NetCDF file (classic, as xarray's engine scipy writes it)") from None
    values = {name: _variable(held, name) for name in _SHAPES}
    _check_numbers(values)
    depth, gravity = (_attribute(held, name) for name in ("water_depth", "gravity"))
    if depth != np.inf:
        raise DatabaseError(f"water_depth = {depth:g} m: deep water is expected (infinity)")
    if not 0.0 < gravity < np.inf:
        raise DatabaseError(f"gravity = {gravity:g}: a number above 0 [m/s2] is expected")
    real, imaginary = (values["excitation"][..., part] for part in range(2))
    return Hydrodynamics(
        omega=values["omega"], added_mass=_uncoupled("added_mass", values), damping=_uncoupled(
            "radiation_damping", values), excitation=real + 1j * imaginary,
        added_mass_at_infinity=_uncoupled("added_mass_at_infinity", values),
        stiffness=values["hydrostatic_stiffness"], mass=float(values["mass"]), points=values["points"], gravity=gravity,
    )  # fmt: skip


def _variable(held: xr.Dataset, name: str) -> Floats:
    if name not in held.variables:
        raise DatabaseError(f"the variable {name} is missing")
    found, dims = held[name], _SHAPES[name]
    sizes = {"dof": 2, "radiating_dof": 2, "complex": 2}
    if found.dims != dims or any(found.sizes[dim] != size for dim, size in sizes.items() if dim in dims):
        raise DatabaseError(f"{name} over {found.dims}: {dims} is expected, x and y, re and im")
    values = np.asarray(found.values, dtype=float)
    if not np.all(np.isfinite(values)):
        raise DatabaseError(f"{name}: finite numbers are expected")
    return values


def _attribute(held: xr.Dataset, name: str) -> float:
    try:
        return float(held.attrs[name])
    except (KeyError, TypeError, ValueError):
        raise DatabaseError(f"the attribute {name} is missing, or no number") from None


def _check_numbers(values: dict[str, Floats]) -> None:
    omega, damping = values["omega"], np.einsum("kii->ki", values["radiation_damping"])
    if len(omega) < FEWEST_FREQUENCIES or omega[0] <= 0.0 or np.any(np.diff(omega) <= 0.0):
        raise DatabaseError(f"omega: at least {FEWEST_FREQUENCIES} frequencies above 0 that rise are expected")
    if np.any(damping < -0.01 * np.max(np.abs(damping))):
        raise DatabaseError("radiation_damping: numbers of 0 or more are expected; waves carry energy away")
    if values["mass"] <= 0.0 or np.any(values["mass"] + np.diag(values["added_mass_at_infinity"]) <= 0.0):
        raise DatabaseError("mass: what moves must weigh more than 0, with its added mass")
    if np.any(values["hydrostatic_stiffness"] < 0.0):
        raise DatabaseError("hydrostatic_stiffness: numbers of 0 or more are expected")


def _uncoupled(name: str, values: dict[str, Floats]) -> Floats:
    """Diagonal of a matrix of surge and heave."""
    matrix = values[name]
    own: Floats = np.einsum("...ii->...i", matrix)
    across = np.max(np.abs(matrix - own[..., None] * np.eye(2)))
    if across > LARGEST_COUPLING * np.max(np.abs(own)):
        raise DatabaseError(f"{name}: surge and heave are coupled; a body that is alike fore and aft is expected")
    return own
