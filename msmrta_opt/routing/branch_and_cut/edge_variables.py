r"""Variables of the edge formulation: the joint problem on undirected edges, one layer per robot.

For each robot r, over the victims v that it can serve at all,

- ``y[r,v]``     r visits v
- ``f[r,v]``     v is the first, ``l[r,v]`` the last victim that r visits
- ``e[r,{i,j}]`` r walks between i and j, in either direction, since walking is symmetric
- ``a[r,v,k]``   r serves kind k at v (only where loads matter, see `edge_formulation`)
- ``T``          the makespan (only for that objective)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Self

import numpy as np

from ...arrays import Bools, Floats, Ints
from ...optimise.program import Block
from ..objective_step import ROUNDING, objective_step
from ..objectives import Objective, objective_of
from ..problem import RoutingData


@dataclass(frozen=True, eq=False)
class EdgeVariables:
    """All variables, whether a relaxation uses them or not; a column is the number of one.

    In this order: ``y``, ``f``, ``l`` (one each per *pair* of a robot and a victim that it can serve),
    ``a``, ``T``, and the edges.
    """

    data: RoutingData
    objective: Objective
    pairs: Ints
    """Robot and victim of each pair, ``(n_pairs, 2)``."""
    services: Ints
    """Pair and kind of each ``a``, ``(n_services, 2)``."""
    edges: Ints
    """Robot, smaller and larger victim of each edge, ``(n_edges, 3)``, by robot."""
    upper_value: float
    """What the objective need not exceed: the upper bound of ``T``."""
    time_weight: float = 0.0
    """Weight of each robot's time beside the makespan in `weighted_cost`; 0 for total time."""

    @classmethod
    def of(
        cls,
        data: RoutingData,
        objective: str | Objective,
        upper_value: float,
        *,
        maximum_weight: float = 1e-3,
    ) -> Self:
        """The variables of `data`.

        Parameters
        ----------
        data : RoutingData
            The joint problem.
        objective : str or Objective
            What to minimise.
        upper_value : float
            What the objective need not exceed.
        maximum_weight : float
            Of all robots' times together beside the makespan.

        Raises
        ------
        InputError
            If it does not state the objective.
        """
        objective = objective_of(objective)
        objective.require("branch and cut")
        pairs = np.argwhere(data.can_visit)
        loads = objective.only_last or bool(np.isfinite(data.endurance).any())
        services = np.empty((0, 2), dtype=np.int64)
        if loads:
            services = np.argwhere(data.able[pairs[:, 0], pairs[:, 1]])
        edges = [np.empty((0, 3), dtype=np.int64)]
        for r in range(data.n_robots):
            own = np.flatnonzero(data.can_visit[r])
            i, j = np.triu_indices(len(own), 1)
            edges.append(np.column_stack([np.full(len(i), r), own[i], own[j]]))
        time_weight = 0.0
        if objective.only_last:
            # All times together weigh less than half a step, or than rounding: they never outweigh
            # the makespan.
            step = objective_step(data, objective).step
            share = step / max(upper_value, step) if step else ROUNDING
            share /= 2.0
            time_weight = min(share, maximum_weight) / data.n_robots
        every = np.concatenate(edges)
        return cls(data, objective, pairs, services, every, float(upper_value), time_weight)

    @property
    def n_pairs(self) -> int:
        """Number of robots and victims that go together."""
        return len(self.pairs)

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """The named columns."""
        named = [("y", self.n_pairs), ("f", self.n_pairs), ("l", self.n_pairs)]
        named += [("a", len(self.services)), ("T", int(self.objective.only_last))]
        named += [("e", len(self.edges))]
        starts = np.cumsum([0, *(size for _, size in named)])
        return tuple(
            Block(name, int(start), (size,))
            for (name, size), start in zip(named, starts, strict=False)
        )

    def start(self, name: str) -> int:
        """First column of the block `name`."""
        return next(block.start for block in self.blocks if block.name == name)

    @property
    def n_columns(self) -> int:
        """Number of columns."""
        return self.blocks[-1].stop

    @cached_property
    def pair_of(self) -> Ints:
        """Pair of robot r and victim v, -1 if there is none, ``(n_robots, n_victims)``."""
        position = np.full(self.data.can_visit.shape, -1)
        position[self.pairs[:, 0], self.pairs[:, 1]] = np.arange(self.n_pairs)
        return position

    @cached_property
    def edge_of_robot(self) -> tuple[slice, ...]:
        """The edges of each robot."""
        ends = np.searchsorted(self.edges[:, 0], np.arange(self.data.n_robots + 1))
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))

    @cached_property
    def travel(self) -> Floats:
        """Travel time of each column, ``(n_columns,)``."""
        robot, victim = self.pairs.T
        time = np.zeros(self.n_columns)
        time[self.start("f") :][: self.n_pairs] = self.data.leave[robot, victim]
        time[self.start("l") :][: self.n_pairs] = self.data.back[robot, victim]
        time[self.start("e") :] = self.data.way(*self.edges.T)
        return time

    @cached_property
    def busy(self) -> Floats:
        """Travel or service time of each column, ``(n_columns,)``."""
        time = self.travel.copy()
        pair, kind = self.services.T
        time[self.start("a") :][: len(pair)] = self.data.service[self.pairs[pair, 1], kind]
        return time

    @cached_property
    def robot(self) -> Ints:
        """Robot of each column, -1 for ``T``, ``(n_columns,)``."""
        of_pair = self.pairs[:, 0]
        of_service = of_pair[self.services[:, 0]]
        nobody = np.full(int(self.objective.only_last), -1)
        return np.concatenate([of_pair, of_pair, of_pair, of_service, nobody, self.edges[:, 0]])

    @cached_property
    def cost(self) -> Floats:
        """Objective without `offset`, ``(n_columns,)``."""
        if self.objective.service_is_constant:
            return self.travel
        cost = np.zeros(self.n_columns)
        cost[self.start("T")] = 1.0
        return cost

    @cached_property
    def weighted_cost(self) -> Floats:
        """What solvers minimise instead of `cost`, ``(n_columns,)``.

        Only the busiest robots count for the makespan; the edges of all others would be as good as
        any, and no cut would ever straighten them. So every robot's time counts a little. As none
        exceeds T, the minimum of this over ``1 + n_robots * time_weight`` is a bound on T, too.
        """
        return self.cost + self.time_weight * self.busy

    @property
    def weight_of_value(self) -> float:
        """``1 + n_robots * time_weight``: a bound on the weighted cost over this is one on the cost."""
        return 1.0 + self.data.n_robots * self.time_weight

    def value(self, x: Floats) -> float:
        """The objective at an integral point, ``(n_columns,)``."""
        if self.objective.service_is_constant:
            return float(self.cost @ x) + self.offset
        moves = self.robot >= 0
        return float(
            np.bincount(self.robot[moves], weights=(self.busy * x)[moves]).max(initial=0.0)
        )

    @property
    def offset(self) -> float:
        """What every solution costs: all service, for total time."""
        return self.data.total_service if self.objective.service_is_constant else 0.0

    @cached_property
    def upper(self) -> Floats:
        """Upper bounds of the columns, ``(n_columns,)``; the lower ones are 0."""
        upper = np.ones(self.n_columns)
        if self.objective.only_last:
            upper[self.start("T")] = self.upper_value
        return upper

    @cached_property
    def integer(self) -> Bools:
        """All columns but ``T``, ``(n_columns,)``."""
        integer = np.ones(self.n_columns, dtype=bool)
        if self.objective.only_last:
            integer[self.start("T")] = False
        return integer

    @cached_property
    def service_place(self) -> dict[tuple[int, int], int]:
        """Which service a pair and a kind are."""
        return {(pair, kind): n for n, (pair, kind) in enumerate(self.services.tolist())}

    @cached_property
    def edge_place(self) -> dict[tuple[int, int, int], int]:
        """Which edge a robot and two victims are."""
        return {(r, i, j): n for n, (r, i, j) in enumerate(self.edges.tolist())}

    @cached_property
    def ends(self) -> Ints:
        """The victims that each column is about, ``(n_columns, 2)``; n_victims for none."""
        ends = np.full((self.n_columns, 2), self.data.n_victims)
        victim = self.pairs[:, 1]
        for name in "yfl":
            ends[self.start(name) :][: self.n_pairs] = victim[:, None]
        ends[self.start("a") :][: len(self.services)] = victim[self.services[:, 0], None]
        ends[self.start("e") :] = self.edges[:, 1:]
        return ends
