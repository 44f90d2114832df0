# Told when building: parameter charge cannot be a number from 0 to 100
"""The charge may not be positive, and its range is."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
    parameters={"charge": Parameter(0, 100, 10, "cost of a robot that is sent, in time units")},
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonpos=True, name="charge")
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")
    sent = cp.Variable(data.busy.shape, boolean=True, name="sent")
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.success, x)) + charge * cp.sum(sent)),
        [
            (cp.sum(x, axis=0) == data.coverable).set_label("victim {v} has one robot if it can"),
            (x <= sent[:, None]).set_label("robot {r} takes victim {v} only if it is sent"),
        ],
    )
