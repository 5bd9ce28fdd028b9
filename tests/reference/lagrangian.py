"""The chain's energies and forces in symbols, written down from the geometry alone.

Nothing here comes from the reference's formulas: positions are sums of link vectors, the rest is
sympy's differentiation. A top whose motion is given is no coordinate but a function of time in the energies,
whose rates take part in every time derivative. The reference is given the same symbols, through its `Chain`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp

from cablefmu.cable import Top
from cablefmu.reference.chain import Array, Chain, EndSprings
from cablefmu.reference.kinematics import Motion, motion_of

__all__ = ["DERIVED", "Derivation", "derive", "same", "vectorised"]

INPUT_NAMES = ("u_m1", "u_m2", "F_cx", "F_cy", "u_m1x", "x_1", "y_1", "vx_1", "vy_1", "ax_1", "ay_1")

DERIVED = [(n, top) for top in Top for n in (1, 2, 3, 4)]
"""(n, top) that are compared element by element."""


@dataclass(frozen=True)
class Derivation:
    """A chain of n links in symbols; vectors are lists of sympy expressions."""

    chain: Chain
    """The symbols in the reference's own containers"""
    q: list[Any]
    v: list[Any]
    angles: list[Any]
    """th_1 ... th_n, among q"""
    flow: dict[Any, Any]
    """What changes by what in a second: q by v, and of a top whose motion is given place by velocity, that by
    acceleration"""
    inputs: dict[str, Any]
    centres: list[Any]
    """Positions of the links' centres, column vectors"""
    end: Any
    """Position of P_n"""
    kinetic: Any
    weight_energy: Any
    """Of weights and floater 1's static load and pull"""
    spring_energy: Any
    """Of floater 1's springs and the joints"""
    spring_loss: Any
    """Rayleigh's function of floater 1's dampers and the joints"""
    end_energy: Any
    end_loss: Any
    """Of the terminal's spring-dampers and preload"""

    @property
    def motion(self) -> Motion:
        """The symbolic state for the reference."""
        state = np.array(self.q), np.array(self.v)
        sin, cos = vectorised(sp.sin), vectorised(sp.cos)
        return motion_of(*state, sin, cos, top=self.chain.top, inputs=self.given)

    @property
    def given(self) -> dict[str, Any]:
        """The inputs that give P_0's motion; none of a floater."""
        return {name: symbol for name, symbol in self.inputs.items() if self.chain.top is Top.MOTION and "_1" in name}

    def rate(self, vector: Any) -> Any:
        """Time derivative of a position, of a momentum with the part of x'' left out."""
        return _rate(vector, self.flow)

    def by_virtual_work(self, point: Any, force: Any) -> list[Any]:
        """Generalised force of a force at a point."""
        return list(point.jacobian(self.q).T * force)

    def inertia(self) -> Any:
        """d^2 T / dv dv"""
        return sp.hessian(self.kinetic, self.v)

    def velocity_terms(self) -> list[Any]:
        """d/dt (dT/dv) - dT/dq with the part of x'' left out."""
        momenta = sp.Matrix([sp.diff(self.kinetic, rate) for rate in self.v])
        return [c - sp.diff(self.kinetic, x) for c, x in zip(self.rate(momenta), self.q, strict=True)]

    def gradient(self, energy: Any) -> list[Any]:
        """d energy / dq"""
        return [sp.diff(energy, x) for x in self.q]

    def loss_gradient(self, loss: Any) -> list[Any]:
        """d loss / dv"""
        return [sp.diff(loss, rate) for rate in self.v]

    def drag_forces(self) -> list[Any]:
        """-c_v |v_n| v_n n at each centre."""
        forces = []
        for centre, angle, coefficient in zip(self.centres, self.angles, self.chain.drag, strict=True):
            normal = sp.Matrix([sp.cos(angle), -sp.sin(angle)])
            speed = normal.dot(self.rate(centre))
            forces.append(-coefficient * sp.Abs(speed) * speed * normal)
        return forces

    def floater_forces(self) -> list[Any]:
        """Generalised force of what acts on floater 1, in the direction of its coordinates."""
        pushed = {sp.Symbol("y", real=True): self.inputs["u_m1"], sp.Symbol("x", real=True): self.inputs["u_m1x"]}
        return [pushed.get(x, sp.Integer(0)) for x in self.q]

    def end_forces(self) -> list[Any]:
        """Generalised force of inputs, spring-dampers and preload at the terminal."""
        u = self.inputs
        external = self.by_virtual_work(self.end, sp.Matrix([u["F_cx"], u["F_cy"] + u["u_m2"]]))
        springs, dampers = self.gradient(self.end_energy), self.loss_gradient(self.end_loss)
        return [e - s - d for e, s, d in zip(external, springs, dampers, strict=True)]


@cache
def derive(n: int, top: Top = Top.FLOATER) -> Derivation:
    """The symbolic chain of n links that differ in everything."""
    chain, inputs = _symbolic_chain(n, top), {name: sp.Symbol(name, real=True) for name in INPUT_NAMES}
    (x, y), (vx, vy) = (sp.symbols(names, real=True) for names in ("x y", "vx v"))
    th, om = _symbols("th", n), _symbols("om", n)
    q, v, place = {
        Top.FLOATER: ([y, *th], [vy, *om], [0, y]),
        Top.FREE: ([y, *th, x], [vy, *om, vx], [x, y]),
        Top.MOTION: (th, om, [inputs["x_1"], inputs["y_1"]]),
    }[top]
    flow = dict(zip(q, v, strict=True))
    if top is Top.MOTION:
        kinds = pairwise(("", "v", "a"))
        flow |= {inputs[f"{kind}{axis}_1"]: inputs[f"{rate}{axis}_1"] for kind, rate in kinds for axis in "xy"}
    centres, point = [], sp.Matrix(place)
    top_place = point
    for length, angle in zip(chain.length, th, strict=True):
        link = length * sp.Matrix([sp.sin(angle), sp.cos(angle)])
        centres.append(point + link / 2)
        point = point + link
    bends, bend_rates = ([x[0], *(b - a for a, b in pairwise(x))] for x in (th, om))

    def rate(at: Any) -> Any:
        return _rate(at, flow)

    kinetic = chain.floater_mass * rate(top_place).dot(rate(top_place)) / 2
    kinetic += chain.end_mass * rate(point).dot(rate(point)) / 2
    weights = -chain.gravity * chain.end_wet_mass * point[1]
    weights += chain.static_load * top_place[1] + chain.static_pull * top_place[0]
    springs, loss = sp.Integer(0), sp.Integer(0)
    for axis, k, c in (
        (0, chain.surge_stiffness, chain.surge_damping),
        (1, chain.floater_stiffness, chain.floater_damping),
    ):
        springs += k * top_place[axis] ** 2 / 2
        loss += c * rate(top_place)[axis] ** 2 / 2
    for i, centre in enumerate(centres):
        kinetic += chain.mass[i] * rate(centre).dot(rate(centre)) / 2 + chain.inertia[i] * om[i] ** 2 / 2
        weights -= chain.gravity * chain.wet_mass[i] * centre[1]
        springs += chain.stiffness[i] * bends[i] ** 2 / 2
        loss += chain.damping[i] * bend_rates[i] ** 2 / 2
    end_energy, end_loss = 0, 0
    ends = chain.end_springs
    for axis in range(2):
        stretch, speed = point[axis] - ends.rest[axis], rate(point)[axis]
        end_energy += ends.stiffness[axis] * stretch**2 / 2 - ends.preload[axis] * stretch
        end_loss += ends.damping[axis] * speed**2 / 2
    energies = kinetic, weights, springs, loss, end_energy, end_loss
    return Derivation(chain, q, v, th, flow, inputs, centres, point, *energies)


def same(left: Any, right: Any) -> bool:
    """Whether two expressions are equal by sin^2 + cos^2 = 1 and arithmetic."""
    difference = sp.expand(sp.sympify(left) - sp.sympify(right))
    squares = {node**2: 1 - sp.cos(node.args[0]) ** 2 for node in difference.atoms(sp.sin)}
    return bool(sp.expand(difference.subs(squares)) == 0)


def vectorised(function: Any) -> Any:
    """A function of one number as one of object arrays."""
    return np.vectorize(function, otypes=[object])


def _rate(vector: Any, flow: dict[Any, Any]) -> Any:
    return vector.jacobian(list(flow)) * sp.Matrix(list(flow.values()))


def _symbolic_chain(n: int, top: Top) -> Chain:
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
        top=top,
        surge_stiffness=number("k_x"),
        surge_damping=number("c_x"),
        static_pull=number("S_x"),
    )


def _symbols(name: str, n: int) -> list[Any]:
    return [sp.Symbol(f"{name}{i}", real=True) for i in range(1, n + 1)]
