# Told when building: SPEC.parameters lacks charge; declare it
"""The charge is used and not declared."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonneg=True, name="charge")
    x = cp.Variable(data.success.shape, boolean=True, bounds=[0, data.can_serve], name="x")
    sent = cp.Variable(data.busy.shape, boolean=True, name="sent")
    return cp.Problem(
        cp.Minimize(cp.sum(cp.multiply(data.success, x)) + charge * cp.sum(sent)),
        [
            (cp.sum(x, axis=0) == data.coverable).set_label("victim {v} has one robot if it can"),
            (x <= sent[:, None]).set_label("robot {r} takes victim {v} only if it is sent"),
        ],
    )
