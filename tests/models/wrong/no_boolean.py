# Told when building: x is continuous, but the stage reads 0 or 1 and rounds nothing; declare x with boolean=True
"""The assignment may be in parts."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
    parameters={"charge": Parameter(0, 100, 10, "cost of a robot that is sent, in time units")},
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonneg=True, name="charge")
    x = cp.Variable(data.success.shape, bounds=[0, data.can_serve], name="x")
    sent = cp.Variable(data.busy.shape, boolean=True, name="sent")
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.success, x)) + charge * cp.sum(sent)),
        [
            (cp.sum(x, axis=0) == data.coverable).set_label("victim {v} has one robot if it can"),
            (x <= sent[:, None]).set_label("robot {r} takes victim {v} only if it is sent"),
        ],
    )
