"""The chain's energies and forces in symbols, written down from the geometry alone.

Nothing here comes from the reference's formulas: positions are sums of link vectors, the rest is
sympy's differentiation. The reference is given the same symbols, through its `Chain`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp

from cablefmu.reference.chain import Array, Chain, EndSprings
from cablefmu.reference.kinematics import Motion, motion_of

__all__ = ["Derivation", "derive", "same", "vectorised"]

INPUT_NAMES = ("u_m1", "u_m2", "F_cx", "F_cy")


@dataclass(frozen=True)
class Derivation:
    """A chain of n links in symbols; vectors are lists of sympy expressions."""

    chain: Chain
    """The symbols in the reference's own containers"""
    q: list[Any]
    v: list[Any]
    inputs: dict[str, Any]
    centres: list[Any]
    """Positions of the links' centres, column vectors"""
    end: Any
    """Position of P_n"""
    kinetic: Any
    weight_energy: Any
    """Of weights and floater 1's static load"""
    spring_energy: Any
    """Of floater 1's spring and the joints"""
    spring_loss: Any
    """Rayleigh's function of floater 1's damper and the joints"""
    end_energy: Any
    end_loss: Any
    """Of the terminal's spring-dampers and preload"""

    @property
    def motion(self) -> Motion:
        """The symbolic state for the reference."""
        return motion_of(np.array(self.q), np.array(self.v), vectorised(sp.sin), vectorised(sp.cos))

    def rate(self, point: Any) -> Any:
        """Time derivative of a position."""
        return point.jacobian(self.q) * sp.Matrix(self.v)

    def by_virtual_work(self, point: Any, force: Any) -> list[Any]:
        """Generalised force of a force at a point."""
        return list(point.jacobian(self.q).T * force)

    def inertia(self) -> Any:
        """d^2 T / dv dv"""
        return sp.hessian(self.kinetic, self.v)

    def velocity_terms(self) -> list[Any]:
        """d/dt (dT/dv) - dT/dq with the part of x'' left out."""
        momenta = sp.Matrix([sp.diff(self.kinetic, rate) for rate in self.v])
        change = momenta.jacobian(self.q) * sp.Matrix(self.v)
        return [c - sp.diff(self.kinetic, x) for c, x in zip(change, self.q, strict=True)]

    def gradient(self, energy: Any) -> list[Any]:
        """d energy / dq"""
        return [sp.diff(energy, x) for x in self.q]

    def loss_gradient(self, loss: Any) -> list[Any]:
        """d loss / dv"""
        return [sp.diff(loss, rate) for rate in self.v]

    def drag_forces(self) -> list[Any]:
        """-c_v |v_n| v_n n at each centre."""
        forces = []
        for centre, angle, coefficient in zip(self.centres, self.q[1:], self.chain.drag, strict=True):
            normal = sp.Matrix([sp.cos(angle), -sp.sin(angle)])
            speed = normal.dot(self.rate(centre))
            forces.append(-coefficient * sp.Abs(speed) * speed * normal)
        return forces

    def end_forces(self) -> list[Any]:
        """Generalised force of inputs, spring-dampers and preload at the terminal."""
        u = self.inputs
        external = self.by_virtual_work(self.end, sp.Matrix([u["F_cx"], u["F_cy"] + u["u_m2"]]))
        springs, dampers = self.gradient(self.end_energy), self.loss_gradient(self.end_loss)
        return [e - s - d for e, s, d in zip(external, springs, dampers, strict=True)]


@cache
def derive(n: int) -> Derivation:
    """The symbolic chain of n links that differ in everything."""
    chain = _symbolic_chain(n)
    y, th = sp.Symbol("y", real=True), _symbols("th", n)
    q, v = [y, *th], [sp.Symbol("v", real=True), *_symbols("om", n)]
    centres, point = [], sp.Matrix([0, y])
    for length, angle in zip(chain.length, th, strict=True):
        link = length * sp.Matrix([sp.sin(angle), sp.cos(angle)])
        centres.append(point + link / 2)
        point = point + link
    bends, bend_rates = ([x[0], *(b - a for a, b in pairwise(x))] for x in (th, v[1:]))

    def rate(at: Any) -> Any:
        return at.jacobian(q) * sp.Matrix(v)

    kinetic = chain.floater_mass * v[0] ** 2 / 2 + chain.end_mass * rate(point).dot(rate(point)) / 2
    weights = chain.static_load * y - chain.gravity * chain.end_wet_mass * point[1]
    springs, loss = chain.floater_stiffness * y**2 / 2, chain.floater_damping * v[0] ** 2 / 2
    for i, centre in enumerate(centres):
        kinetic += chain.mass[i] * rate(centre).dot(rate(centre)) / 2 + chain.inertia[i] * v[i + 1] ** 2 / 2
        weights -= chain.gravity * chain.wet_mass[i] * centre[1]
        springs += chain.stiffness[i] * bends[i] ** 2 / 2
        loss += chain.damping[i] * bend_rates[i] ** 2 / 2
    end_energy, end_loss = 0, 0
    ends = chain.end_springs
    for axis in range(2):
        stretch, speed = point[axis] - ends.rest[axis], rate(point)[axis]
        end_energy += ends.stiffness[axis] * stretch**2 / 2 - ends.preload[axis] * stretch
        end_loss += ends.damping[axis] * speed**2 / 2
    inputs = {name: sp.Symbol(name, real=True) for name in INPUT_NAMES}
    return Derivation(chain, q, v, inputs, centres, point, kinetic, weights, springs, loss, end_energy, end_loss)


def same(left: Any, right: Any) -> bool:
    """Whether two expressions are equal by sin^2 + cos^2 = 1 and arithmetic."""
    difference = sp.expand(sp.sympify(left) - sp.sympify(right))
    squares = {node**2: 1 - sp.cos(node.args[0]) ** 2 for node in difference.atoms(sp.sin)}
    return bool(sp.expand(difference.subs(squares)) == 0)


def vectorised(function: Any) -> Any:
    """A function of one number as one of object arrays."""
    return np.vectorize(function, otypes=[object])


def _symbolic_chain(n: int) -> Chain:
    def array(name: str) -> Array:
        return np.array(_symbols(name, n), dtype=object)

    def pair(name: str) -> Array:
        return np.array(sp.symbols(f"{name}_H {name}_V", real=True), dtype=object)

    def number(name: str) -> Any:
        return sp.Symbol(name, real=True)

    return Chain(
        length=array("l"),
        mass=array("m"),
        wet_mass=array("w"),
        inertia=array("I"),
        stiffness=array("k"),
        damping=array("c"),
        drag=array("d"),
        gravity=number("g"),
        floater_mass=number("M"),
        floater_stiffness=number("k_m"),
        floater_damping=number("c_m"),
        static_load=number("S"),
        end_mass=number("m_c"),
        end_wet_mass=number("w_c"),
        end_springs=EndSprings(pair("K"), pair("C"), pair("rest"), pair("pre")),
    )


def _symbols(name: str, n: int) -> list[Any]:
    return [sp.Symbol(f"{name}{i}", real=True) for i in range(1, n + 1)]
