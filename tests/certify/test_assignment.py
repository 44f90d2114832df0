"""The linear assignment problem in whole numbers, against trying every assignment."""

from __future__ import annotations

from itertools import permutations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from msmrta_opt.certify.assignment import minimum_cost


@given(
    n=st.integers(1, 4),
    more=st.integers(0, 3),
    largest=st.sampled_from([1, 5, 10**6, 10**15]),
    seed=st.integers(0, 2**32 - 1),
)
def test_the_cheapest_of_all_assignments_is_found(
    n: int, more: int, largest: int, seed: int
) -> None:
    cost = np.random.RandomState(seed).randint(0, largest + 1, size=(n, n + more), dtype=np.int64)
    every = (
        sum(int(cost[i, j]) for i, j in enumerate(chosen))
        for chosen in permutations(range(n + more), n)
    )
    assert minimum_cost(cost) == min(every)


def test_by_hand() -> None:
    """Rows 0 and 1 both want column 0; giving it to row 1 and column 2 to row 0 costs 2 + 1."""
    assert minimum_cost(np.array([[1, 9, 2], [1, 8, 5]], dtype=np.int64)) == 3
