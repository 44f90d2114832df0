# Told when building: the program has no variables
"""Nothing to decide."""

import cvxpy as cp

from msmrta_opt.optimise.formulation import Parameter, Spec, VictimData

SPEC = Spec(
    stage="victim",
    title="covering, with a charge for each robot that is sent",
    parameters={"charge": Parameter(0, 100, 10, "cost of a robot that is sent, in time units")},
)


def build(data: VictimData) -> cp.Problem:
    charge = cp.Parameter(nonneg=True, name="charge")
    return cp.Problem(
        cp.Minimize(0 * charge)
    )
