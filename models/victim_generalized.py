"""Victims to robots within endurance: the generalised assignment problem.

Sets        robots r, victims v; V⁺ the victims with a_rv = 1 for some r
Data        S_rv    success time of robot r at victim v, in time units; it includes b_r
            F_rv    failure time of robot r at victim v, in time units
            b_r     when robot r is done with what it has already, in time units
            a_rv    1 if r can reach v and serve something there, else 0
            e_r     maximum time that robot r may be busy in all, in time units
            h_r     what is left of them: max(e_r − b_r, 0), but no more than Σ_v a_rv (S_rv − b_r),
                    the time of all its victims, which stands for e_r = ∞
Parameter   β in [0, 1], the importance of failure time over success time
Variables   x_rv in {0, a_rv}: robot r takes victim v

    min   Σ_v Σ_r [(1 − β) S_rv + β F_rv] x_rv
    s.t.  Σ_r x_rv = 1                   for all v in V⁺   a victim has exactly one robot
          Σ_v (S_rv − b_r) x_rv ≤ h_r    for all r         a robot keeps to its endurance

Size        N M variables, N + |V⁺| rows. Strongly NP-hard.
Source      Ross and Soland (1975), "A branch and bound algorithm for the generalized assignment
            problem"; Osooli et al. (2023), Eq. 2, with its rows as equations.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="Eq. 2 within endurance: each victim exactly one robot that has the time for it",
    parameters={"beta": BETA},
    assumes="the robots have time for every victim that one of them can serve",
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
            (cp.sum(x, axis=0) == data.coverable).set_label(
                "victim {v} has one robot if any can serve it"
            ),
            (cp.sum(cp.multiply(data.extra, x), axis=1) <= data.time_left).set_label(
                "robot {r} keeps to its endurance"
            ),
        ],
    )
