"""How scouts choose their next cell: ant-colony grid search, random walk, Lévy walk.

Each walk is a function that is given the `Ground` once and returns the rule by which scouts move;
`WALKS` holds them by name. The paper's is the ant-colony grid search (after Dorigo, Maniezzo and
Colorni, 1996), which prevents "redundant coverage via a search table"; the others are what it is
usually compared with.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ..mission.grid import Cell

Walk = Callable[[int, Cell], Cell]
"""The free neighbour to which the scout with that index (document order) goes from that cell.

Asked only of scouts that have a free neighbour."""


@dataclass(frozen=True)
class Ground:
    """What a walk is made on.

    Parameters
    ----------
    neighbours : function of a cell
        Its free neighbours, always in the same order.
    starts : sequence of cells
        Where each scout begins, in document order.
    shared_table : bool
        Whether scouts share one table of visits or keep one each. Walks without a table ignore it.
    random : numpy.random.RandomState
        The source of all chance. Its streams are frozen by numpy for good.
    """

    neighbours: Callable[[Cell], Sequence[Cell]]
    starts: Sequence[Cell]
    shared_table: bool
    random: np.random.RandomState

    def any_of(self, cells: Sequence[Cell]) -> Cell:
        """One of `cells`, each as likely as the others."""
        return cells[self.random.randint(len(cells))] if len(cells) > 1 else cells[0]


def ant_colony(ground: Ground) -> Walk:
    """Go to the least visited free neighbour; ties are broken by chance.

    A table counts the visits of each cell, the start's included. With a shared table a scout's move
    counts at once, so that those who move after it in the same step already avoid its cell.
    """
    if ground.shared_table:
        tables = [Counter(ground.starts)] * len(ground.starts)
    else:
        tables = [Counter([start]) for start in ground.starts]

    def move(scout: int, here: Cell) -> Cell:
        visits, options = tables[scout], ground.neighbours(here)
        fewest = min(visits[cell] for cell in options)
        there = ground.any_of([cell for cell in options if visits[cell] == fewest])
        visits[there] += 1
        return there

    return move


def random_walk(ground: Ground) -> Walk:
    """Go to any free neighbour, all equally likely."""

    def move(scout: int, here: Cell) -> Cell:
        return ground.any_of(ground.neighbours(here))

    return move


def levy_walk(ground: Ground) -> Walk:
    """Make straight runs of heavy-tailed length, each in a direction drawn from the free ones.

    A run is at least ``n`` cells long with probability ``1 / n``: a power law of exponent 2, the
    best for sparse targets (Viswanathan et al., 1999). A wall ends a run early.
    """
    runs: dict[int, tuple[Cell, int]] = {}

    def move(scout: int, here: Cell) -> Cell:
        options = ground.neighbours(here)
        (down, right), left_to_go = runs.get(scout, ((0, 0), 0))
        there = (here[0] + down, here[1] + right)
        if left_to_go == 0 or there not in options:
            there = ground.any_of(options)
            left_to_go = int(1 / (1 - ground.random.random_sample()))
        runs[scout] = ((there[0] - here[0], there[1] - here[1]), left_to_go - 1)
        return there

    return move


WALKS: Mapping[str, Callable[[Ground], Walk]] = MappingProxyType(
    {"ant_colony": ant_colony, "random": random_walk, "levy": levy_walk}
)
"""The walks by name."""
