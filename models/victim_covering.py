"""Victims to robots, covering: every victim that can be served gets exactly one robot.

Sets        robots r, victims v; V⁺ the victims with a_rv = 1 for some r
Data        S_rv    success time of robot r at victim v, in time units
            F_rv    failure time of robot r at victim v, in time units
            a_rv    1 if r can reach v and serve something there, else 0
Parameter   β in [0, 1], the importance of failure time over success time
Variables   x_rv in {0, a_rv}: robot r takes victim v

    min   Σ_v Σ_r [(1 − β) S_rv + β F_rv] x_rv
    s.t.  Σ_r x_rv = 1           for all v in V⁺   a victim has exactly one robot

Size        N M variables, |V⁺| rows. Totally unimodular: each victim chooses by itself.
Source      Osooli et al. (2023), Eq. 2, with its rows as equations.
"""

import cvxpy as cp

from msmrta_opt.optimise.formulation import BETA, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="Eq. 2, covering: each victim exactly one robot, robots any number of victims",
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
            (cp.sum(x, axis=0) == data.coverable).set_label(
                "victim {v} has one robot if any can serve it"
            )
        ],
    )
