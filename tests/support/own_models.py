"""A formulation of one's own, of which there may be more asked than can be."""

from __future__ import annotations

ENOUGH = '''"""Some clusters are taken."""
import cvxpy as cp
from msmrta_opt.optimise.formulation import ClusterData, Parameter, Spec

SPEC = Spec(
    stage="cluster",
    title="at least so many clusters are taken",
    parameters={"need": Parameter(0, 100, 1, "how many")},
)


def build(data: ClusterData) -> cp.Problem:
    need = cp.Parameter(nonneg=True, name="need")
    x = cp.Variable(data.w.shape, boolean=True, name="x")
    return cp.Problem(
        cp.Minimize(cp.sum(x)),
        [
            (cp.sum(x, axis=0) <= 1).set_label("cluster {c} has at most one robot"),
            (cp.sum(x) >= need).set_label("enough are taken"),
        ],
    )
'''
