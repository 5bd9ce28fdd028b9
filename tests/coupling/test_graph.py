"""Order of models and algebraic loops, on graphs whose answer is plain."""

from __future__ import annotations

import random

import numpy as np

from cablefmu.coupling.connections import Connection, Variable
from cablefmu.coupling.graph import components, order


def _connection(source: str, target: str) -> Connection:
    return Connection(Variable(source, "y"), Variable(target, "u"))


def test_components_are_what_is_mutually_reachable() -> None:
    """Against the transitive closure by matrix powers, on 200 random graphs of eight nodes."""
    draw = random.Random(7)
    for _ in range(200):
        edges = {n: sorted({draw.randrange(8) for _ in range(draw.randrange(3))}) for n in range(8)}
        reach = np.eye(8, dtype=bool)
        for node, following in edges.items():
            reach[node, following] = True
        for _ in range(3):
            reach = reach @ reach
        found = components(range(8), edges)
        assert sorted(node for group in found for node in group) == list(range(8))
        place = {node: k for k, group in enumerate(found) for node in group}
        for a in range(8):
            for b in range(8):
                assert (place[a] == place[b]) == bool(reach[a, b] and reach[b, a])
                if reach[a, b]:
                    assert place[a] <= place[b]


def test_a_long_chain_is_no_trouble() -> None:
    assert len(components(range(20_000), {n: [n + 1] for n in range(19_999)})) == 20_000


def test_sources_come_before_what_they_feed_and_cycles_stay_in_the_order_of_the_file() -> None:
    chain = [_connection("b", "a"), _connection("c", "b")]
    assert order(["a", "b", "c"], chain) == ["c", "b", "a"]
    cycle = [*chain, _connection("a", "c"), _connection("wave", "b")]
    assert order(["a", "b", "c", "wave"], cycle) == ["wave", "a", "b", "c"]
