r"""Branch and cut by SCIP: the program of `columns`, with its connectivity cuts found on the way.

A constraint handler separates the cuts of `cuts` at fractional points, and refuses integral ones
that are not routes. The tree starts with the columns that fixing left, the cuts of the root and the
incumbent. Where all costs are multiples of a grain, the objective is scaled to integers, so that SCIP
rounds its own bounds up; the makespan then is an integer variable.

Source: Achterberg, Constraint Integer Programming (2007), for what a constraint handler must do.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pyscipopt import (
    SCIP_EVENTTYPE,
    SCIP_RESULT,
    Conshdlr,
    Eventhdlr,
    Model,
    quicksum,
)

from ...arrays import Floats, Ints
from ..objective_step import objective_step
from ..problem import Routes
from .edge_formulation import Columns
from .extraction import point_supports, routes_of
from .separation import Cut, separate
from .symmetry import Row
from .tree import Tree

SEPARATE_FROM = 0.02
"""Least violation of a cut at a fractional point."""


@dataclass(eq=False)
class _State:
    """What the plug-ins share."""

    columns: Columns
    used: Ints
    variables: list[Any]
    improved: Callable[[Routes], object]
    ask: Callable[[Model], bool]
    found: float
    """Value of the best answer known."""
    n_cuts: int = 0
    failure: BaseException | None = None
    """What a callback raised: SCIP would swallow it."""

    def guard(self, call: Callable[[], Any], otherwise: Any) -> Any:
        """The call's result; after a failure only `otherwise`, so that SCIP comes to an end."""
        if self.failure is None:
            try:
                return call()
            except BaseException as failure:
                self.failure = failure
        return otherwise

    def point(self, model: Model, solution: Any) -> Floats:
        x = np.zeros(self.columns.n_columns)
        x[self.used] = [model.getSolVal(solution, v) for v in self.variables]
        return x


class _Connected(Conshdlr):  # type: ignore[misc]
    """The edges of each robot form one path from its first to its last victim."""

    def __init__(self, state: _State) -> None:
        self.state = state
        self.place = np.full(state.columns.n_columns, -1)
        self.place[state.used] = np.arange(len(state.used))

    def _cuts(self, x: Floats, tolerance: float) -> list[Cut]:
        supports = point_supports(self.state.columns, x)
        return [cut for s in supports for cut in separate(s, tolerance=tolerance)[:10]]

    def _separate(self, tolerance: float) -> bool:
        x = self.state.point(self.model, None)
        cuts = self._cuts(x, tolerance)
        for cut in cuts:
            column, weight = self.state.columns.cut_row(cut)
            here = self.place[column]
            self.state.n_cuts += 1
            row = self.model.createEmptyRowUnspec(
                f"connected{self.state.n_cuts}", lhs=None, rhs=0.0, local=False, removable=True
            )
            self.model.cacheRowExtensions(row)
            for place, w in zip(here[here >= 0], weight[here >= 0], strict=True):
                self.model.addVarToRow(row, self.state.variables[place], w)
            self.model.flushRowExtensions(row)
            self.model.addCut(row, forcecut=tolerance < SEPARATE_FROM)
            self.model.addPoolCut(row)
            self.model.releaseRow(row)
        return bool(cuts)

    def conssepalp(self, constraints: Any, nusefulconss: int) -> dict[str, Any]:
        found = self._separate(SEPARATE_FROM)
        return {"result": SCIP_RESULT.SEPARATED if found else SCIP_RESULT.DIDNOTFIND}

    def consenfolp(self, constraints: Any, n: int, infeasible: bool) -> dict[str, Any]:
        found = self._separate(1e-4)
        return {"result": SCIP_RESULT.SEPARATED if found else SCIP_RESULT.FEASIBLE}

    def consenfops(self, constraints: Any, n: int, infeasible: bool, obj: bool) -> dict[str, Any]:
        x = self.state.point(self.model, None)
        connected = routes_of(self.state.columns, np.round(x)) is not None
        return {"result": SCIP_RESULT.FEASIBLE if connected else SCIP_RESULT.INFEASIBLE}

    def conscheck(self, constraints: Any, solution: Any, *_: Any, **__: Any) -> dict[str, Any]:
        x = self.state.point(self.model, solution)
        routes = routes_of(self.state.columns, np.round(x))
        if routes is not None:
            self.state.found = min(self.state.found, self.state.columns.worth(np.round(x)))
            self.state.guard(lambda: self.state.improved(routes), None)
        return {"result": SCIP_RESULT.INFEASIBLE if routes is None else SCIP_RESULT.FEASIBLE}

    def conslock(self, constraint: Any, kind: Any, positive: int, negative: int) -> None:
        both = positive + negative
        for v in self.state.variables:
            self.model.addVarLocksType(v, kind, both, both)


class _Watch(Eventhdlr):  # type: ignore[misc]
    """Asks after every node and linear program whether to go on, and for better answers only."""

    def __init__(self, state: _State, limit: Callable[[float], float]) -> None:
        self.state, self.limit, self.found = state, limit, state.found

    def eventinit(self) -> None:
        self.model.catchEvent(SCIP_EVENTTYPE.NODESOLVED, self)
        self.model.catchEvent(SCIP_EVENTTYPE.LPSOLVED, self)

    def eventexit(self) -> None:
        self.model.dropEvent(SCIP_EVENTTYPE.NODESOLVED, self)
        self.model.dropEvent(SCIP_EVENTTYPE.LPSOLVED, self)

    def eventexec(self, event: Any) -> None:
        if self.state.guard(lambda: self.state.ask(self.model), True):
            self.model.interruptSolve()
        elif self.state.found < self.found:
            self.found = self.state.found
            self.model.setObjlimit(self.limit(self.found))


def solve(
    columns: Columns,
    cuts: tuple[Cut, ...],
    lower: Floats,
    upper: Floats,
    *,
    best: float,
    time_limit: float,
    seed: int = 0,
    improved: Callable[[Routes], object] = lambda routes: None,
    go_on: Callable[[float], bool] = lambda bound: True,
    more: Sequence[Row] = (),
    verbose: bool = False,
) -> Tree:
    """Solve the program within the columns' bounds for answers better than `best`.

    Parameters
    ----------
    columns : Columns
        The program.
    cuts : tuple of Cut
        Cuts to start with.
    lower, upper : float arrays, shape (n_columns,)
        Bounds of the columns; those fixed to 0 stay out.
    best : float
        Value of the best answer known; only better ones are looked for.
    time_limit : float
        Seconds.
    seed : int
        Of SCIP's random choices.
    improved : callable
        Called with the routes of every integral point that satisfies all cuts.
    go_on : callable
        Asked with the bound proved so far; if false, the tree stops.
    more : sequence of Row
        Rows besides, see `narrow`.
    """
    grain = objective_step(columns.data, columns.objective)
    step = grain.step or 1.0
    model = Model()
    if not verbose:
        model.hideOutput()
    used = np.flatnonzero(upper > 0)
    scaled = columns.objective.only_last and grain.step > 0
    # Who visits whom decides; given that, the routes' relaxation is all but integral.
    priority = np.zeros(columns.n_columns)
    priority[columns.start("a") : columns.start("e")] = 10
    priority[: columns.n_pairs] = 20
    variables = []
    for j in used:
        time_ = not columns.integer[j]
        kind = ("I" if grain.step else "C") if time_ else "B"
        unit = step if time_ and scaled else 1.0
        cost = columns.guide[j] * unit / step
        cost = round(cost) if grain.step and not columns.attention else cost
        low, high = lower[j] / unit, upper[j] / unit
        if kind == "I":
            low, high = np.ceil(low - 1e-6), np.floor(high + 1e-6)
        variables.append(model.addVar(vtype=kind, lb=low, ub=high, obj=cost))
        model.chgVarBranchPriority(variables[-1], int(priority[j]))
    place = np.full(columns.n_columns, -1)
    place[used] = np.arange(len(used))
    _add_rows(model, columns, variables, place, cuts, more, step if scaled else 1.0)

    until = time.monotonic() + time_limit

    def proved(scip: Model) -> float:
        bound = float(scip.getDualbound()) / (1.0 + columns.data.n_robots * columns.attention)
        return columns.offset + step * bound if abs(bound) < 1e19 else -np.inf

    def limit(known: float) -> float:
        least = (grain.below(known) - columns.offset) / step
        if grain.step:
            # Half a step beyond the last better value; the guide adds less than that.
            return float(np.floor(least + 1e-3)) + 0.5 + 1e-6
        return least * (1.0 + columns.data.n_robots * columns.attention)

    state = _State(
        columns,
        used,
        variables,
        improved,
        lambda scip: time.monotonic() > until or not go_on(proved(scip)),
        best,
    )
    handler = _Connected(state)
    model.includeConshdlr(
        handler,
        "connected",
        "robots' edges form paths",
        sepapriority=1000,
        enfopriority=-2_000_000,
        chckpriority=-2_000_000,
        sepafreq=1,
        eagerfreq=1,
        needscons=False,
    )
    model.includeEventhdlr(_Watch(state, limit), "watch", "asks whether to stop")
    model.setParams(
        {
            "limits/time": min(max(0.0, time_limit), 1e20),
            "randomization/randomseedshift": seed,
            "timing/clocktype": 2,
            "presolving/donotmultaggr": True,
            "misc/allowstrongdualreds": False,
            "misc/allowweakdualreds": False,
            "misc/usesymmetry": 0,
            "misc/catchctrlc": False,
        }
    )
    if np.isfinite(best):
        model.setObjlimit(limit(best))
    model.optimize()
    if state.failure is not None:
        raise state.failure
    complete = model.getStatus() in ("optimal", "infeasible")
    bound = state.found if complete and grain.step else proved(model)
    if model.getStatus() == "infeasible":
        bound = state.found
    return Tree(min(best, bound), complete, int(model.getNTotalNodes()))


def _add_rows(
    model: Model,
    columns: Columns,
    variables: list[Any],
    place: Ints,
    cuts: tuple[Cut, ...],
    more: Sequence[Row],
    unit: float,
) -> None:
    matrix, row_lower, row_upper = columns.rows
    makespan = columns.start("T") if columns.objective.only_last else -1

    def add(column: Ints, weight: Floats, low: float, high: float) -> None:
        here = place[column]
        terms = [
            (w * unit if j == makespan else w) * variables[p]
            for j, p, w in zip(column, here, weight, strict=True)
            if p >= 0
        ]
        if not terms:
            return
        total = quicksum(terms)
        if low == high:
            model.addCons(total == low)
        elif np.isneginf(low):
            model.addCons(total <= high)
        elif np.isposinf(high):
            model.addCons(total >= low)
        else:
            model.addCons((low <= total) <= high)

    for i in range(matrix.shape[0]):
        span = slice(matrix.indptr[i], matrix.indptr[i + 1])
        add(matrix.indices[span], matrix.data[span], float(row_lower[i]), float(row_upper[i]))
    for cut in cuts:
        column, weight = columns.cut_row(cut)
        add(column, weight, -np.inf, 0.0)
    for column, weight, most in more:
        add(column, weight, -np.inf, most)
