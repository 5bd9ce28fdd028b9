"""The start of a coupling: initial values that agree, loops included, found in initialization mode."""

from __future__ import annotations

from collections.abc import Mapping

from ..cable import Floats
from ..errors import RunError
from .exchange import Exchange, Outputs
from .fixed_point import NotFoundError, solve
from .partners import Partner
from .step import outputs_of, worst
from .system import System

__all__ = ["initialise"]


def initialise(system: System, partners: Mapping[str, Partner], exchange: Exchange) -> Outputs:
    """Bring every instance through initialization mode; the outputs at the start.

    All connected inputs are set from the outputs, and outputs are read again, until nothing changes.

    Raises
    ------
    RunError
        If a model fails, or the iteration does.
    """
    settings = system.settings
    for partner in partners.values():
        partner.enter_initialisation(settings.stop_time, settings.tolerance)

    order = system.order
    guessed = exchange.backward(order)

    def evaluate(values: Floats) -> Floats:
        inputs = dict(zip(guessed, map(float, values), strict=True))
        for name in order:
            partners[name].set([inputs[k] for k in exchange.into(name)])
            numbers = exchange.out_of(name)
            said = exchange.values(outputs_of({name: partners[name]}), numbers)
            inputs |= dict(zip(numbers, map(float, said), strict=True))
        return exchange.values(outputs_of(partners), guessed)

    first = exchange.values(outputs_of(partners), guessed)
    try:
        solve(evaluate, first, exchange.scale[guessed], settings.iteration)
    except NotFoundError as error:
        raise RunError(f"no initial values that agree were found: {worst(error.residual, guessed, exchange)}") from None
    for partner in partners.values():
        partner.exit_initialisation()
    return outputs_of(partners)
