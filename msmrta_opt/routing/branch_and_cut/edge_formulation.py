r"""The joint problem as an integer program on undirected edges: its columns and its first rows.

For each robot r, over the victims v that it can serve at all,

- ``y[r,v]``     r visits v
- ``f[r,v]``     v is the first, ``l[r,v]`` the last victim that r visits
- ``e[r,{i,j}]`` r walks between i and j, in either direction, since walking is symmetric
- ``a[r,v,k]``   r serves kind k at v (only where loads matter, see below)
- ``T``          the makespan (only for that objective)

with the rows

    sum over e at v + f[r,v] + l[r,v] = 2 y[r,v]     every visited vertex has degree two
    sum_v f[r,v] = sum_v l[r,v] ≤ 1                  a robot starts and ends once, or stays at home
    sum_r a[r,v,k] = 1,  a[r,v,k] ≤ y[r,v]           every requirement is served, by a visitor
    time of r ≤ T, ≤ endurance;  travel of r ≤ longest walk

and the connectivity cuts of `cuts`, which are too many to be written down.

Where only travel counts (total time without endurance), who of the visitors serves what is
immaterial: ``a`` disappears, and what remains of it is ``sum_{r able} y[r,v] ≥ 1`` for those kinds k
of v whose able robots contain no other kind's. Service is then a constant.

Source: the vertex-visiting ("generalised") symmetric travelling salesman formulation of Fischetti,
Salazar González and Toth, Networks 26 (1995) and Operations Research 45 (1997), one layer per robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array, vstack

from ...arrays import Bools, Floats, Ints
from ...mission.errors import InputError
from ...optimise.program import Block, Program
from ..objective_step import objective_step
from ..objectives import Objective, objective_of
from ..problem import Routes, RoutingData
from .rows import Rows
from .separation import Cut

ATTENTION = 1e-3
"""Share of the objective that goes to all robots' times together, for the makespan."""


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns and first rows of the joint problem; all edges, whether a relaxation uses them or not.

    Order of the columns: ``y``, ``f``, ``l`` (one each per *pair* of a robot and a victim that it
    can serve), ``a``, ``T``, and the edges.
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
    attention: float = 0.0
    """Weight of each robot's time beside the makespan in `guide`; 0 for total time."""

    @classmethod
    def of(cls, data: RoutingData, objective: str | Objective, upper_value: float) -> Columns:
        """The columns of `data`.

        Raises
        ------
        InputError
            If it does not state the objective.
        """
        objective = objective_of(objective)
        if objective.method != "branch and cut":
            raise InputError(
                f"{objective.name!r} is solved by {objective.method}", field="objective"
            )
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
        attention = 0.0
        if objective.only_last:
            # All times together weigh less than half a grain: they never outweigh the makespan.
            step = objective_step(data, objective).step
            share = step / (2.0 * max(upper_value, step)) if step else ATTENTION
            attention = min(share, ATTENTION) / data.n_robots
        every = np.concatenate(edges)
        return cls(data, objective, pairs, services, every, float(upper_value), attention)

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
        time[self.start("e") :] = self.data.between[tuple(self.edges.T)]
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
    def guide(self) -> Floats:
        """What solvers minimise instead of `cost`, ``(n_columns,)``.

        Only the busiest robots count for the makespan; the edges of all others would be as good as
        any, and no cut would ever straighten them. So every robot's time counts a little. As none
        exceeds T, the least guide over ``1 + n_robots * attention`` is a bound on T, too.
        """
        return self.cost + self.attention * self.busy

    def worth(self, x: Floats) -> float:
        """The objective at an integral point, ``(n_columns,)``."""
        if self.objective.service_is_constant:
            return float(self.cost @ x) + self.offset
        moves = self.robot >= 0
        return float(
            np.bincount(self.robot[moves], weights=(self.busy * x)[moves]).max(initial=0.0)
        )

    def unguided(self, prices: Floats) -> Floats:
        """Prices for `cost` that prove as much as `prices` do for `guide`.

        The guide is the makespan, with a little of every row ``time of r ≤ T`` added: so its
        prices take that little more of those rows, all scaled to an objective of T again.
        """
        if not self.attention:
            return prices
        prices = prices.copy()
        own = slice(self.rows[0].shape[0] - self.data.n_robots, self.rows[0].shape[0])
        prices[own] -= self.attention
        return prices / (1.0 + self.data.n_robots * self.attention)

    @property
    def offset(self) -> float:
        """What every answer costs: all service, for total time."""
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
    def rows(self) -> tuple[csr_array, Floats, Floats]:
        """First rows: matrix ``(n_rows, n_columns)``, lower and upper sides ``(n_rows,)``."""
        rows = Rows(self.n_columns)
        y, f, last, a, e = (self.start(name) for name in "yflae")
        pair = np.arange(self.n_pairs)
        one = np.ones(self.n_pairs)
        edge = np.arange(len(self.edges))
        tail = self.pair_of[self.edges[:, 0], self.edges[:, 1]]
        head = self.pair_of[self.edges[:, 0], self.edges[:, 2]]
        rows.add(
            np.concatenate([pair, pair, pair, tail, head]),
            np.concatenate([y + pair, f + pair, last + pair, e + edge, e + edge]),
            np.concatenate([-2 * one, one, one, np.ones(2 * len(edge))]),
            np.zeros(self.n_pairs),
            np.zeros(self.n_pairs),
        )
        n, robot = self.data.n_robots, self.pairs[:, 0]
        rows.add(robot, f + pair, one, np.zeros(n), np.ones(n))
        rows.add(
            np.concatenate([robot, robot]),
            np.concatenate([f + pair, last + pair]),
            np.concatenate([one, -one]),
            np.zeros(n),
            np.zeros(n),
        )
        if len(self.services):
            self._add_services(rows, y, a)
        else:
            self._add_covering(rows, y)
        self._add_limits(rows)
        return rows.done()

    def _add_services(self, rows: Rows, y: int, a: int) -> None:
        position = np.full(self.data.required.shape, -1)
        position[self.data.required] = np.arange(self.data.required.sum())
        pair, kind = self.services.T
        service = np.arange(len(pair))
        one = np.ones(len(pair))
        sides = np.ones(int(self.data.required.sum()))
        rows.add(position[self.pairs[pair, 1], kind], a + service, one, sides, sides)
        rows.add(
            np.concatenate([service, service]),
            np.concatenate([a + service, y + pair]),
            np.concatenate([one, -one]),
            np.full(len(pair), -np.inf),
            np.zeros(len(pair)),
        )

    def _add_covering(self, rows: Rows, y: int) -> None:
        victim, kind = decisive(self.data).T
        row, robot = np.nonzero(self.data.able[:, victim, kind].T)
        column = y + self.pair_of[robot, victim[row]]
        sides = np.ones(len(victim))
        rows.add(row, column, np.ones(len(column)), sides, np.full(len(victim), np.inf))

    def _add_limits(self, rows: Rows) -> None:
        data = self.data
        for time, most in ((self.busy, data.endurance), (self.travel, data.longest_walk)):
            limited = np.flatnonzero(np.isfinite(most))
            row = np.full(data.n_robots, -1)
            row[limited] = np.arange(len(limited))
            used = np.flatnonzero((self.robot >= 0) & (time != 0) & (row[self.robot] >= 0))
            below = np.full(len(limited), -np.inf)
            rows.add(row[self.robot[used]], used, time[used], below, most[limited])
        if self.objective.only_last:
            used = np.flatnonzero((self.robot >= 0) & (self.busy != 0))
            robots = np.arange(data.n_robots)
            rows.add(
                np.concatenate([self.robot[used], robots]),
                np.concatenate([used, np.full(data.n_robots, self.start("T"))]),
                np.concatenate([self.busy[used], -np.ones(data.n_robots)]),
                np.full(data.n_robots, -np.inf),
                np.zeros(data.n_robots),
            )

    def cut_row(self, cut: Cut) -> tuple[Ints, Floats]:
        """Columns and coefficients of a connectivity cut; its sides are -inf and 0."""
        inside = np.zeros(self.data.n_victims, dtype=bool)
        inside[list(cut.members)] = True
        slice_ = self.edge_of_robot[cut.robot]
        edges = self.edges[slice_]
        within = np.flatnonzero(inside[edges[:, 1]] & inside[edges[:, 2]]) + slice_.start
        members = self.pair_of[cut.robot, list(cut.members)]
        y, f, last, e = (self.start(name) for name in "yfle")
        parts: list[tuple[Ints, float]] = [(e + within, 1.0), (y + members, -1.0)]
        if cut.first:
            parts.append((f + members, 1.0))
        if cut.last:
            parts.append((last + members, 1.0))
        if cut.vertex is not None:
            parts.append((np.array([y + self.pair_of[cut.robot, cut.vertex]]), 1.0))
        if cut.first and cut.last:
            own = self.pair_of[cut.robot]
            parts.append((f + own[own >= 0], -1.0))
        column = np.concatenate([columns for columns, _ in parts])
        weight = np.concatenate([np.full(len(columns), w) for columns, w in parts])
        unique, where = np.unique(column, return_inverse=True)
        total = np.bincount(where, weights=weight, minlength=len(unique))
        return unique[total != 0], total[total != 0]

    @cached_property
    def _service_place(self) -> dict[tuple[int, int], int]:
        """Which service a pair and a kind are."""
        return {(pair, kind): n for n, (pair, kind) in enumerate(self.services.tolist())}

    @cached_property
    def _edge_place(self) -> dict[tuple[int, int, int], int]:
        """Which edge a robot and two victims are."""
        return {(r, i, j): n for n, (r, i, j) in enumerate(self.edges.tolist())}

    def point(self, routes: Routes) -> Floats:
        """The columns' values on `routes`, ``(n_columns,)``."""
        x = np.zeros(self.n_columns)
        y, f, last, a, e = (self.start(name) for name in "yflae")
        service, edge = self._service_place, self._edge_place
        for r, route in enumerate(routes):
            for (v, kinds), onward in zip(route, [*route[1:], None], strict=False):
                pair = int(self.pair_of[r, v])
                x[y + pair] = 1.0
                for k in kinds:
                    if service:
                        x[a + service[pair, k]] = 1.0
                if onward is not None:
                    x[e + edge[r, min(v, onward[0]), max(v, onward[0])]] = 1.0
            if route:
                x[f + self.pair_of[r, route[0][0]]] = 1.0
                x[last + self.pair_of[r, route[-1][0]]] = 1.0
        if self.objective.only_last:
            x[self.start("T")] = self.objective.value(self.data, routes)
        return x

    def program(self, cuts: list[Cut]) -> Program:
        """The integer program with `cuts` as further rows."""
        matrix, lower, upper = self.rows
        cut_rows = Rows(self.n_columns)
        for cut in cuts:
            column, weight = self.cut_row(cut)
            zero = np.zeros(len(column), dtype=np.int64)
            cut_rows.add(zero, column, weight, np.array([-np.inf]), np.zeros(1))
        cut_matrix, cut_lower, cut_upper = cut_rows.done()
        blocks = (Block("row {i}", 0, (len(lower),)), Block("cut {i}", len(lower), (len(cuts),)))
        return Program(
            sense="min",
            cost=self.cost,
            offset=self.offset,
            matrix=csr_array(vstack([matrix, cut_matrix])),
            row_lower=np.concatenate([lower, cut_lower]),
            row_upper=np.concatenate([upper, cut_upper]),
            lower=np.zeros(self.n_columns),
            upper=self.upper,
            integer=self.integer,
            columns=self.blocks,
            rows=blocks,
        )


def decisive(data: RoutingData) -> Ints:
    """Requirements whose able robots contain those of no other kind of the same victim.

    Of kinds with the same able robots, the first. Shape ``(n_decisive, 2)``: victim and kind.
    """
    kept = []
    for v in range(data.n_victims):
        kinds = np.flatnonzero(data.required[v]).tolist()
        able = {k: frozenset(np.flatnonzero(data.able[:, v, k]).tolist()) for k in kinds}
        kept += [
            (v, k)
            for k in kinds
            if not any(
                able[other] < able[k] or (able[other] == able[k] and other < k) for other in kinds
            )
        ]
    return np.array(kept, dtype=np.int64).reshape(-1, 2)
