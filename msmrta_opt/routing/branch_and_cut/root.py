"""What the root relaxation leaves to be done: subproblems within bounds that reduced costs tighten."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Bools, Floats
from ..incumbent import Progress
from ..parameters import Parameters
from ..stop import StoppingCriterion
from .cutting_plane import Relaxed
from .edge_formulation import EdgeFormulation, Row
from .points import point_of
from .reduced_cost_fixing import fixed
from .subproblem import Subproblem, Tree
from .symmetry import own_visits
from .tree import search_tree


@dataclass(frozen=True, eq=False)
class Root:
    """A search once its root relaxation is solved."""

    progress: Progress
    formulation: EdgeFormulation
    relaxed: Relaxed
    seen: Bools
    """Columns that were positive at one of the relaxation's last points, ``(n_columns,)``."""
    seed: int
    parameters: Parameters

    @cached_property
    def own_visits(self) -> list[Row]:
        """Rows of every tree."""
        return own_visits(self.formulation)

    def used(self) -> Bools:
        """The columns that the incumbent uses, ``(n_columns,)``."""
        return np.asarray(point_of(self.formulation, self.progress.routes) > 0)

    def search(
        self,
        upper: Floats,
        *,
        stop: StoppingCriterion,
        rows: Sequence[Row] = (),
        proved: Callable[[float], object] = lambda bound: None,
    ) -> Tree:
        """Branch and cut for better routes than the incumbent on the columns whose `upper` is not 0.

        Parameters
        ----------
        upper : array, shape (n_columns,)
            Upper bounds of the columns.
        stop : StoppingCriterion
            When to end.
        rows : sequence of Row
            Besides those that every tree has.
        proved : callable
            Told of the bound within `upper`.
        """
        known = self.progress.value
        lower, upper = fixed(self.formulation, self.relaxed, known, np.zeros(len(upper)), upper)
        tree = search_tree(
            Subproblem(
                self.formulation, lower, upper, known, self.relaxed.cuts, [*self.own_visits, *rows]
            ),
            stop=stop,
            seed=self.seed,
            parameters=self.parameters.branch_and_cut,
            improved=self.progress.offer,
            proved=proved,
        )
        for failure in tree.failures:
            self.progress.begin(failure)
        return tree
