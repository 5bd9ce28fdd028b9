"""The order of models, and the algebraic loops between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

from .connections import Connection, Variable
from .models import Model

__all__ = ["components", "loops", "order"]

Node = TypeVar("Node")


def components(nodes: Iterable[Node], successors: Mapping[Node, Sequence[Node]]) -> list[list[Node]]:
    """Strongly connected components, every one before those that it leads to (Tarjan, without recursion)."""
    index: dict[Node, int] = {}
    low: dict[Node, int] = {}
    stack: list[Node] = []
    waiting: set[Node] = set()  # those on the stack
    found: list[list[Node]] = []
    for root in nodes:
        work = [(root, 0)] if root not in index else []
        while work:
            node, k = work.pop()
            if k == 0:
                index[node] = low[node] = len(index)
                stack.append(node)
                waiting.add(node)
            following = successors.get(node, ())
            if k and following[k - 1] in waiting:
                low[node] = min(low[node], low[following[k - 1]])
            while k < len(following) and following[k] in index:
                if following[k] in waiting:
                    low[node] = min(low[node], low[following[k]])
                k += 1
            if k < len(following):
                work += [(node, k + 1), (following[k], 0)]
            elif low[node] == index[node]:
                group = [stack.pop()]
                while group[-1] != node:
                    group.append(stack.pop())
                waiting -= set(group)
                found.append(group[::-1])
    return found[::-1]


def order(models: Sequence[str], connections: Iterable[Connection]) -> list[str]:
    """Models so that sources come before what they feed; within a cycle as in the file."""
    following: dict[str, list[str]] = {name: [] for name in models}
    for connection in connections:
        following[connection.source.model].append(connection.target.model)
    place = {name: k for k, name in enumerate(models)}
    return [name for group in components(models, following) for name in sorted(group, key=place.__getitem__)]


def loops(models: Mapping[str, Model], connections: Sequence[Connection]) -> list[list[Connection]]:
    """Connections of every algebraic loop: outputs that depend at once on inputs that they feed."""
    following: dict[Variable, list[Variable]] = {}
    for connection in connections:
        following.setdefault(connection.source, []).append(connection.target)
    for model, output in sorted({(c.source.model, c.source.name) for c in connections}):
        for name in models[model].feedthrough(output):
            following.setdefault(Variable(model, name), []).append(Variable(model, output))
    groups = [set(group) for group in components(list(following), following) if len(group) > 1]
    return [[c for c in connections if c.source in group and c.target in group] for group in groups]
