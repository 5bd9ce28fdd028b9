"""Real variables of an FMU, set and got again and again: what FMPy allocates at every call is allocated once here."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

__all__ = ["Reals"]


class Reals:
    """Some real scalars of an FMI 2 or 3 instance, in a fixed order.

    Parameters
    ----------
    fmi
        Version.
    references
        Their value references.
    size
        Number of values, where some of them are arrays (FMI 3).
    """

    def __init__(self, fmi: int, references: Sequence[int], size: int | None = None) -> None:
        count = len(references)
        size = count if size is None else size
        self._set, self._get = ("fmi2SetReal", "fmi2GetReal") if fmi == 2 else ("fmi3SetFloat64", "fmi3GetFloat64")
        self._references, self._values = (ctypes.c_uint32 * count)(*references), (ctypes.c_double * size)()
        self._arguments = (self._references, count, self._values, *((size,) if fmi == 3 else ()))
        self._is_empty = size == 0

    def set(self, fmu: Any, values: Sequence[float]) -> None:
        """Set all of them; raises FMPy's FMICallException if the FMU refuses."""
        if not self._is_empty:
            self._values[:] = list(values)
            getattr(fmu, self._set)(fmu.component, *self._arguments)

    def get(self, fmu: Any) -> list[float]:
        """Present values of all of them; raises FMPy's FMICallException if the FMU refuses."""
        if not self._is_empty:
            getattr(fmu, self._get)(fmu.component, *self._arguments)
        return self._values[:]
