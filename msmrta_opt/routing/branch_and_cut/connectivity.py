"""The connectivity of each robot's edges as a constraint of SCIP.

It separates cuts at fractional points, and refuses integral ones that are not routes.

Source: Achterberg, Constraint Integer Programming (2007), for what a constraint handler must do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from pyscipopt import SCIP_RESULT, Conshdlr, Model

from ...arrays import Floats, Ints
from ..parameters import BranchAndCutParameters
from ..problem import Routes
from .edge_formulation import EdgeFormulation
from .points import point_supports, routes_of
from .separation import separate

_ENFORCED = 1e-4
"""Violation from which on a cut is added where the tree would branch otherwise."""


@dataclass(eq=False)
class Shared:
    """What SCIP's plug-ins share."""

    formulation: EdgeFormulation
    used: Ints
    """Columns that are variables of the model, ``(n_used,)``."""
    variables: list[Any]
    improved: Callable[[Routes], object]
    best: float
    """Value of the best solution known."""
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
        """A solution of the model, of the relaxation if it is ``None``, ``(n_columns,)``."""
        x = np.zeros(self.formulation.n_columns)
        x[self.used] = [model.getSolVal(solution, v) for v in self.variables]
        return x


class Connectivity(Conshdlr):  # type: ignore[misc]
    """The edges of each robot form one path from its first to its last victim."""

    def __init__(self, shared: Shared, parameters: BranchAndCutParameters) -> None:
        self.shared, self.parameters = shared, parameters
        self.place = np.full(shared.formulation.n_columns, -1)
        self.place[shared.used] = np.arange(len(shared.used))

    def _separate(self, tolerance: float) -> bool:
        shared = self.shared
        found = [
            cut
            for support in point_supports(shared.formulation, shared.point(self.model, None))
            for cut in separate(support, tolerance=tolerance)[: self.parameters.tree_cuts_per_robot]
        ]
        for cut in found:
            column, weight, _ = shared.formulation.cut_row(cut)
            here = self.place[column]
            shared.n_cuts += 1
            row = self.model.createEmptyRowUnspec(
                f"connected{shared.n_cuts}", lhs=None, rhs=0.0, local=False, removable=True
            )
            self.model.cacheRowExtensions(row)
            for place, w in zip(here[here >= 0], weight[here >= 0], strict=True):
                self.model.addVarToRow(row, shared.variables[place], w)
            self.model.flushRowExtensions(row)
            self.model.addCut(row, forcecut=tolerance == _ENFORCED)
            self.model.addPoolCut(row)
            self.model.releaseRow(row)
        return bool(found)

    def conssepalp(self, constraints: Any, nusefulconss: int) -> dict[str, Any]:
        """Cuts that the relaxation's point violates notably."""
        found = self._separate(self.parameters.separation_tolerance)
        return {"result": SCIP_RESULT.SEPARATED if found else SCIP_RESULT.DIDNOTFIND}

    def consenfolp(self, constraints: Any, n: int, infeasible: bool) -> dict[str, Any]:
        """Cuts that it violates at all, where it would be branched on or taken."""
        found = self._separate(_ENFORCED)
        return {"result": SCIP_RESULT.SEPARATED if found else SCIP_RESULT.FEASIBLE}

    def consenfops(self, constraints: Any, n: int, infeasible: bool, obj: bool) -> dict[str, Any]:
        """Whether a point that no relaxation gave is routes."""
        x = self.shared.point(self.model, None)
        connected = routes_of(self.shared.formulation, np.round(x)) is not None
        return {"result": SCIP_RESULT.FEASIBLE if connected else SCIP_RESULT.INFEASIBLE}

    def conscheck(self, constraints: Any, solution: Any, *_: Any, **__: Any) -> dict[str, Any]:
        """Whether a solution is routes; if so, it is passed on."""
        shared = self.shared
        x = np.round(shared.point(self.model, solution))
        routes = routes_of(shared.formulation, x)
        if routes is None:
            return {"result": SCIP_RESULT.INFEASIBLE}
        shared.best = min(shared.best, shared.formulation.value(x))
        shared.guard(lambda: shared.improved(routes), None)
        return {"result": SCIP_RESULT.FEASIBLE}

    def conslock(self, constraint: Any, kind: Any, positive: int, negative: int) -> None:
        """Every variable may make the constraint fail, whichever way it moves."""
        both = positive + negative
        for v in self.shared.variables:
            self.model.addVarLocksType(v, kind, both, both)
