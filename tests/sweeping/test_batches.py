"""How many cases a batch has."""

from __future__ import annotations

import pytest

from cablefmu.sweeping.batches import TARGET, Sizer


def learnt(case: float) -> Sizer:
    sizer = Sizer()
    sizer.learn(10, 10 * case)
    return sizer


def test_the_first_go_one_by_one() -> None:
    assert Sizer().next(1000, 2) == 1
    assert Sizer().next(0, 2) == 0


@pytest.mark.parametrize(("case", "size"), [(0.005, 100), (0.1, 5), (0.4, 1), (60.0, 1)])
def test_a_batch_takes_the_same_time_whatever_a_case_costs(case: float, size: int) -> None:
    assert learnt(case).next(100_000, 2) == size
    assert size == 1 or size * case == pytest.approx(TARGET)


def test_batches_get_smaller_towards_the_end_but_not_smaller_than_a_task_is_worth() -> None:
    sizer, waiting, sizes = learnt(0.005), 300, []
    while waiting:
        sizes.append(sizer.next(waiting, 2))
        waiting -= sizes[-1]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == 75
    assert sizes[-2] == 10
    assert sum(sizes) == 300


def test_what_a_case_costs_may_be_too_little_to_measure() -> None:
    assert learnt(0.0).next(10, 2) == 10
