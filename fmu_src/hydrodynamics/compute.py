"""Compute the hydrodynamic databases that ship, by Capytaine's linear potential flow.

    pip install -e '.[hydro]'
    python fmu_src/hydrodynamics/compute.py buoy barge

Each becomes a NetCDF file in models/cablefmu/hydrodynamics/data. Capytaine (GPL) is needed here alone: nothing of it is
in the package or in an FMU. Surge and heave in deep water; pitch is held. Results of the three meshes of a hull
converge with the first power of the size of their panels, because of the edges; what is stored is extrapolated from the
two finer ones, with the largest difference from the extrapolation of the two coarser ones as its error. Irregular
frequencies are removed by a lid on the water inside the hull, or lie above the band: a lid disturbs the barge's surge.
"""

from __future__ import annotations

import math
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import capytaine as cpt
import numpy as np
import numpy.typing as npt
import xarray as xr
from capytaine.bem.airy_waves import froude_krylov_force
from hulls import DENSITY, HULLS, Hull

DATA = Path(__file__).resolve().parents[2] / "models" / "cablefmu" / "hydrodynamics" / "data"
GRAVITY = 9.81

MODES = ("Surge", "Heave")
DOF = ("x", "y")
DOWN = np.array([1.0, -1.0])
"""Capytaine's z is up, our y down."""

Arrays = dict[str, npt.NDArray[Any]]


def solved(mesh: cpt.Mesh, omega: npt.NDArray[np.float64], lid_size: float | None) -> Arrays:
    """Added mass A and damping B (k, 2, 2), excitation X (k, 2) and A at infinite frequency (2, 2) of one mesh.

    X is complex: F(t) = Re(X a e^(j omega t)) in waves of elevation a cos(omega t - k x), x right, y down.
    """
    lid = None if lid_size is None else mesh.generate_lid(faces_max_radius=lid_size)
    body = cpt.FloatingBody(mesh=mesh, lid_mesh=lid)
    for mode in MODES:
        body.add_translation_dof(name=mode)
    sea = {"body": body, "rho": DENSITY, "g": GRAVITY, "water_depth": np.inf}
    solver = cpt.BEMSolver()
    turn = np.outer(DOWN, DOWN)

    def radiated(w: float) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        results = [solver.solve(cpt.RadiationProblem(radiating_dof=mode, omega=w, **sea)) for mode in MODES]
        mass, damping = (
            [[getattr(result, what)[mode] for result in results] for mode in MODES]
            for what in ("added_masses", "radiation_dampings")
        )
        return turn * np.array(mass), turn * np.array(damping)

    def excited(w: float) -> npt.NDArray[Any]:
        result = solver.solve(cpt.DiffractionProblem(omega=w, wave_direction=0.0, **sea))
        pressed = froude_krylov_force(result.problem)
        # Capytaine's e^(-j omega t) becomes our e^(j omega t).
        return DOWN * np.conj([result.forces[mode] + pressed[mode] for mode in MODES])

    mass, damping, excitation = zip(*((*radiated(w), excited(w)) for w in omega.tolist()), strict=True)
    return {
        "added_mass": np.array(mass),
        "radiation_damping": np.array(damping),
        "excitation": np.array(excitation),
        "added_mass_at_infinity": radiated(np.inf)[0],
    }


def extrapolated(coarse: Arrays, fine: Arrays, ratio: float) -> Arrays:
    """Where results go to that fall with the first power of the panels' size; `ratio` of n, fine to coarse."""
    return {name: (ratio * fine[name] - coarse[name]) / (ratio - 1.0) for name in fine}


def converged(hull: Hull, omega: npt.NDArray[np.float64]) -> tuple[Arrays, float]:
    """Extrapolated results, and their error as a part of each curve's largest value."""
    n = hull.fineness
    results = [solved(hull.mesh(k), omega, hull.lid and hull.lid / k) for k in n]
    earlier, later = (extrapolated(results[i], results[i + 1], n[i + 1] / n[i]) for i in (0, 1))
    diagonal = [(name, i) for name in later for i in range(2)]

    def curve(arrays: Arrays, name: str, i: int) -> npt.NDArray[Any]:
        return np.atleast_1d(arrays[name][..., i] if name == "excitation" else arrays[name][..., i, i])

    error = max(
        np.max(np.abs(curve(later, name, i) - curve(earlier, name, i))) / np.max(np.abs(curve(later, name, i)))
        for name, i in diagonal
    )
    return later, float(error)


UNITS = {"added_mass": "kg", "radiation_damping": "N s/m", "added_mass_at_infinity": "kg", "excitation": "N/m"}
NAMES = {
    "added_mass": "added mass",
    "radiation_damping": "radiation damping",
    "added_mass_at_infinity": "added mass at infinite frequency",
    "excitation": "excitation force by the elevation of waves that travel to +x",
}


def dataset(name: str, hull: Hull, results: Arrays, error: float) -> xr.Dataset:
    """The database of one hull, of its results over `hull.omega` and their error."""
    excitation = results["excitation"]
    found = {**results, "excitation": np.stack([excitation.real, excitation.imag], axis=-1)}
    square = ("dof", "radiating_dof")
    dims = {
        "added_mass": ("omega", *square),
        "radiation_damping": ("omega", *square),
        "added_mass_at_infinity": square,
        "excitation": ("omega", "dof", "complex"),
    }
    made = xr.Dataset(
        {key: (dims[key], values, {"units": UNITS[key], "long_name": NAMES[key]}) for key, values in found.items()},
        coords={
            "omega": ("omega", hull.omega, {"units": "rad/s", "long_name": "angular frequency"}),
            "dof": list(DOF),
            "radiating_dof": list(DOF),
            "complex": ["re", "im"],
        },
    )
    stiffness = [0.0, DENSITY * GRAVITY * hull.waterplane]
    made["hydrostatic_stiffness"] = ("dof", stiffness, {"units": "N/m"})
    for key, value, unit in (
        ("mass", DENSITY * hull.volume, "kg"), ("draft", hull.draft, "m"), ("waterplane", hull.waterplane, "m2"),
        ("volume", hull.volume, "m3"),
    ):  # fmt: skip
        made[key] = ((), value, {"units": unit})
    places = [*(-x for x in reversed(hull.points)), 0.0, *hull.points]
    made["points"] = ("points", places, {"units": "m", "long_name": "where the body wants to know the elevation"})
    panels = [int(hull.mesh(k).nb_faces) for k in hull.fineness]
    made.attrs = {
        "title": f"{name}: {hull.what}",
        "geometry": hull.what,
        "conventions": "SI; x right, y down; F(t) = Re(X a exp(j omega t)) in waves a cos(omega t - k x)",
        "density": DENSITY,
        "gravity": GRAVITY,
        "water_depth": math.inf,
        "pitch": "held",
        "panels": panels,
        "mesh_error": error,
        "mesh_error_is": "largest change of any curve from one extrapolation to the next, of its largest value",
        "irregular_frequencies": "removed by a lid" if hull.lid else "above the band",
        "source": f"Capytaine {version('capytaine')}, numpy {version('numpy')}, xarray {version('xarray')}",
    }
    return made


def main(names: list[str]) -> int:
    unknown = [name for name in names if name not in HULLS]
    if unknown or not names:
        print(f"name one or more of {', '.join(HULLS)}", file=sys.stderr)
        return 2
    cpt.set_logging("ERROR")
    for name in names:
        made = dataset(name, HULLS[name], *converged(HULLS[name], HULLS[name].omega))
        made.to_netcdf(DATA / f"{name}.nc", engine="scipy")
        print(f"{name}.nc: {made.attrs['panels']} panels, mesh error {made.attrs['mesh_error']:.2%}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
