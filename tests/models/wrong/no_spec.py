# Told when importing: SPEC
""""""

import cvxpy as cp


def build(data: object) -> cp.Problem:
    return cp.Problem(cp.Minimize(0))
