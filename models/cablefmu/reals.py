"""Real variables of an FMU, set and got again and again: what FMPy allocates at every call is allocated once here."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any

__all__ = ["Reals", "Slopes"]


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


class Slopes:
    """Derivatives of inputs of an FMI 2 instance, in a fixed order: those of the first input first.

    Parameters
    ----------
    references
        The inputs' value references.
    orders
        How many derivatives each of them has, from the first on.
    """

    def __init__(self, references: Sequence[int], orders: Sequence[int]) -> None:
        named = [(r, k) for r, most in zip(references, orders, strict=True) for k in range(1, most + 1)]
        self._count = len(named)
        self._references = (ctypes.c_uint32 * self._count)(*(reference for reference, _ in named))
        self._orders = (ctypes.c_int * self._count)(*(order for _, order in named))
        self._values = (ctypes.c_double * self._count)()

    def set(self, fmu: Any, derivatives: Iterable[Sequence[float]]) -> None:
        """Set all of them, input by input; raises FMPy's FMICallException if the FMU refuses."""
        if self._count:
            self._values[:] = list(chain.from_iterable(derivatives))
            fmu.fmi2SetRealInputDerivatives(fmu.component, self._references, self._count, self._orders, self._values)
