# Told when building: nothing keeps x[0,0] to 0 and 1
"""A robot may take a victim three times."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
    parameters={"charge": Parameter(0, 100, 10, "cost of a robot that is sent, in time units")},
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonneg=True, name="charge")
    x = cp.Variable(data.success.shape, integer=True, bounds=[0, 3], name="x")
    sent = cp.Variable(data.busy.shape, boolean=True, name="sent")
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.success, x)) + charge * cp.sum(sent)),
        [
            cp.sum(x, axis=0) >= data.coverable,
            x <= 3 * sent[:, None],
        ],
    )
