r"""Branch and cut by SCIP: the edge formulation, with its connectivity cuts found on the way.

The tree starts with the columns that fixing left, the cuts of the root and the value of the incumbent.
Where all values are multiples of a step, the objective is scaled to integers, so that SCIP rounds its
own bounds up; the makespan then is an integer variable.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pyscipopt import SCIP_EVENTTYPE, Eventhdlr, Model, quicksum

from ...arrays import Floats, Ints
from ..objective_step import objective_step
from ..parameters import BranchAndCutParameters
from ..problem import Routes
from ..stop import StoppingCriterion
from .connectivity import Connectivity, Shared
from .subproblem import Subproblem, Tree

_INFINITE = 1e20
"""SCIP's infinity."""


class _Watch(Eventhdlr):  # type: ignore[misc]
    """Asks after every node and linear program whether to go on, and for better solutions only."""

    def __init__(
        self, shared: Shared, ask: Callable[[Model], bool], limit: Callable[[float], float]
    ) -> None:
        self.shared, self.ask, self.limit, self.best = shared, ask, limit, shared.best

    def eventinit(self) -> None:
        self.model.catchEvent(SCIP_EVENTTYPE.NODESOLVED, self)
        self.model.catchEvent(SCIP_EVENTTYPE.LPSOLVED, self)

    def eventexit(self) -> None:
        self.model.dropEvent(SCIP_EVENTTYPE.NODESOLVED, self)
        self.model.dropEvent(SCIP_EVENTTYPE.LPSOLVED, self)

    def eventexec(self, event: Any) -> None:
        if self.shared.guard(lambda: self.ask(self.model), True):
            self.model.interruptSolve()
        elif self.shared.best < self.best:
            self.best = self.shared.best
            self.model.setObjlimit(self.limit(self.best))


def search_by_scip(
    problem: Subproblem,
    *,
    stop: StoppingCriterion,
    seed: int,
    parameters: BranchAndCutParameters,
    improved: Callable[[Routes], object],
    proved: Callable[[float], object],
) -> Tree:
    """As `tree.search_tree`, by SCIP.

    Raises
    ------
    Exception
        If SCIP fails: PySCIPOpt has no type of its own.
    """
    formulation, known = problem.formulation, problem.known
    step = objective_step(formulation.data, formulation.objective)
    unit = step.step or 1.0
    model = Model()
    model.hideOutput()
    used = np.flatnonzero(problem.upper > 0)
    variables = _add_variables(model, problem, used, step.step)
    place = np.full(formulation.n_columns, -1)
    place[used] = np.arange(len(used))
    _add_rows(model, problem, variables, place, unit)

    def bound() -> float:
        found = float(model.getDualbound()) / formulation.weight_of_value
        return formulation.offset + unit * found if abs(found) < 0.1 * _INFINITE else -np.inf

    def limit(value: float) -> float:
        last = (step.below(value) - formulation.offset) / unit
        if step.step:
            # Half a step beyond the last better value; the robots' times add less than that.
            return float(np.floor(last + 1e-3)) + 0.5 + 1e-6
        return last * formulation.weight_of_value

    def ask(_: Model) -> bool:
        proved(bound())
        return stop.met()

    shared = Shared(formulation, used, variables, improved, known)
    model.includeConshdlr(
        Connectivity(shared, parameters),
        "connected",
        "robots' edges form paths",
        sepapriority=1000,
        enfopriority=-2_000_000,
        chckpriority=-2_000_000,
        sepafreq=1,
        eagerfreq=1,
        needscons=False,
    )
    model.includeEventhdlr(_Watch(shared, ask, limit), "watch", "asks whether to stop")
    # Gomory cuts and probing take longer than what they spare: the root's connectivity cuts are known.
    model.setParams(
        {
            "separating/gomory/freq": -1,
            "propagating/probing/maxprerounds": 0,
            "limits/time": min(stop.seconds_left(), _INFINITE),
            "randomization/randomseedshift": seed,
            "timing/clocktype": 2,
            "presolving/donotmultaggr": True,
            "misc/allowstrongdualreds": False,
            "misc/allowweakdualreds": False,
            "misc/usesymmetry": 0,
            "misc/catchctrlc": False,
        }
    )
    if np.isfinite(known):
        model.setObjlimit(limit(known))
    try:
        model.optimize()
    except Exception:
        if shared.failure is None:
            raise
    if shared.failure is not None:
        raise shared.failure
    status = model.getStatus()
    complete = status in ("optimal", "infeasible")
    no_better = status == "infeasible" or (complete and step.step)
    return Tree(
        min(known, shared.best if no_better else bound()), complete, int(model.getNTotalNodes())
    )


def _add_variables(model: Model, problem: Subproblem, used: Ints, step: float) -> list[Any]:
    """The columns `used`, with the makespan in multiples of `step` if that is not 0."""
    formulation = problem.formulation
    # Who visits whom decides; given that, the routes' relaxation is all but integral.
    priority = np.zeros(formulation.n_columns, dtype=int)
    priority[formulation.start("a") : formulation.start("e")] = 10
    priority[: formulation.n_pairs] = 20
    variables = []
    for j in used:
        is_time = not formulation.integer[j]
        unit = step if is_time and step else 1.0
        cost = formulation.weighted_cost[j] * unit / (step or 1.0)
        low, high = problem.lower[j] / unit, problem.upper[j] / unit
        if step and not formulation.time_weight:
            cost = round(cost)
        if is_time and step:
            low, high = np.ceil(low - 1e-6), np.floor(high + 1e-6)
        kind = ("I" if step else "C") if is_time else "B"
        variables.append(model.addVar(vtype=kind, lb=low, ub=high, obj=cost))
        model.chgVarBranchPriority(variables[-1], int(priority[j]))
    return variables


def _add_rows(
    model: Model, problem: Subproblem, variables: list[Any], place: Ints, unit: float
) -> None:
    """The rows of the formulation, the cuts known and the rows besides, on the variables there are."""
    formulation = problem.formulation
    makespan = formulation.start("T") if formulation.objective.only_last else -1

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

    matrix, row_lower, row_upper = formulation.rows
    for i in range(matrix.shape[0]):
        span = slice(matrix.indptr[i], matrix.indptr[i + 1])
        add(matrix.indices[span], matrix.data[span], float(row_lower[i]), float(row_upper[i]))
    for column, weight, maximum in (*map(formulation.cut_row, problem.cuts), *problem.rows):
        add(column, weight, -np.inf, maximum)
