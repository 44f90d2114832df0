# Told when building: has shape (6,), where the stage reads robots by victims, (3, 6)
"""One number a victim: which robot."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
    parameters={"charge": Parameter(0, 100, 10, "cost of a robot that is sent, in time units")},
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonneg=True, name="charge")
    x = cp.Variable(data.coverable.shape, integer=True, bounds=[0, 2], name="x")
    sent = cp.Variable(data.busy.shape, boolean=True, name="sent")
    return cp.Problem(
        cp.Minimize(cp.sum(x) + charge * cp.sum(sent)),
        [
            cp.sum(x) <= 9,
            sent >= 0,
        ],
    )
