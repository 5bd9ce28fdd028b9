"""From the coefficients of linear potential flow over frequency to filters that a vessel steps through in time."""

from .database import SHIPPED, Hydrodynamics, read_database, shipped_database
from .excitation import Excitation, fit_excitation
from .radiation import Radiation, fit_radiation

__all__ = [
    "SHIPPED",
    "Excitation",
    "Hydrodynamics",
    "Radiation",
    "fit_excitation",
    "fit_radiation",
    "read_database",
    "shipped_database",
]
