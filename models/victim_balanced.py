"""Victims to robots, balanced: cover every victim so that the busiest robot is least busy.

Sets        robots r, victims v; V⁺ the victims with a_rv = 1 for some r
Data        S_rv    success time of robot r at victim v, in time units; it includes b_r
            F_rv    failure time of robot r at victim v, in time units
            b_r     when robot r is done with what it has already, in time units
            a_rv    1 if r can reach v and serve something there, else 0
Parameter   β in [0, 1], the importance of failure time over success time
Variables   x_rv in {0, a_rv}: robot r takes victim v
            T ≥ 0: the maximum load of a robot, in time units

    min   T
    s.t.  Σ_r x_rv = 1                                           for all v in V⁺
              a victim has exactly one robot
          (1 − β) b_r + Σ_v [(1 − β)(S_rv − b_r) + β F_rv] x_rv ≤ T   for all r
              no robot has a load above T; b_r counts once, however many victims r takes

Size        N M + 1 variables, N + |V⁺| rows. Strongly NP-hard (scheduling unrelated machines).
Source      Osooli et al. (2023), Eq. 2, with its rows as equations and a min-max objective.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="Eq. 2, balanced: each victim exactly one robot, minimum of the maximum load",
    parameters={"beta": BETA},
)


def build(data: VictimData) -> cp.Problem:
    """The program for `data`; its solution is ``x`` over (r, v)."""
    beta = cp.Parameter(nonneg=True, name="beta")
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")
    maximum = cp.Variable(bounds=[0, None], name="maximum")

    success = data.busy + cp.sum(cp.multiply(data.extra, x), axis=1)
    failure = cp.sum(cp.multiply(data.failure, x), axis=1)
    load = (1 - beta) * success + beta * failure
    return cp.Problem(
        cp.Minimize(maximum),
        [
            (cp.sum(x, axis=0) == data.coverable).set_label(
                "victim {v} has one robot if any can serve it"
            ),
            (load <= maximum).set_label("robot {r} has at most the maximum load"),
        ],
    )
