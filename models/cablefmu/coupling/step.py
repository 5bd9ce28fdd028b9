"""One communication step of all models, in three ways.

Jacobi: all models step with inputs from the past. Gauss-Seidel: one after the other, with what those before said of the
step's end. Iterated: so again and again from the same state, until what they were given for the end is what they say
there. An input follows a polynomial through its newest samples, of the order `extrapolation`: of the past in
Jacobi, where it extrapolates, through the end of the step where that is known.

The first `extrapolation` steps have too few samples for that. Inputs held in a first step of length h leave an error
of h^2 behind, which a body remembers. So those steps are iterated, whatever the algorithm, where models can go back:
inputs are interpolated then, and what is left is of the order of all other steps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..cable import Floats
from ..errors import RunError
from .connections import Variable
from .exchange import Exchange, Outputs
from .extrapolation import Polynomial, Sample
from .fixed_point import NotFoundError, solve
from .partners import Partner
from .system import System

__all__ = ["Ended", "make_stepper", "outputs_of", "worst"]


@dataclass(frozen=True, slots=True)
class Ended:
    """How a step ended."""

    outputs: Outputs
    inputs: Mapping[Variable, float]
    """What connected inputs were at the end of the step"""
    evaluations: int = 1


Stepper = Callable[[float, float], Ended]
"""From a time to a time [s]; samples are not accepted yet."""


def make_stepper(system: System, partners: Mapping[str, Partner], exchange: Exchange, *, may_repeat: bool) -> Stepper:
    """The step of the coupling's algorithm.

    `may_repeat`: whether the master may take whole steps back, which models must be told of.
    """
    kinds: dict[str, type[_Jacobi | _GaussSeidel | _Iterated]] = {
        "jacobi": _Jacobi,
        "gauss-seidel": _GaussSeidel,
        "iterated": _Iterated,
    }
    stepper = kinds[system.settings.algorithm](system, partners, exchange, is_final=not may_repeat)
    if isinstance(stepper, _Iterated) or not system.starts_iterated:
        return stepper
    starter = _Iterated(system, partners, exchange, is_final=not may_repeat)
    return lambda time, end: (starter if exchange.is_short else stepper)(time, end)


def outputs_of(partners: Mapping[str, Partner]) -> dict[Variable, float]:
    """Present outputs of all models."""
    return {variable: value for partner in partners.values() for variable, value in _read(partner).items()}


def worst(residual: Floats, numbers: Sequence[int], exchange: Exchange) -> str:
    """The connection, of these numbers, that agrees least, in words."""
    place = int(np.argmax(np.where(np.isfinite(residual), residual, np.inf)))
    k = numbers[place]
    return f"{exchange.connections[k]} still changes by {residual[place]:.3g} of its size {exchange.scale[k]:.3g}"


def _read(partner: Partner) -> dict[Variable, float]:
    name = partner.model.name
    return {Variable(name, output): value for output, value in zip(partner.outputs, partner.get(), strict=True)}


class _Base:
    def __init__(self, system: System, partners: Mapping[str, Partner], exchange: Exchange, *, is_final: bool) -> None:
        self.system = system
        self.partners = partners
        self.exchange = exchange
        self.is_final = is_final
        self.order = system.order

    def advance(
        self, name: str, time: float, end: float, newest: Mapping[int, Sample], used: dict[Variable, float]
    ) -> None:
        """Step one model with inputs through these newest samples; what they are at the end goes to `used`."""
        numbers = self.exchange.into(name)
        polynomials = [self.exchange.polynomial(k, newest.get(k)) for k in numbers]
        try:
            self.partners[name].step(time, end, polynomials, is_final=self.is_final)
        except RunError as error:
            raise RunError(str(error) + self._fed_by(numbers, polynomials, time)) from None
        used.update(
            (self.exchange.connections[k].target, polynomial(end))
            for k, polynomial in zip(numbers, polynomials, strict=True)
        )

    def pass_through(
        self, order: Sequence[str], time: float, end: float, newest: Mapping[int, Sample]
    ) -> tuple[dict[Variable, float], dict[Variable, float]]:
        """Step models one after the other, each with what those before it said of the end; outputs and inputs there."""
        known = dict(newest)
        outputs: dict[Variable, float] = {}
        used: dict[Variable, float] = {}
        for name in order:
            self.advance(name, time, end, known, used)
            outputs |= _read(self.partners[name])
            known |= self.said([name], end, outputs)
        return outputs, used

    def said(self, names: Sequence[str], end: float, outputs: Outputs) -> dict[int, Sample]:
        """Samples for the connections that come from these models."""
        numbers = [k for k, c in enumerate(self.exchange.connections) if c.source.model in names]
        return {k: (end, float(v)) for k, v in zip(numbers, self.exchange.values(outputs, numbers), strict=True)}

    def _fed_by(self, numbers: list[int], polynomials: list[Polynomial], time: float) -> str:
        fed = zip(numbers, polynomials, strict=True)
        said = ", ".join(f"{self.exchange.connections[k]} = {polynomial(time):.6g}" for k, polynomial in fed)
        return f" (connected inputs: {said})" if said else ""


class _Jacobi(_Base):
    def __call__(self, time: float, end: float) -> Ended:
        used: dict[Variable, float] = {}
        for name in self.order:
            self.advance(name, time, end, {}, used)
        return Ended(outputs_of(self.partners), used)


class _GaussSeidel(_Base):
    def __call__(self, time: float, end: float) -> Ended:
        return Ended(*self.pass_through(self.order, time, end, {}))


class _Iterated(_Base):
    """Passes as in Gauss-Seidel, with guesses for what goes backward, until the guesses come true.

    Models without connected inputs are stepped once. All connections agree then at the step's end.
    """

    def __call__(self, time: float, end: float) -> Ended:
        repeated = [name for name in self.order if name in self.system.iterated]
        sources = [name for name in self.order if name not in repeated]
        outputs, used = self.pass_through(sources, time, end, {})
        known = self.said(sources, end, outputs)
        guessed = self.exchange.backward(repeated)
        states = {name: self.partners[name].save() for name in repeated}
        ended: list[Ended] = []

        def evaluate(values: Floats) -> Floats:
            if ended:
                for name in repeated:
                    self.partners[name].restore(states[name])
            guesses = {k: (end, float(value)) for k, value in zip(guessed, values, strict=True)}
            found, inputs = self.pass_through(repeated, time, end, known | guesses)
            ended.append(Ended(outputs | found, used | inputs, len(ended) + 1))
            return self.exchange.values(found, guessed)

        first = np.array([self.exchange.polynomial(k)(end) for k in guessed])
        try:
            solve(evaluate, first, self.exchange.scale[guessed], self.system.settings.iteration)
        except NotFoundError as error:
            where = worst(error.residual, guessed, self.exchange)
            most = self.system.settings.iteration.most
            text = f"the step from t = {time:.12g} s did not agree in {most} iterations: {where}"
            if self.system.settings.algorithm != "iterated":
                text += "; the first steps are iterated so that extrapolation can begin; extrapolation = 0 needs none"
            raise RunError(text) from None
        finally:
            for name, state in states.items():
                self.partners[name].forget(state)
        return ended[-1]
