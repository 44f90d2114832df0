from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np
import pytest
from support.amounts import sample

from msmrta_opt.mission.grid import Cell
from msmrta_opt.stages.walks import WALKS, Ground, Walk, ant_colony, levy_walk, random_walk


class Script:
    """Chance that follows a script: always the first choice, and the given fractions in order."""

    def __init__(self, fractions: Iterable[float] = ()) -> None:
        self.fractions = iter(fractions)
        self.n_choices = 0

    def randint(self, n: int) -> int:
        self.n_choices += 1
        return 0

    def random_sample(self) -> float:
        return next(self.fractions)


def ground(
    rows: list[str],
    starts: list[Cell],
    *,
    shared_table: bool = True,
    random: np.random.RandomState | Script | None = None,
) -> Ground:
    """A small map whose neighbours come in the order up, down, left, right."""

    def neighbours(cell: Cell) -> list[Cell]:
        row, col = cell
        around = [(row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)]
        return [
            (r, c)
            for r, c in around
            if 0 <= r < len(rows) and 0 <= c < len(rows[0]) and rows[r][c] == "."
        ]

    return Ground(neighbours, starts, shared_table, random or np.random.RandomState(0))


def follow(walk: Walk, start: Cell, n_moves: int) -> list[Cell]:
    cells = [start]
    for _ in range(n_moves):
        cells.append(walk(0, cells[-1]))
    return cells


PLUS = ["@.@", "...", "@.@"]
CENTRE = (1, 1)


def test_the_walks_are_known_by_these_names() -> None:
    assert set(WALKS) == {"ant_colony", "random", "levy"}


@pytest.mark.parametrize("seed", sample(range(8), 3))
def test_an_ant_goes_where_it_has_been_least(seed: int) -> None:
    # The four arms of the plus differ in visits only, so each is entered once before any is again,
    # and out of an arm there is but the way back.
    on = ground(PLUS, [CENTRE], random=np.random.RandomState(seed))
    cells = follow(ant_colony(on), CENTRE, 16)
    assert cells[::2] == [CENTRE] * 9
    arms = {(0, 1), (1, 0), (1, 2), (2, 1)}
    assert set(cells[1:8:2]) == set(cells[9:16:2]) == arms


def test_an_ant_breaks_ties_by_chance_alone() -> None:
    first = Counter(
        ant_colony(ground(PLUS, [CENTRE], random=np.random.RandomState(seed)))(0, CENTRE)
        for seed in range(400)
    )
    # Each arm has a chance of 1/4: 100 expected, standard deviation 8.7.
    assert len(first) == 4
    assert all(100 - 5 * 8.7 < count < 100 + 5 * 8.7 for count in first.values())


@pytest.mark.parametrize(("shared_table", "there"), [(True, (0, 2)), (False, (0, 0))])
def test_a_shared_table_tells_an_ant_where_others_have_been(
    shared_table: bool, there: Cell
) -> None:
    # Two ants begin at the left end, one at the right; all step to the middle. Of the ends, the
    # left one has two visits by now and the right one has one; the third ant alone knows of none
    # on the left.
    starts = [(0, 0), (0, 0), (0, 2)]
    move = ant_colony(ground(["..."], starts, shared_table=shared_table))
    assert [move(i, start) for i, start in enumerate(starts)] == [(0, 1)] * 3
    assert move(2, (0, 1)) == there


@pytest.mark.parametrize("seed", sample(range(8), 3))
def test_a_shared_move_counts_at_once(seed: int) -> None:
    move = ant_colony(ground(["..."], [(0, 1)] * 2, random=np.random.RandomState(seed)))
    assert {move(0, (0, 1)), move(1, (0, 1))} == {(0, 0), (0, 2)}


def test_a_random_walk_takes_each_free_neighbour_equally_often() -> None:
    move = random_walk(ground(["@.@", "..@", "@.@"], [CENTRE]))
    taken = Counter(move(0, CENTRE) for _ in range(900))
    # Each of the three has a chance of 1/3: 300 expected, standard deviation 14.1.
    assert set(taken) == {(0, 1), (1, 0), (2, 1)}
    assert all(300 - 5 * 14.1 < count < 300 + 5 * 14.1 for count in taken.values())


def test_a_levy_run_is_straight_and_as_long_as_drawn() -> None:
    # 1 - 0.75 = 1/4 of all runs are at least four cells long, so 0.75 is a run of four, up.
    script = Script([0.75, 0.0])
    move = levy_walk(ground(["..."] * 6, [(5, 1)], random=script))
    assert follow(move, (5, 1), 4) == [(5, 1), (4, 1), (3, 1), (2, 1), (1, 1)]
    assert script.n_choices == 1
    assert move(0, (1, 1)) == (0, 1)
    assert script.n_choices == 2


def test_a_wall_ends_a_levy_run() -> None:
    # A run of four, up, is stopped after two moves; the next one begins downwards.
    script = Script([0.75, 0.75])
    move = levy_walk(ground(["@.@", "...", "..."], [(2, 1)], random=script))
    assert follow(move, (2, 1), 4) == [(2, 1), (1, 1), (0, 1), (1, 1), (2, 1)]


def test_levy_runs_follow_a_power_law_of_exponent_two() -> None:
    # P(at least n) = 1 / n, so the fraction 1 - 1/n of all draws is where runs of n cells begin.
    lengths = [1, 2, 4, 8, 16]
    script = Script([1 - 1 / n for n in lengths])
    move = levy_walk(ground([".."] * 42, [(41, 0)], random=script))
    drawn_at, cell = [], (41, 0)
    for i in range(sum(lengths)):
        before = script.n_choices
        cell = move(0, cell)
        if script.n_choices > before:
            drawn_at.append(i)
    assert drawn_at == [0, 1, 3, 7, 15]


def test_each_scout_makes_levy_runs_of_its_own() -> None:
    script = Script([0.5, 0.0, 0.0])
    move = levy_walk(ground(["..."] * 4, [(3, 0), (2, 2)], random=script))
    assert [move(0, (3, 0)), move(1, (2, 2))] == [(2, 0), (1, 2)]
    assert script.n_choices == 2
    assert [move(0, (2, 0)), move(1, (1, 2))] == [(1, 0), (0, 2)]
    assert script.n_choices == 3
