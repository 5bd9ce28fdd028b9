"""Which output feeds which input, checked against what the FMUs say of themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ..scene_mistakes import Mistake, nearest
from .models import Model, Unit
from .schema import ConnectionSpec, FileSpec

__all__ = ["Connection", "Variable", "connect"]


class Variable(NamedTuple):  # its hash is a tuple's: outputs are looked up by it in every step
    """One variable of one model."""

    model: str
    name: str

    def __str__(self) -> str:
        return f"{self.model}.{self.name}"


@dataclass(frozen=True, slots=True)
class Connection:
    """target = gain * source + offset."""

    source: Variable
    target: Variable
    gain: float = 1.0
    offset: float = 0.0
    """In the target's unit"""
    delayed: bool = False

    def __str__(self) -> str:
        return f"{self.source} -> {self.target}"


def connect(spec: FileSpec, models: Mapping[str, Model], mistakes: list[Mistake]) -> list[Connection]:
    """Resolve every [[connection]]; what is wrong is added to `mistakes`."""
    connections: list[Connection] = []
    for k, table in enumerate(spec.connection, start=1):
        for connection in _resolved(k, table, spec, models, mistakes):
            before = [other for other in connections if other.target == connection.target]
            if before:
                text = f"{connection.target} has a source already, {before[0]}; one is allowed"
                mistakes.append(Mistake(f"connection {k}, {connection}", text))
                continue
            connections.append(connection)
    mistakes += _unfed(spec, models, connections)
    return connections


def _resolved(
    k: int, table: ConnectionSpec, spec: FileSpec, models: Mapping[str, Model], mistakes: list[Mistake]
) -> Iterator[Connection]:
    if table.ports is not None:
        yield from _of_ports(k, table, spec, models, mistakes)
        return
    assert table.from_ is not None and table.to is not None
    source = find_variable(f"connection {k}.from", table.from_, "output", spec, models, mistakes)
    target = find_variable(f"connection {k}.to", table.to, "input", spec, models, mistakes)
    if source is None or target is None:
        return
    connection = Connection(source, target, table.gain, table.offset, table.delayed)
    wrong = _unit_mistake(connection, models)
    if wrong:
        mistakes.append(Mistake(f"connection {k}, {connection}", wrong))
    yield connection


def find_variable(
    key: str, text: str, causality: str, spec: FileSpec, models: Mapping[str, Model], mistakes: list[Mistake]
) -> Variable | None:
    """The variable that "MODEL.NAME" means; None with a mistake if there is none of that causality."""
    model, _, name = text.partition(".")
    named = [table.name for table in spec.model]
    if model not in named:
        mistakes.append(Mistake(key, f"there is no model {model}; {nearest(model, named)}", text))
        return None
    if model not in models:  # its own mistake was told
        return None
    offered = models[model].names(causality)
    if name in offered:
        return Variable(model, name)
    known = models[model].variables.get(name)
    if known is None:
        said = nearest(name, offered) if offered else f"it has no real {causality}"
        mistakes.append(Mistake(key, f"model {model} has no variable {name}; {said}", text))
    elif known.causality != causality:
        mistakes.append(Mistake(key, f"an {causality} is expected; {name} is of causality {known.causality}", text))
    else:
        mistakes.append(Mistake(key, f"a real scalar is expected; {name} is {known.type}", text))
    return None


def _of_ports(
    k: int, table: ConnectionSpec, spec: FileSpec, models: Mapping[str, Model], mistakes: list[Mistake]
) -> Iterator[Connection]:
    """Every output of one port to the input of the other that has its member's name."""
    assert table.ports is not None
    members = [_members(k, text, spec, models, mistakes) for text in table.ports]
    if members[0] is None or members[1] is None:
        return
    found = 0
    for (model, here), (other, there) in ((members[0], members[1]), (members[1], members[0])):
        outputs, inputs = models[model].names("output"), models[other].names("input")
        for member, output in here.items():
            if output in outputs and there.get(member) in inputs:
                found += 1
                ends = Variable(model, output), Variable(other, there[member])
                connection = Connection(*ends, delayed=table.delayed)
                wrong = _unit_mistake(connection, models)
                if wrong:
                    mistakes.append(Mistake(f"connection {k}, {connection}", wrong))
                yield connection
    if not found:
        one, other_ = (", ".join(port[1]) or "nothing" for port in (members[0], members[1]))
        text = f"no output of one has an input of the same name in the other: {one}; and {other_}"
        mistakes.append(Mistake(f"connection {k}.ports", text, list(table.ports)))


def _members(
    k: int, text: str, spec: FileSpec, models: Mapping[str, Model], mistakes: list[Mistake]
) -> tuple[str, dict[str, str]] | None:
    """A model and its variables by their names in the port; the port of a whole model has all of them."""
    name, _, terminal = text.partition(".")
    key, named = f"connection {k}.ports", [table.name for table in spec.model]
    if name not in named:
        mistakes.append(Mistake(key, f"there is no model {name}; {nearest(name, named)}", text))
    if name not in models:
        return None
    model = models[name]
    if not terminal:
        return name, {variable: variable for variable in (*model.names("output"), *model.names("input"))}
    try:
        return name, model.terminal(terminal)
    except LookupError as error:
        mistakes.append(Mistake(key, f"model {name} has no terminal {terminal}; {error.args[0]}", text))
        return None


def _unit_mistake(connection: Connection, models: Mapping[str, Model]) -> str | None:
    """Why two units do not go together; nothing where one of the FMUs does not say its unit."""
    source, target = (models[v.model].unit(v.name) for v in (connection.source, connection.target))
    if source is None or target is None:
        return None
    if source.exponents != target.exponents:
        return f"{source.name} and {target.name} are no units of the same quantity"
    if (source.factor, source.offset) == (target.factor, target.offset):
        return None
    if source.offset != target.offset:
        return f"{source.name} and {target.name} differ by more than a factor; the same unit is expected"
    return None if connection.gain != 1.0 else _gain_wanted(source, target)


def _gain_wanted(source: Unit, target: Unit) -> str:
    return f"{source.name} is not {target.name}; gain = {source.factor / target.factor:g} is expected"


def _unfed(spec: FileSpec, models: Mapping[str, Model], connections: list[Connection]) -> Iterator[Mistake]:
    """Inputs with no source, or with two; not those whose source has a mistake of its own."""
    fed = {connection.target: connection for connection in connections}
    slopes = {
        Variable(model.name, s) for model in models.values() for n in model.names("input") for s in model.slopes(n)
    }
    meant = {table.to for table in spec.connection}
    all_known = len(models) == len(spec.model)
    for model in models.values():
        for name in model.names("input"):
            variable = Variable(model.name, name)
            if variable in fed and name in model.spec.inputs:
                text = f"has a source, {fed[variable]}, and a constant value; one is allowed"
                yield Mistake(f"input {variable}", text)
            elif (
                all_known
                and str(variable) not in meant
                and variable not in {*fed, *slopes}
                and name not in model.constants
            ):
                varies = " (in the scene it varies over time, which a coupling does not feed)" if model.scene else ""
                text = f"has no source{varies}; a connection to it or inputs.{name} of its model is expected"
                yield Mistake(f"input {variable}", text)
