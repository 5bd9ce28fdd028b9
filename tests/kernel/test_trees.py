"""The trees behind the order conditions."""

from __future__ import annotations

from tests.kernel.trees import index_one_trees, trees


def test_there_are_as_many_trees_as_butcher_says() -> None:
    assert [len(trees(order)) for order in range(1, 7)] == [1, 1, 2, 4, 9, 20]


def test_small_trees_of_index_one() -> None:
    """y' = f, y'' = f_y f + f_z z'; z' of f, z'' of each of these two and of f f, f z', z' z'."""
    leaf = (False, ())
    slope = (True, (leaf,))
    two = ((False, (leaf,)), (False, (slope,)))
    assert index_one_trees(1, fat=False) == (leaf,) and index_one_trees(1, fat=True) == (slope,)
    assert index_one_trees(2, fat=False) == two
    pairs = {(leaf, leaf), (leaf, slope), (slope, slope)}
    assert set(index_one_trees(2, fat=True)) == {(True, (tree,)) for tree in two} | {(True, pair) for pair in pairs}


def test_no_tree_of_index_one_comes_twice() -> None:
    for order in range(1, 5):
        for fat in (False, True):
            assert len(set(index_one_trees(order, fat=fat))) == len(index_one_trees(order, fat=fat))
