"""The equation of motion as the dissertation writes it [3.8], dense: the reference for the FMU's kernel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
import scipy.linalg

from cablefmu.cable import Cable, Floats
from cablefmu.errors import OptionError
from cablefmu.reference.chain import Array, Chain, Number, chain_of
from cablefmu.reference.drag import drag_vector
from cablefmu.reference.heavy_end import bordered, is_heavy
from cablefmu.reference.kinematics import Motion, motion_of
from cablefmu.reference.matrices import damping_matrix, inertia_matrix, stiffness_matrix
from cablefmu.reference.outputs import effective_masses, joint_forces, output_values
from cablefmu.reference.terminal import TerminalRule, departure, terminal_force, terminal_vector
from cablefmu.reference.vectors import drive_vector, gravity_vector, velocity_vector

__all__ = ["HeaveRule", "Reference", "equation", "generalised_forces"]

HeaveRule = Literal["static_load", "none"]


def generalised_forces(
    chain: Chain, motion: Motion, inputs: Mapping[str, Number], rule: TerminalRule = "virtual_work"
) -> Array:
    """T of [3.8], shape (coordinates,) [N, N m]: u_m1 and u_m1x on the floater, terminal force and drag on all."""
    force = terminal_force(chain, motion, inputs)
    on_floater = chain.rows(inputs.get("u_m1", 0.0), 0 * chain.length, inputs.get("u_m1x", 0.0))
    forces: Array = on_floater + terminal_vector(chain, motion, force, rule) + drag_vector(chain, motion)
    return forces


def equation(
    chain: Chain,
    motion: Motion,
    inputs: Mapping[str, Number],
    rule: TerminalRule = "virtual_work",
    *,
    outside: bool = False,
) -> tuple[Array, Array]:
    """I and T - (C x' + K x + F + G + D), shapes (m, m) and (m,) with m = `chain.coordinates`.

    If `outside`, the end's inertia or what holds P_n stands outside the matrix, in the border of `heavy_end`:
    shapes (m + 2, m + 2) and (m + 2,). An end that is held must.
    """
    light = replace(chain, end_mass=0 * chain.end_mass) if outside else chain
    right_side = generalised_forces(chain, motion, inputs, rule) - (
        damping_matrix(chain) @ motion.v
        + stiffness_matrix(chain) @ motion.q
        + velocity_vector(light, motion)
        + gravity_vector(chain, motion)
        + drive_vector(light, motion)
    )
    inertia = inertia_matrix(light, motion)
    return bordered(chain, motion, inertia, right_side) if outside else (inertia, right_side)


class Reference:
    """A cable's motion by dense matrices.

    Parameters
    ----------
    cable
        The cable. Its parameters are read once, here.
    terminal_rule
        How a force on the terminal enters: "virtual_work" (exact), or "projected", the print's own
        [5.8-5.10], which exists to measure its departure.
    heave_rule
        What y_m = 0 means: "static_load" takes the cable's parameter, "none" replaces it by 0, which is
        Appendix A's G_1. With a hanging load's default `static_load` the first is [5.6]'s G_1 = 0.
    heavy_end
        Whether to solve with the end's inertia outside the matrix (see `heavy_end`); None: if the end
        outweighs the cable a thousand times. What holds P_n is always outside.

    Raises
    ------
    OptionError
        A rule that is not one of these.
    """

    def __init__(
        self,
        cable: Cable,
        *,
        terminal_rule: TerminalRule = "virtual_work",
        heave_rule: HeaveRule = "static_load",
        heavy_end: bool | None = None,
    ) -> None:
        _require("terminal_rule", terminal_rule, get_args(TerminalRule))
        _require("heave_rule", heave_rule, get_args(HeaveRule))
        self.cable = cable
        self.terminal_rule: TerminalRule = terminal_rule
        chain = chain_of(cable)
        self.chain = chain if heave_rule == "static_load" else replace(chain, static_load=0.0)
        self.heavy_end = chain.pin is not None or (is_heavy(chain) if heavy_end is None else heavy_end)

    def acceleration(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> Floats:
        """x'' from I x'' + C x' + K x + F + G + D = T.

        Parameters
        ----------
        q, v
            (y_m, theta, x_m) without what is no unknown (see `Cable.position`), and its rate, shape (coordinates,)
            [m, rad; m/s, rad/s]. Complex numbers pass through, here and in `outputs`: Im f(x + i h d)/h with h = 1e-30
            is the derivative along d to the last digit. So they do in inputs.
        inputs
            Inputs by name [N; m, m/s, m/s^2]; where one is not named 0, of x_2 and y_2 the cable's `rest_position`.

        Returns
        -------
        array, shape (coordinates,) [m/s^2, rad/s^2]

        Raises
        ------
        OptionError
            A wrong shape, a value that is not finite, or an input that the cable does not have.
        """
        return self._solve(self._motion(q, v, inputs), inputs)[0]

    def outputs(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> dict[str, float]:
        """The FMU's outputs by name at a state: see `outputs.output_values` and `outputs.effective_masses`."""

        def values(given: Mapping[str, float]) -> dict[str, float]:
            motion = motion_of(q, v, top=self.cable.top, inputs=given)
            acceleration, end_inertia_force = self._solve(motion, given)
            return output_values(self.chain, motion, acceleration, given, end_inertia_force)

        self._motion(q, v, inputs)  # accelerations may be no inputs of the cable, and are asked for below
        return values(inputs) | effective_masses(self.chain, values, inputs)

    def joint_forces(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> Floats:
        """R_1 ... R_{n+1}, shape (n + 1, 2) [N]: see `outputs.joint_forces`. The last is that on what holds P_n."""
        motion = self._motion(q, v, inputs)
        acceleration, end_inertia_force = self._solve(motion, inputs)
        return joint_forces(self.chain, motion, acceleration, inputs, end_inertia_force)

    def departure(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> Floats:
        """T by the projected rule less T by virtual work, shape (coordinates,) [N, N m]."""
        motion = self._motion(q, v, inputs)
        return departure(self.chain, motion, terminal_force(self.chain, motion, inputs))

    def departure_report(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> str:
        """The same for people: a table of both rules, one line per coordinate."""
        motion = self._motion(q, v, inputs)
        force = terminal_force(self.chain, motion, inputs)
        exact = terminal_vector(self.chain, motion, force, "virtual_work")
        print_rule = terminal_vector(self.chain, motion, force, "projected")
        names = ["y_m [N]", *(f"theta[{i}] [N m]" for i in range(1, self.chain.n + 1)), "x_m [N]"][self.chain.own]
        lines = [f"{'':<18}{'virtual work':>16}{'projected':>16}{'departure':>16}"]
        for name, right, printed in zip(names, exact, print_rule, strict=True):
            lines.append(f"{name:<18}{right:>16.6g}{printed:>16.6g}{printed - right:>16.6g}")
        return "\n".join(lines)

    def _solve(self, motion: Motion, inputs: Mapping[str, float]) -> tuple[Floats, Floats | None]:
        """x'', and m_c P_n'' or a pin's force where it is an unknown of its own (see `heavy_end`)."""
        inertia, right_side = equation(self.chain, motion, inputs, self.terminal_rule, outside=self.heavy_end)
        if self.heavy_end:
            found: Array = np.linalg.solve(inertia, right_side)
            return found[: self.chain.coordinates], found[self.chain.coordinates :]
        if np.iscomplexobj(right_side):  # a complex step leaves I symmetric, which is not Hermitian
            acceleration: Array = np.linalg.solve(inertia, right_side)
            return acceleration, None
        factor = scipy.linalg.cho_factor(inertia, overwrite_a=True, check_finite=False)
        return scipy.linalg.cho_solve(factor, right_side, check_finite=False), None

    def _motion(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> Motion:
        expected = (self.chain.coordinates,)
        for name, value in (("q", q), ("v", v)):
            if np.shape(value) != expected:
                raise OptionError(f"{name} must have shape {expected}, got {np.shape(value)}.")
            if not np.all(np.isfinite(value)):
                raise OptionError(f"{name} must be finite, got {value}.")
        for name, given in inputs.items():
            _require("input", name, self.cable.inputs)
            if not np.isfinite(given):
                raise OptionError(f'input "{name}" must be finite, got {given}.')
        return motion_of(q, v, top=self.chain.top, inputs=inputs)


def _require(what: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        names = ", ".join(f'"{name}"' for name in allowed) or "none here"
        raise OptionError(f'{what} "{value}" does not exist; allowed: {names}.')
