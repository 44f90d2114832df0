"""Victims to robots, one to one: as many pairs as can be, the maximum time of a pair minimised.

Sets        robots r, victims v
Data        S_rv    success time of robot r at victim v, in time units
            F_rv    failure time of robot r at victim v, in time units
            a_rv    1 if r can reach v and serve something there, else 0
            ν       size of a maximum-cardinality matching of the pairs with a_rv = 1
Parameter   β in [0, 1], the importance of failure time over success time
Variables   x_rv in {0, a_rv}: robot r takes victim v
            T ≥ 0: the maximum time of a pair, in time units

    min   T
    s.t.  Σ_r x_rv ≤ 1           for all v   a victim has at most one robot
          Σ_v x_rv ≤ 1           for all r   a robot has at most one victim
          Σ_r Σ_v x_rv = ν                   as many pairs as can be
          Σ_v [(1 − β) S_rv + β F_rv] x_rv ≤ T   for all r   no pair takes longer than T

Size        N M + 1 variables, 2 N + M + 1 rows. The bottleneck assignment problem.
Source      Osooli et al. (2023), Eq. 2 and the linear assignment of its text, with a min-max
            objective.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="Eq. 2, one to one: maximum number of pairs, then minimum of the maximum time",
    parameters={"beta": BETA},
)


def build(data: VictimData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, v)."""
    beta = cp.Parameter(nonneg=True, name="beta")
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")
    maximum = cp.Variable(bounds=[0, None], name="maximum")

    success = cp.sum(cp.multiply(data.success, x), axis=1)
    failure = cp.sum(cp.multiply(data.failure, x), axis=1)
    return cp.Problem(
        cp.Minimize(maximum),
        [
            (cp.sum(x, axis=0) <= 1).set_label("victim {v} has at most one robot"),
            (cp.sum(x, axis=1) <= 1).set_label("robot {r} has at most one victim"),
            (cp.sum(x) == data.matching_size).set_label("as many pairs as can be"),
            ((1 - beta) * success + beta * failure <= maximum).set_label(
                "robot {r} takes at most the maximum time"
            ),
        ],
    )
