"""The Rosenbrock methods' coefficients as the compiled kernel holds them, and in the form of the theory.

The kernel's form (u, a, c, m) avoids products with the Jacobian. The theory's is
k_i = h f(y + sum_j alpha_ij k_j) + h J sum_j gamma_ij k_j, u = Gamma k, from which
Gamma^-1 = diag(1 / gamma) - c, (alpha_ij) = a Gamma, b = m Gamma
(Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.7).
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from cablefmu.cable import Floats

__all__ = ["DENSE_ORDER", "NAMES", "ROUNDING", "Method", "read"]

ROUNDING = 1e-13
"""Of sums of size one: coefficients of up to 165 are printed to 1e-14, and gamma_ij, up to 6, pass that on."""

NAMES = ["Rodas4", "Rodas4P2", "Rodas5P"]
DENSE_ORDER = {"Rodas4": 3, "Rodas4P2": 3, "Rodas5P": 4}


@dataclass(frozen=True)
class Method:
    """Triangles as full squares, (stages, stages); dense of shape (rows, stages)."""

    name: str
    stages: int
    order: int
    error_order: int
    gamma: float
    a: Floats
    c: Floats
    m: Floats
    e: Floats
    alpha: Floats
    d: Floats
    dense: Floats

    @property
    def gammas(self) -> Floats:
        """gamma_ij, the diagonal included."""
        return np.asarray(np.linalg.inv(np.eye(self.stages) / self.gamma - self.c), dtype=float)

    @property
    def alphas(self) -> Floats:
        """alpha_ij"""
        return self.a @ self.gammas

    @property
    def betas(self) -> Floats:
        """beta_ij = alpha_ij + gamma_ij"""
        return self.alphas + self.gammas

    @property
    def b(self) -> Floats:
        return self.m @ self.gammas

    @property
    def b_embedded(self) -> Floats:
        return (self.m - self.e) @ self.gammas

    def m_dense(self, s: float) -> Floats:
        """y(t + s h) = y + sum m_i u_i; 0 and m at the ends by its form alone."""
        return s * (self.m + (1.0 - s) * s ** np.arange(len(self.dense)) @ self.dense)

    def b_dense(self, s: float) -> Floats:
        return self.m_dense(s) @ self.gammas


def read(library: ctypes.CDLL, which: int) -> Method:
    """The which'th of NAMES."""
    sizes = np.zeros(4)
    name = library.probe_rosenbrock_size(which, sizes).decode()
    stages, order, error_order, terms = map(int, sizes)
    triangles, rows = np.full((2, stages, stages), np.nan), np.full((4, stages), np.nan)
    dense = np.full((terms, stages), np.nan)
    gamma = library.probe_rosenbrock(which, triangles, rows, dense)
    a, c = triangles
    m, e, alpha, d = rows
    return Method(name, stages, order, error_order, gamma, a, c, m, e, alpha, d, dense)
