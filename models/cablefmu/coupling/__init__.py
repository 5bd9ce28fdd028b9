"""Co-simulation of a cable with other FMUs: a coupling file becomes a run, or a file for another engine."""

from .description import Coupling, load_coupling, shipped_couplings
from .run import couple

__all__ = ["Coupling", "couple", "load_coupling", "shipped_couplings"]
