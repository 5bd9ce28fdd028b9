"""Rooted trees: an order condition each, of every one-step method.

For ordinary equations Butcher's. For y' = f(y, z), 0 = g(y, z) of index 1 Roche's, with vertices of two kinds: meagre
for f, fat for what g = 0 says of z (Hairer & Wanner, Solving Ordinary Differential Equations II, section VI.4).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from math import prod

__all__ = ["IndexOneTree", "Tree", "density", "index_one_density", "index_one_trees", "trees"]

Tree = tuple["Tree", ...]
"""A rooted tree: its branches, sorted."""

IndexOneTree = tuple[bool, tuple["IndexOneTree", ...]]
"""(whether the root is fat, its branches). The order is the number of meagre vertices."""


@cache
def trees(order: int) -> frozenset[Tree]:
    """All rooted trees with `order` vertices: a leaf put on every vertex of the smaller ones."""
    if order == 1:
        return frozenset({()})
    return frozenset(grown for tree in trees(order - 1) for grown in with_a_leaf_more(tree))


def with_a_leaf_more(tree: Tree) -> Iterable[Tree]:
    yield tuple(sorted([*tree, ()]))
    for k, branch in enumerate(tree):
        for grown in with_a_leaf_more(branch):
            yield tuple(sorted([*tree[:k], grown, *tree[k + 1 :]]))


def size(tree: Tree) -> int:
    return 1 + sum(map(size, tree))


def density(tree: Tree) -> int:
    """gamma(tree) of the condition sum_i b_i phi_i(tree) = 1 / gamma(tree)."""
    return size(tree) * prod(map(density, tree))


@cache
def index_one_trees(order: int, *, fat: bool) -> tuple[IndexOneTree, ...]:
    """All with that many meagre vertices and that root; a fat vertex carries more than a single fat one."""
    if not fat:
        return tuple((False, branches) for branches in forests(order - 1, order - 1))
    one = ((tree,) for tree in index_one_trees(order, fat=False))
    return tuple((True, branches) for branches in [*one, *forests(order, order - 1)])


def forests(order: int, largest: int) -> Iterator[tuple[IndexOneTree, ...]]:
    """Every choice of trees with `order` meagre vertices in all, none of them with more than `largest`."""
    choice = [
        (size, tree)
        for size in range(1, largest + 1)
        for fat in (False, True)
        for tree in index_one_trees(size, fat=fat)
    ]

    def chosen(rest: int, start: int) -> Iterator[tuple[IndexOneTree, ...]]:
        if rest == 0:
            yield ()
        for k in range(start, len(choice)):
            size, tree = choice[k]
            if size > rest:
                break
            for others in chosen(rest - size, k):
                yield (tree, *others)

    return chosen(order, 0)


def meagre_vertices(tree: IndexOneTree) -> int:
    fat, branches = tree
    return (not fat) + sum(map(meagre_vertices, branches))


def index_one_density(tree: IndexOneTree) -> int:
    """As density(): y integrates the product of its branches, z is it."""
    fat, branches = tree
    return (1 if fat else meagre_vertices(tree)) * prod(map(index_one_density, branches))
