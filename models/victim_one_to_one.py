"""Victims to robots, one to one: as many pairs as can be, at minimum cost.

Sets        robots r, victims v
Data        S_rv    success time of robot r at victim v, in time units
            F_rv    failure time of robot r at victim v, in time units
            a_rv    1 if r can reach v and serve something there, else 0
            ν       size of a maximum-cardinality matching of the pairs with a_rv = 1
Parameter   β in [0, 1], the importance of failure time over success time
Variables   x_rv in {0, a_rv}: robot r takes victim v

    min   Σ_v Σ_r [(1 − β) S_rv + β F_rv] x_rv
    s.t.  Σ_r x_rv ≤ 1           for all v   a victim has at most one robot
          Σ_v x_rv ≤ 1           for all r   a robot has at most one victim
          Σ_r Σ_v x_rv = ν                   as many pairs as can be

Size        N M variables, N + M + 1 rows. Totally unimodular.
Source      Osooli et al. (2023), Eq. 2 and the linear assignment of its text.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="Eq. 2, one to one: maximum number of pairs, then minimum cost (the text's linear assignment)",
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
        [
            (cp.sum(x, axis=0) <= 1).set_label("victim {v} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one victim"),
            (cp.sum(x) == data.matching_size).set_label("as many pairs as can be"),
        ],
    )
