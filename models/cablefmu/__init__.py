"""Functional Mock-up Units of underwater cables, from a scene file.

>>> import cablefmu
>>> scene = cablefmu.load_scene("free-12-water")
>>> path = cablefmu.build_fmu(scene, "cable.fmu")          # an FMU for any FMI tool
>>> result = cablefmu.simulate(scene, stop_time=10.0)      # an xarray Dataset
>>> float(result.x_c[-1])                                  # doctest: +SKIP
"""

__version__ = "0.1.0"

from .coupling import Coupling, couple, load_coupling, shipped_couplings
from .errors import (
    CableError,
    CouplingError,
    FmuError,
    OptionError,
    ResultError,
    RunError,
    SceneError,
    StateError,
    SweepError,
    UserError,
    VesselError,
    WavesError,
)
from .fmu.archive import build_fmu
from .fmu.twin import build_twin
from .fmu.vessel import build_vessel
from .fmu.waves import build_waves
from .plot import draw
from .reading import open_result
from .scene import Scene, load_scene, shipped_scenes
from .simulate import simulate
from .statics import Equilibrium, Modes, end_stiffness, equilibrium, modes
from .sweeping import open_sweep, sweep
from .vessel import Vessel
from .view import write_view
from .waves import Waves

__all__ = [
    "CableError",
    "Coupling",
    "CouplingError",
    "Equilibrium",
    "FmuError",
    "Modes",
    "OptionError",
    "ResultError",
    "RunError",
    "Scene",
    "SceneError",
    "StateError",
    "SweepError",
    "UserError",
    "Vessel",
    "VesselError",
    "Waves",
    "WavesError",
    "__version__",
    "build_fmu",
    "build_twin",
    "build_vessel",
    "build_waves",
    "couple",
    "draw",
    "end_stiffness",
    "equilibrium",
    "load_coupling",
    "load_scene",
    "modes",
    "open_result",
    "open_sweep",
    "shipped_couplings",
    "shipped_scenes",
    "simulate",
    "sweep",
    "write_view",
]
