"""Victims to robots, as Eq. 2 is printed. Its optimum is to assign nobody.

Sets        robots r, victims v
Data        S_rv    success time of robot r at victim v, in time units
            F_rv    failure time of robot r at victim v, in time units
            a_rv    1 if r can reach v and serve something there, else 0
Parameter   β in [0, 1], the importance of failure time over success time
Variables   x_rv in {0, a_rv}: robot r takes victim v

    min   Σ_v Σ_r [(1 − β) S_rv + β F_rv] x_rv
    s.t.  Σ_r x_rv ≤ 1           for all v   a victim has at most one robot

Why nobody  Times are not negative and no row asks for an assignment, so x = 0 costs 0 and nothing
            costs less. The printed rows lack what the text says, that remaining victims are
            assigned; `victim_one_to_one`, `victim_covering` and `victim_balanced` each add it.
Size        N M variables, M rows. Totally unimodular.
Source      Osooli et al. (2023), Eq. 2.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="Eq. 2 as printed: its optimum is to assign nobody",
    parameters={"beta": BETA},
)


def build(data: VictimData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, v)."""
    beta = cp.Parameter(nonneg=True, name="beta")
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")

    success = cp.sum(cp.multiply(data.success, x))
    failure = cp.sum(cp.multiply(data.failure, x))
    return cp.Problem(
        cp.Minimize((1 - beta) * success + beta * failure),
        [(cp.sum(x, axis=0) <= 1).set_label("victim {v} has at most one robot")],
    )
